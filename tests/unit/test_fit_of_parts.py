"""What of a drive's parts does not fit together: where holes break out, and what a warning says."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import cyclosweep as cs
from cyclosweep.choose.fit_of_parts import misfits
from cyclosweep.design.disc_stack import overlaps

CATALOGUE = Path(__file__).parents[2] / "examples" / "catalogue-29.toml"


@pytest.fixture(scope="module")
def drive() -> cs.Drive:
    return cs.Drive.from_toml(CATALOGUE)


@pytest.mark.parametrize(
    ("circle_mm", "clearance_mm", "status"),
    [(40.4, 0.02, "ok"), (40.4, 0.12, "holes_break_profile"), (41.0, 0.02, "holes_break_profile")],
)
def test_holes_reach_no_farther_than_the_roots(
    drive: cs.Drive, circle_mm: float, clearance_mm: float, status: str
) -> None:
    # The roots lie at 52.5 - 3.5 - 1.25 - 0.01 mm, a hole's edge 7.25 mm and the clearance beyond
    # its circle; the disc's outer radius says nothing of it.
    wide = drive.replace(
        output_pin_circle_radius_mm=circle_mm,
        hole_clearance_mm=clearance_mm,
        disc_outer_radius_mm=50.25,
    )
    frame = cs.sweep(cs.Space.grid(wide), model="components")
    assert frame["status"].to_list() == [status]
    if status != "ok":
        assert frame["loaded_twist_arcmin"].null_count() == 1
        with pytest.raises(cs.DesignError, match="break through"):
            wide.loaded()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"disc_outer_radius_mm": 50.25}, "roots of the profile lie at 47.75"),
        ({"disc_2_reach_mm": 12.0}, "discs 1 and 2, 13.5 mm wide, stand in one another"),
        ({"disc_1_reach_mm": 1.0}, "stands in the flange"),
        ({"output_pin_length_mm": 20.0}, "end before the last disc does, at 30.75 mm"),
    ],
)
def test_what_does_not_fit_is_said(drive: cs.Drive, changes: dict[str, Any], words: str) -> None:
    (found,) = misfits(drive.replace(**changes))
    assert words in found


def test_nothing_is_said_of_parts_that_fit(drive: cs.Drive) -> None:
    assert not list(misfits(drive))
    assert not list(misfits(cs.Drive.reference_87()))


def test_discs_that_are_no_neighbours_may_stand_in_one_another() -> None:
    assert list(overlaps([9.0, 24.0, 10.0], 13.5)) == [(1, 3, 1.0)]
    assert not list(overlaps([9.0, 24.0, 39.0], 13.5))
