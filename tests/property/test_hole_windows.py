"""Windows of single holes add up to the counts of the core, which knows no single holes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.design.active_pins import CRITERIA
from tests.drives import random_drives

KINDS: list[dict[str, float]] = [
    {}, {"ratio": 3}, {"ratio": 4, "hole_clocking_deg": 0.0}, {"hole_clocking_deg": 0.0},
    {"output_pin_count": 3}, {"output_pin_count": 64, "disc_count": 4},
]  # fmt: skip


def disagreement(drive: cs.Drive) -> str | None:
    """How windows of holes and sectors of the whole disagree, if they do."""
    for criterion in CRITERIA:
        windows, counts = drive.hole_windows(criterion), drive.active_pins(criterion)
        start, end = windows["start_deg"].to_numpy(), windows["end_deg"].to_numpy()
        if not (np.all(start >= 0) and np.all(end <= 360) and np.all(end > start)):
            return f"{criterion}: a window leaves the turn"
        if abs((end - start).sum() / 360 - counts.mean) > 1e-9:
            return f"{criterion}: mean {(end - start).sum() / 360} against {counts.mean}"
        # Neighbours of equal count are one sector: in its middle two windows may meet.
        for first, last, active in counts.sectors.iter_rows():
            at = 0.617 * first + 0.383 * last
            if last - first > 1e-6 and ((start < at) & (at < end)).sum() != active:
                return f"{criterion}: at {at} deg expected {active}"
    return None


@pytest.mark.parametrize("fixed", KINDS, ids=str)
def test_windows_add_up_to_the_sectors(fixed: dict[str, float]) -> None:
    for drive in random_drives(len(str(fixed)), 40, **fixed):
        assert disagreement(drive) is None, drive


@pytest.mark.parametrize("wrong", ["published_map", "insde", "", 3])
def test_another_criterion_is_refused_as_active_pins_refuses_it(
    reference: cs.Drive, wrong: Any
) -> None:
    lines = []
    for ask in (reference.active_pins, reference.hole_windows):
        with pytest.raises(cs.InputError, match=r"criterion: found .*, expected one of") as caught:
            ask(wrong)
        lines.append(str(caught.value))
    assert lines[0] == lines[1]


def test_the_holes_of_the_paper_open_where_it_says(reference: cs.Drive) -> None:
    ideal = reference.replace(hole_clocking_deg=0.0, eccentricity_mm=1e-6)
    first = ideal.hole_windows("published-map").row(0, named=True)
    assert (first["hole"], first["half"], first["index"]) == (1, "left", 7)
    assert first["start_deg"] == pytest.approx(67.5 * 87 / 88, abs=1e-4)
    halves = ideal.hole_windows().filter(disc=1).group_by("half", maintain_order=True).len()
    assert halves.rows() == [("left", 4), ("right", 4)]
