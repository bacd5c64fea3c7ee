"""Gaps of single pins and holes: every one of them passes the load, wherever it stands."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs

CATALOGUE = Path(__file__).parents[2] / "examples" / "catalogue-29.toml"
WHOLE_TURN = 2.0 * math.pi


@pytest.fixture(scope="module")
def drive() -> cs.Drive:
    return cs.Drive.from_toml(CATALOGUE)


def with_gap(drive: cs.Drive, kind: str, at: int) -> cs.Drive:
    """A hole 0.05 mm too wide, or two neighbouring ring pins 0.008 mm too near."""
    if kind == "hole":
        return drive.replace(hole_gap_errors_mm=list(np.eye(drive.output_pin_count)[at] * 0.05))
    pins = np.eye(drive.ratio + 1)
    return drive.replace(ring_gap_errors_mm=list(-0.008 * (pins[at] + pins[at + 1])))


def row(drive: cs.Drive) -> dict[str, float]:
    return cs.sweep(cs.Space.grid(drive), model="components", solver="full").row(0, named=True)


@pytest.mark.parametrize(
    ("kind", "column", "tolerance"),
    [
        ("hole", "transmission_error_pp_arcmin", 0.01),
        ("hole", "output_pin_force_max_n", 0.001),
        ("hole", "loaded_twist_arcmin", 0.001),
        ("ring", "ring_pin_force_max_n", 0.02),
        ("ring", "transmission_error_pp_arcmin", 0.2),
        ("ring", "backlash_arcmin", 0.005),
    ],
)
def test_a_single_gap_counts_alike_wherever_it_stands(
    drive: cs.Drive, kind: str, column: str, tolerance: float
) -> None:
    found = [row(with_gap(drive, kind, at))[column] for at in (0, 3, 6)]
    assert max(found) - min(found) < tolerance * min(found), found


def test_a_wide_hole_shows_as_much_as_over_the_whole_cycle(drive: cs.Drive) -> None:
    worn = with_gap(drive, "hole", 3)
    # The holes pass the eccentricity once in N / (N + 1) turns of the crank.
    cycle = WHOLE_TURN * drive.ratio / (drive.ratio + 1)
    states = [worn.loaded(crank_rad=crank) for crank in np.linspace(0.0, cycle, 193)[:-1]]
    twists = np.array([state.twist_arcmin for state in states])
    found = row(worn)
    assert found["transmission_error_pp_arcmin"] == pytest.approx(np.ptp(twists), rel=0.02)
    assert found["loaded_twist_arcmin"] == pytest.approx(twists.mean(), rel=0.001)
    perfect = row(drive)
    assert found["transmission_error_pp_arcmin"] > 5.0 * perfect["transmission_error_pp_arcmin"]


def test_equal_gaps_are_a_clearance(drive: cs.Drive) -> None:
    listed = row(drive.replace(hole_gap_errors_mm=[0.0] * drive.output_pin_count))
    plain = row(drive)
    assert {k: v for k, v in listed.items() if k in plain} == plain
