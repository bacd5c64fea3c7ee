"""What importing the package loads, and what it loads later."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import cyclosweep as cs

TESTS = Path(__file__).parents[1]
# What moved is imported by its old names on purpose.
FILES = [p for p in sorted(TESTS.rglob("*.py")) if p.name != "test_moved_names.py"]

LOADED = """
import sys
import cyclosweep as cs
assert cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8])
print(*(name for name in sys.modules if name.split(".")[0] in ("scipy", "matplotlib", "rich")))
"""


def test_a_worker_of_a_sweep_loads_no_scipy() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOADED], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == []


@pytest.mark.parametrize("name", cs.__all__)
def test_every_public_name_is_there_and_listed(name: str) -> None:
    assert getattr(cs, name) is not None
    assert name in dir(cs)


def test_another_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match=r"cyclosweep.*nothing_of_this_name"):
        getattr(cs, "nothing_of_this_name")  # noqa: B009


def imports_out_of_habit(path: Path) -> list[str]:
    """Imports that bring a public name in another way than as ``cs.name``."""
    found = []
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cyclosweep"):
            public = {name.name for name in node.names} & set(cs.__all__)
            if public and not (node.module or "").startswith("cyclosweep_challenge"):
                found += sorted(public)
        elif isinstance(node, ast.Import):
            found += [n.name for n in node.names if n.name == "cyclosweep" and n.asname != "cs"]
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(TESTS).as_posix())
def test_the_public_api_is_imported_in_one_way(path: Path) -> None:
    assert imports_out_of_habit(path) == []
