"""Functions with two or more arguments say what these are, in which unit and shape."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "python" / "cyclosweep"


def functions(folder: str) -> list[tuple[str, ast.FunctionDef, int]]:
    """Name, definition and number of arguments, without self, of a folder's functions."""
    found = []
    for path in sorted((PACKAGE / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("__"):
                given = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                count = sum(argument.arg not in ("self", "cls") for argument in given)
                found.append((f"{path.relative_to(PACKAGE)}:{node.name}", node, count))
    return found


@pytest.mark.parametrize("folder", ["recording"])
def test_arguments_and_results_are_documented(folder: str) -> None:
    many = [(name, node) for name, node, count in functions(folder) if count >= 2]
    assert len(many) > 20
    without: list[str] = []
    for name, node in many:
        text = ast.get_docstring(node) or ""
        returns = node.returns is not None and ast.unparse(node.returns) != "None"
        has_result = "Returns\n" in text or "Yields\n" in text
        if "Parameters\n" not in text or (returns and not has_result):
            without.append(name)
    assert without == []
