"""The tree of folders: who may import whom, no circles, no file too long to be read at once."""

from __future__ import annotations

import ast
from collections import defaultdict
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2] / "python"
FILES = sorted(ROOT.rglob("*.py"))
LONGEST = 400

BASE = {"errors", "atomic", "notebook", "display", "plugins", "page"}
DESIGN = BASE | {"dynamics", "design"}
SIMULATION = DESIGN | {"recording", "simulation"}
DIAGNOSIS = SIMULATION | {"result", "report", "diagnosis"}
REFERENCE = DIAGNOSIS | {"sweep", "explore", "choose", "reference"}

# What each folder or file of cyclosweep may import from; each also from itself.
MAY_IMPORT: dict[str, set[str]] = {
    "errors": set(),
    "atomic": set(),
    "plugins": {"errors"},
    "notebook": set(),
    "page": set(),
    "display": {"errors"},
    "_moved": set(),
    "dynamics": BASE,
    "design": BASE | {"dynamics"},
    "sweep": DESIGN,
    "explore": DESIGN | {"sweep"},
    "choose": DESIGN | {"sweep", "explore"},
    "cad": DESIGN,
    "recording": DESIGN,
    "simulation": DESIGN | {"recording"},
    "result": SIMULATION,
    "report": SIMULATION | {"result"},
    "diagnosis": SIMULATION | {"result", "report"},
    "reference": DIAGNOSIS | {"sweep"},
    "figures": DESIGN | {"sweep", "explore"},
    "study_report": DESIGN | {"sweep", "explore", "choose", "figures"},
    "cli": REFERENCE | {"cad", "figures", "study_report", "__init__"},
    "__init__": REFERENCE | {"_moved", "cad", "figures", "study_report"},
    "__main__": {"cli"},
}

# The parts of a diagnosis, each after those that it may build on; the stages have a file each.
FITTING = {"prepare", "hypotheses", "identify", "whole_loop"}
DECIDED = FITTING | {"outcome", "provenance", "refuse", "conclude"}
STAGES = {
    "prepare": set[str](),
    "hypotheses": {"prepare"},
    "identify": {"prepare", "hypotheses"},
    "whole_loop": {"prepare", "hypotheses", "identify"},
    "verify": FITTING,
    "inputs": set[str](),
    "outcome": set[str](),
    "provenance": set[str](),
    "mistakes": set[str](),
    "doubts": set[str](),
    "strokes": set[str](),
    "reversals": set[str](),
    "plausibility": {"mistakes", "doubts", "strokes", "reversals"},
    "left_out": set[str](),
    "elasticity": FITTING,
    "refuse": FITTING | {"outcome", "provenance", "plausibility", "mistakes", "left_out"},
    "sliding": {"outcome", "provenance", "strokes", "plausibility"},
    "series": {"outcome"},
    "series_steps": {"outcome", "series", "whole_loop"},
    "folder": {"diagnose", "inputs", "series", "series_steps"},
    "calibrate": FITTING,
    "friction_in_noise": FITTING | {"calibrate"},
    "identify_effects": FITTING | {"calibrate", "friction_in_noise"},
    "one_history": FITTING | {"friction_in_noise", "identify_effects"},
    "torque_zero": FITTING | {"one_history", "refuse"},
    "conclude": FITTING | {"outcome", "provenance", "refuse"},
    "locate": DECIDED,
    "repair": DECIDED | {"elasticity"},
    "growth": set[str](),
    "sweeps": set[str](),
    "change": DECIDED | {"growth", "sweeps"},
    "verification": DECIDED | {"verify", "change"},
    "effects_found": DECIDED | {"elasticity", "effect_chance"},
    "abrupt_step": DECIDED,
    "misfit": DECIDED,
    "effect_chance": DECIDED,
    "remainder": DECIDED | {"verify", "verification", "locate", "abrupt_step", "misfit"},
    "model_error_table": DECIDED | {"verify", "verification", "repair"},
    "finish": DECIDED | {"verification", "repair", "plausibility"},
    "compose": DECIDED
    | {"verify", "verification", "effects_found", "remainder", "repair", "finish"}
    | {"model_error_table"},
}


