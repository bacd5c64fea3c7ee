"""Every example in a docstring runs."""

from __future__ import annotations

import doctest
import importlib
from pathlib import Path

import pytest

import cyclosweep as cs

ROOT = Path(cs.__file__).parents[1]
MODULES = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    for package in ("cyclosweep", "cyclosweep_challenge")
    for path in (ROOT / package).rglob("*.py")
    if ">>> " in path.read_text("utf-8")
)


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples(name: str) -> None:
    try:
        module = importlib.import_module(name)
    except ModuleNotFoundError as error:
        pytest.skip(f"{error.name} is not installed: an optional extra")
    result = doctest.testmod(module)
    assert result.attempted > 0
    assert result.failed == 0


def test_the_functions_of_the_package_have_examples() -> None:
    assert {"cyclosweep.design.drive", "cyclosweep.sweep.shards"} <= set(MODULES)
