"""The solved problems that the printed formulas are set beside, solved again."""

from __future__ import annotations

import math

import pytest

from cyclosweep.reference.solved_problems import KEYWAY_MM, KEYWAY_RATIO, SHOULDERS
from tests.validation.torsion_problems import (
    keyway_ratio,
    shoulder_on_no_grid,
    torsion_constant,
)


def test_a_bar_without_a_keyway_has_the_torsion_constant_of_a_circle() -> None:
    assert torsion_constant(50.0, 0.0, 0.0, 0.5) == pytest.approx(math.pi * 50**4 / 32, rel=2e-4)


@pytest.mark.parametrize(("ratio", "extra"), SHOULDERS.items())
def test_a_shoulder_s_extra_length(ratio: float, extra: float) -> None:
    assert shoulder_on_no_grid(ratio) == pytest.approx(extra, abs=2e-4)


def test_a_standard_keyway_softens_a_shaft_by_13_percent() -> None:
    assert keyway_ratio(*KEYWAY_MM, h=0.25) == pytest.approx(KEYWAY_RATIO, abs=1e-3)
