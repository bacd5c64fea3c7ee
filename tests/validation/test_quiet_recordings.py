"""Recordings with nothing missing in which the reading of the angle passed for missing physics.

They are of the seed 7900000, on which the rules were found that mend them.
"""

from pathlib import Path

import pytest

from tests.validation.test_look_alikes import diagnosed

SEED = 7_900_000


@pytest.mark.parametrize(
    ("part", "number"),
    [
        # Steps of the dial ten times the noise, over which some held readings rest.
        ("null", 85),
        # Slow noise below the steps of a dial, over which the twist goes by equal amounts.
        ("foreign-correlated-null", 81),
        ("foreign-correlated-null", 87),
        # Slow noise, and two readings taken while the shaft still crossed its play.
        ("foreign-correlated-null", 69),
    ],
)
def test_a_reading_is_no_missing_physics(part: str, number: int, tmp_path: Path) -> None:
    found, true = diagnosed(tmp_path, part, number, SEED)
    assert true == set()
    assert found.effects == []
    assert found.verdict == "NOTHING_MISSING"
