"""Shared fixtures."""

import os
from pathlib import Path

import pytest

import cyclosweep as cs


@pytest.fixture
def reference() -> cs.Drive:
    return cs.Drive.reference_87()


@pytest.fixture(scope="session")
def shared_recordings() -> Path:
    """Folder of measured and practice recordings, which are not part of the repository."""
    beside = Path(__file__).parents[1].parent / "shared"
    folder = Path(os.environ.get("CYCLOSWEEP_SHARED", beside)) / "recordings"
    if not folder.is_dir():
        pytest.skip(f"no shared recordings at {folder}; set CYCLOSWEEP_SHARED")
    return folder
