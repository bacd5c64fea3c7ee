"""Functions with two or more arguments say what these are, in which unit and shape."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "python" / "cyclosweep"


def functions(folder: str) -> list[tuple[str, ast.FunctionDef, int]]:
    """Name, definition and number of arguments of the functions of a folder's modules."""
    found = []
    for path in sorted((PACKAGE / folder).rglob("*.py")):
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.FunctionDef):
                given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                found.append((f"{path.relative_to(PACKAGE)}:{node.name}", node, len(given)))
    return found


# Folders in which the functions of a file's own use name their arguments, too.
WHOLLY = ["recording"] + [
    f"diagnosis/{part}" for part in ("prepare", "hypotheses", "identify", "whole_loop", "verify")
]


@pytest.mark.parametrize(
    ("folder", "private"),
    [*((folder, True) for folder in WHOLLY), ("diagnosis", False), ("simulation", False)],
)
def test_arguments_and_results_are_documented(folder: str, private: bool) -> None:
    without: list[str] = []
    for name, node, count in functions(folder):
        if count < 2 or (node.name.startswith("_") and not private):
            continue
        text = ast.get_docstring(node) or ""
        returns = node.returns is not None and ast.unparse(node.returns) != "None"
        has_result = "Returns\n" in text or "Yields\n" in text
        if "Parameters\n" not in text or (returns and not has_result):
            without.append(name)
    assert without == []
