"""What is packed into a wheel, and whether the workflows build what the sources say."""

from __future__ import annotations

import re
import subprocess
import tomllib
from importlib import resources
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
WHEELS = (ROOT / ".github" / "workflows" / "wheels.yml").read_text("utf-8")
CARGO = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))


def test_wheels_are_built_with_a_profile_that_there_is() -> None:
    [profile] = re.findall(r"--profile (\w+)", WHEELS)
    assert profile in CARGO["profile"]
    assert f"--profile {profile}" in (ROOT / "Makefile").read_text("utf-8")


def test_wheels_are_built_with_the_pinned_maturin_from_locked_sources() -> None:
    pins = (ROOT / "constraints.txt").read_text("utf-8")
    [pinned] = re.findall(r"^maturin==(\S+)", pins, re.MULTILINE)
    assert set(re.findall(r"maturin-version: v(\S+)", WHEELS)) == {pinned}
    assert "--locked" in WHEELS
    assert (ROOT / "Cargo.lock").exists()


def test_one_wheel_is_for_every_python_that_is_supported() -> None:
    [stable] = [f for f in CARGO["dependencies"]["pyo3"]["features"] if f.startswith("abi3-")]
    assert PROJECT["project"]["requires-python"] == f">=3.{stable.removeprefix('abi3-py3')}"
    assert f"cp{stable.removeprefix('abi3-py')}-abi3" in (
        ROOT / "tests" / "support" / "try_wheel.py"
    ).read_text("utf-8")


def test_pinned_versions_install_on_the_oldest_python() -> None:
    oldest = f"{PROJECT['project']['requires-python'].removeprefix('>=')}.0"
    pins = (ROOT / "constraints.txt").read_text("utf-8").splitlines()
    needs: dict[str, str] = {}
    for name in (Requirement(pin).name for pin in pins if pin and not pin.startswith("#")):
        try:
            needs[name] = str(metadata(name).json.get("requires_python", ""))
        except PackageNotFoundError:
            continue
    assert len(needs) > 50
    refused = {name: need for name, need in needs.items() if oldest not in SpecifierSet(need)}
    assert not refused


def test_versions_agree() -> None:
    assert CARGO["package"]["version"] == PROJECT["project"]["version"]


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.stem)
def test_actions_of_others_are_pinned_to_a_commit(workflow: Path) -> None:
    used = re.findall(r"uses: (\S+)", workflow.read_text("utf-8"))
    assert all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", action) for action in used)


@pytest.mark.parametrize("name", ["py.typed", "_core.pyi"])
def test_types_are_packed(name: str) -> None:
    assert resources.files("cyclosweep").joinpath(name).is_file()


def test_every_file_beside_the_code_is_in_the_sources_of_a_wheel() -> None:
    """A wheel holds what git knows below python/; what git ignores would be missing."""
    listed = subprocess.run(
        ["git", "ls-files", "--others", "--ignored", "--exclude-standard", "python"],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listed.returncode:
        pytest.skip("no working copy of git")
    ignored = [name for name in listed.stdout.split() if "__pycache__" not in name]
    assert [name for name in ignored if "_core" not in name] == []
