"""Module names of version 0.1 still import, warn, and hide none of the package's functions."""

import importlib
import subprocess
import sys
from pathlib import Path
from typing import cast

import pytest

import cyclosweep as cs
from cyclosweep._moved import MOVED, RENAMED

FOLDERS_WITHOUT_NAMES = {"cyclosweep.challenge.board", "cyclosweep.challenge.opponents"}


@pytest.mark.parametrize("old", sorted(FOLDERS_WITHOUT_NAMES))
def test_an_old_folder_without_names_of_its_own_imports(old: str) -> None:
    assert MOVED[old] in (importlib.import_module(old).__doc__ or "")


@pytest.mark.parametrize("old", sorted(set(MOVED) - FOLDERS_WITHOUT_NAMES))
def test_an_old_name_leads_to_the_new_module(old: str) -> None:
    new = importlib.import_module(MOVED[old])
    public = next(name for name in vars(new) if not name.startswith("_"))
    with pytest.warns(DeprecationWarning, match=MOVED[old]):
        found = getattr(importlib.import_module(old), public)
    assert found is getattr(new, public)


@pytest.mark.parametrize("old", sorted(RENAMED))
def test_an_old_name_leads_to_what_it_is_called_now(old: str) -> None:
    module, _, name = RENAMED[old].rpartition(".")
    old_module, _, old_name = old.rpartition(".")
    with pytest.warns(DeprecationWarning, match=module):
        found = getattr(importlib.import_module(old_module), old_name)
    assert found is getattr(importlib.import_module(module), name)


def test_no_old_name_hides_a_module_that_is_there() -> None:
    folder = Path(cs.__file__).parents[1]
    for old in MOVED:
        path = folder.joinpath(*old.split("."))
        assert not path.with_suffix(".py").exists(), old
        assert not path.is_dir(), old


def test_functions_of_the_package_stay_functions_after_old_imports() -> None:
    with pytest.warns(DeprecationWarning, match="simulation"):
        from cyclosweep.simulate import Model
    assert cast("object", Model) is cs.Model
    assert callable(cs.simulate)
    assert callable(cs.scan)


def test_old_modules_and_folders_are_attributes_of_the_package() -> None:
    code = (
        "import warnings, cyclosweep as cs, cyclosweep.drive\n"
        "warnings.simplefilter('ignore')\n"
        "assert cyclosweep.drive.Drive is cs.Drive\n"
        "assert cs.space.Space is cs.Space\n"
        "assert cs.recording.Recording is cs.Recording\n"
        "assert cs.diagnosis.diagnose is cs.diagnose\n"
        "assert callable(cs.sweep) and callable(cs.simulate) and callable(cs.validate)\n"
        "assert not hasattr(cs, 'nonsense')\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_name_that_never_was_is_refused() -> None:
    with pytest.raises(ImportError):
        exec("from cyclosweep.drive import Nonexistent")


def test_the_old_command_of_the_record_still_runs() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "cyclosweep.challenge.record", "--help"],
        check=True,
        capture_output=True,
        text=True,
    )
    assert "--only-verify" in done.stdout
