"""Shared fixtures."""

from __future__ import annotations

import pytest

import cyclosweep as cs


@pytest.fixture
def reference() -> cs.Drive:
    return cs.Drive.reference_87()
