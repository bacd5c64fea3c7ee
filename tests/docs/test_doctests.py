"""Every example in a docstring runs."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import cyclosweep as cs

MODULES = sorted(
    module.name
    for module in pkgutil.walk_packages(cs.__path__, "cyclosweep.")
    if not module.name.endswith(("__main__", "_core"))
)


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples(name: str) -> None:
    try:
        module = importlib.import_module(name)
    except ModuleNotFoundError as error:
        pytest.skip(f"{error.name} is not installed: an optional extra")
    result = doctest.testmod(module)
    assert result.failed == 0
