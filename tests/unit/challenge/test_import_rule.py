"""The generator must not be the fitter: the challenge imports nothing that fits or predicts."""

import ast
import sys
from pathlib import Path

import pytest

import cyclosweep.challenge as challenge

ROOT = Path(challenge.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))
SCORING = {"opponents", "scoring", "board"}
RIG_MAY = {"numpy", "scipy", "polars"}
SCORING_MAY = RIG_MAY | {"rich", "sklearn", "statsmodels", "pysindy", "plotly"}


def imported(path: Path) -> list[str]:
    names: list[str] = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names.append(node.module or "")
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
            called = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
            assert called not in {"__import__", "import_module", "exec", "eval"}, path
    return names


def is_rig(path: Path) -> bool:
    return path.relative_to(ROOT).parts[0].removesuffix(".py") not in SCORING


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_only_the_standard_library_arrays_and_the_challenge_itself(path: Path) -> None:
    allowed = RIG_MAY if is_rig(path) else SCORING_MAY
    for name in imported(path):
        top = name.split(".")[0]
        if top == "cyclosweep":
            assert name.startswith("cyclosweep.challenge"), f"{path.name} imports {name}"
            if is_rig(path) and path.name != "__init__.py":
                inside = name.split(".")[2:3]
                assert not set(inside) & SCORING or path.name == "runner.py", (path.name, name)
        else:
            assert top in allowed or top in sys.stdlib_module_names, f"{path.name} imports {name}"


def test_rule_sees_the_rig() -> None:
    assert {"rig.py", "balance.py", "pins.py", "creep.py"} <= {path.name for path in FILES}