def module_of(path: Path) -> str:
    """Dotted name of a file."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_of(path): path for path in FILES}


@cache
def imports(path: Path) -> frozenset[Path]:
    """Files of the two packages that a file imports, also inside functions and for types alone."""
    found: set[Path] = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [name if name in MODULES else str(node.module) for name in inner]
        else:
            continue
        found.update(MODULES[name] for name in names if name in MODULES)
    return frozenset(found)


def unit(path: Path, folder: Path) -> str:
    """The child of a folder to which a file belongs: itself or a folder."""
    return path.relative_to(folder).parts[0].removesuffix(".py")


def circle(graph: dict[str, set[str]]) -> list[str]:
    """A circle of a graph, empty where there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_every_file_is_seen() -> None:
    assert {"cyclosweep.design.drive", "cyclosweep.cli.challenge", "cyclosweep"} <= set(MODULES)
    assert MODULES["cyclosweep.design.drive"] in imports(MODULES["cyclosweep.sweep.space"])
    assert MODULES["cyclosweep"] in imports(MODULES["cyclosweep.cli"])
    assert MODULES["cyclosweep.sweep.study"] in imports(MODULES["cyclosweep.sweep.summary"])


@pytest.mark.parametrize("path", FILES, ids=module_of)
def test_no_file_is_longer_than_can_be_read_at_once(path: Path) -> None:
    lines = path.read_text("utf-8").count("\n")
    assert lines <= LONGEST


def test_no_circle_of_files() -> None:
    graph = {module_of(path): {module_of(other) for other in imports(path)} for path in FILES}
    assert circle(graph) == []


FOLDERS = sorted({path.parent for path in FILES})


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_circle_between_the_children_of_a_folder(folder: Path) -> None:
    graph: dict[str, set[str]] = defaultdict(set)
    for path in FILES:
        if path.is_relative_to(folder):
            own = unit(path, folder)
            for other in imports(path):
                if other.is_relative_to(folder) and unit(other, folder) != own:
                    graph[own].add(unit(other, folder))
    assert circle(graph) == []


@pytest.mark.parametrize("path", [p for p in FILES if p.parts[len(ROOT.parts)] == "cyclosweep"],
                         ids=module_of)  # fmt: skip
def test_a_folder_imports_only_from_those_before_it(path: Path) -> None:
    package = ROOT / "cyclosweep"
    own = unit(path, package)
    for other in imports(path):
        if other.is_relative_to(package) and unit(other, package) != own:
            assert unit(other, package) in MAY_IMPORT[own], f"imports {module_of(other)}"


DIAGNOSIS_FOLDER = ROOT / "cyclosweep" / "diagnosis"


@pytest.mark.parametrize(
    "path", [p for p in FILES if p.is_relative_to(DIAGNOSIS_FOLDER)], ids=module_of
)
def test_a_stage_imports_only_from_stages_before_it(path: Path) -> None:
    own = unit(path, DIAGNOSIS_FOLDER)
    for other in imports(path):
        if own in STAGES and other.is_relative_to(DIAGNOSIS_FOLDER):
            stage = unit(other, DIAGNOSIS_FOLDER)
            assert stage == own or stage in STAGES[own], f"imports {module_of(other)}"


def test_the_folders_of_identify_import_from_those_before_them() -> None:
    folder = DIAGNOSIS_FOLDER / "identify"
    order = ["fitting", "structures", "laws", "stages"]
    assert {unit(path, folder) for path in FILES if folder in path.parents} == {*order, "__init__"}
    for path in FILES:
        if folder in path.parents and path.parent != folder:
            before = order[: order.index(unit(path, folder)) + 1]
            inside = {unit(other, folder) for other in imports(path) if folder in other.parents}
            assert inside <= set(before), module_of(path)


def test_every_stage_has_its_place_and_the_pipeline_is_one_short_file() -> None:
    found = {unit(path, DIAGNOSIS_FOLDER) for path in FILES if DIAGNOSIS_FOLDER in path.parents}
    assert found == {*STAGES, "__init__", "diagnose"}
    lines = (DIAGNOSIS_FOLDER / "diagnose.py").read_text("utf-8").count("\n")
    assert lines <= 130


def test_contributing_lists_every_folder() -> None:
    page = (ROOT.parent / "CONTRIBUTING.md").read_text("utf-8")
    for folder in (ROOT / "cyclosweep").iterdir():
        if (folder / "__init__.py").exists():
            assert f"| `{folder.name}/` |" in page, folder.name
            assert folder.name in MAY_IMPORT


def test_the_product_knows_the_challenge_by_one_command_alone() -> None:
    knowing = {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "cyclosweep").rglob("*.py")
        if "cyclosweep_challenge" in path.read_text("utf-8")
    }
    assert knowing == {"cyclosweep/cli/challenge.py", "cyclosweep/_moved.py"}
    command = ast.parse((ROOT / "cyclosweep/cli/challenge.py").read_text("utf-8"))
    assert not any(
        "cyclosweep_challenge" in ast.unparse(node)
        for node in command.body
        if isinstance(node, (ast.Import, ast.ImportFrom, ast.If))
    )
