"""The generator must not be the fitter: the challenge imports nothing that fits or predicts."""

import ast
import sys
from pathlib import Path

import pytest

import cyclosweep as cs
import cyclosweep_challenge as challenge

ROOT = Path(challenge.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))
SCORING = {
    "opponents",
    "scoring",
    "board",
    "runner",
    "record",
    "measured",
    "scoreboard",
    "campaign",
}
RIG_MAY = {"numpy", "scipy", "polars"}
SCORING_MAY = RIG_MAY | {"filelock", "rich", "sklearn", "statsmodels", "pysindy", "plotly"}
DIAGNOSING = "scoreboard"
"""Folder that calls the diagnosis as a user does; its own rig keeps to the rule of the rig."""
MAKERS = {"made_rig.py", "made_effects.py"}
WITH_ITS_LIBRARY = "project_library.py"
"""Opponent that is given the library of the diagnosis, to tell what the search adds to it."""


def imported(path: Path) -> list[str]:
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names.append("." * node.level + (node.module or ""))
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return names


def called(path: Path) -> set[str]:
    functions = [n.func for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.Call)]
    plain = {f.id for f in functions if isinstance(f, ast.Name)}
    return plain | {f.attr for f in functions if isinstance(f, ast.Attribute)}


def is_rig(path: Path) -> bool:
    return path.relative_to(ROOT).parts[0].removesuffix(".py") not in SCORING


def may_import(path: Path) -> set[str]:
    if is_rig(path) or path.name in MAKERS:
        return RIG_MAY
    diagnoses = path.parent.name == DIAGNOSING or path.name == WITH_ITS_LIBRARY
    return SCORING_MAY | {"cyclosweep"} if diagnoses else SCORING_MAY


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_only_the_standard_library_arrays_and_the_challenge_itself(path: Path) -> None:
    allowed = may_import(path)
    for name in imported(path):
        top = name.split(".")[0]
        if top == "cyclosweep_challenge":
            if is_rig(path) and path != ROOT / "__init__.py":
                assert not set(name.split(".")[1:2]) & SCORING, f"{path.name} imports {name}"
        else:
            assert top in allowed or top in sys.stdlib_module_names, f"{path.name} imports {name}"


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_nothing_is_imported_behind_the_rule_s_back(path: Path) -> None:
    assert not called(path) & {"__import__", "import_module", "exec", "eval"}
    assert not any(name.startswith(".") for name in imported(path))


def test_nothing_that_predicts_or_diagnoses_knows_of_the_challenge() -> None:
    package = Path(cs.__file__).parent
    knowing = [
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        if any("cyclosweep_challenge" in name for name in imported(path))
    ]
    assert knowing == ["cli/challenge.py"]


ORDER = (
    "second_generator",
    "component_rig",
    "rig",
    "trial",
    "opponents",
    "scoring",
    "board",
    "runner",
    "measured",
    "record",
    "scoreboard",
    "campaign",
)
"""Folders, each of which imports from those before it alone."""


def module_of(path: Path) -> str:
    """Name of a file's module."""
    return ".".join(path.relative_to(ROOT.parent).with_suffix("").parts).removesuffix(".__init__")


def own_imports(path: Path) -> set[str]:
    """Modules of the challenge that a file imports."""
    modules = {module_of(file) for file in FILES}
    return {name for name in imported(path) if name in modules}


def test_no_folder_imports_one_after_it() -> None:
    folders = {path.relative_to(ROOT).parts[0] for path in FILES if path.parent != ROOT}
    assert folders == set(ORDER)
    places = {name: k for k, name in enumerate(ORDER)}
    upward = [
        (module_of(path), name)
        for path in FILES
        if path.parent != ROOT
        for name in own_imports(path)
        if name.count(".") and places[name.split(".")[1]] > places[path.relative_to(ROOT).parts[0]]
    ]
    assert upward == []


def test_no_files_import_each_other_in_a_circle() -> None:
    imports = {module_of(path): own_imports(path) for path in FILES}
    assert sum(map(len, imports.values())) > 100
    while leaves := {name for name, needed in imports.items() if not needed & set(imports)}:
        imports = {name: needed for name, needed in imports.items() if name not in leaves}
    assert imports == {}


def test_second_generator_stands_alone() -> None:
    files = [path for path in FILES if "second_generator" in path.parts]
    assert len(files) > 10
    for path in files:
        for name in imported(path):
            if name.startswith("cyclosweep"):
                assert name.startswith("cyclosweep_challenge.second_generator"), (
                    f"{path.name} imports {name}"
                )


def test_opponent_with_the_library_takes_nothing_of_the_search() -> None:
    [path] = [path for path in FILES if path.name == WITH_ITS_LIBRARY]
    taken = {name for name in imported(path) if name.startswith("cyclosweep.diagnosis")}
    assert len(taken) > 4
    parts = ("calibrate", "hypotheses", "inputs", "prepare")
    assert all(name.split(".")[2] in parts for name in taken)


def test_rule_sees_the_rig() -> None:
    assert {"rig.py", "balance.py", "pins.py", "creep.py"} <= {path.name for path in FILES}
