"""Pinned versions of libraries install on every Python that the package promises."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

CONSTRAINTS = Path(__file__).parents[2] / "constraints.txt"
LEAST = "3.11.0"
"""The oldest Python of `requires-python` in pyproject.toml."""


def test_pinned_versions_install_on_the_oldest_python() -> None:
    pinned = [
        Requirement(line).name
        for line in CONSTRAINTS.read_text(encoding="utf-8").splitlines()
        if line and not line.startswith("#")
    ]
    needs: dict[str, str] = {}
    for name in pinned:
        try:
            needs[name] = str(metadata(name).json.get("requires_python", ""))
        except PackageNotFoundError:
            continue
    assert len(needs) > 50
    refused = {name: need for name, need in needs.items() if LEAST not in SpecifierSet(need)}
    assert not refused
