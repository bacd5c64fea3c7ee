"""The rule `published-map` as docs/model.md states it, worked out again without the library."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cyclosweep as cs

Windows = list[tuple[float, float]]


def windows_of_one_half(holes_deg: list[float], delta_deg: float, ratio: int) -> Windows:
    """Windows of left holes: angles counted with the travel, so none is above zero."""
    nearest = max(holes_deg)
    windows = []
    for phi in holes_deg:
        start = max((phi + 90 + delta_deg) * ratio / (ratio + 1), 0.0)
        end = (phi + 270 - delta_deg) * ratio / (ratio + 1)
        windows.append((start, end if phi == nearest else min(end, 180.0)))
    return windows


def windows_by_the_text(drive: cs.Drive) -> Windows:
    """Windows of one disc's holes by the text."""
    pins = drive.output_pin_count
    along = drive.hole_clocking_deg + (np.arange(pins) + 0.5) * 360 / pins
    holes = [float(phi) for phi in 180 - (180 - along) % 360]
    delta = math.degrees(math.asin(drive.eccentricity_mm / 2 / drive.output_pin_circle_radius_mm))
    left = windows_of_one_half([phi for phi in holes if phi <= 0], delta, drive.ratio)
    mirrored = windows_of_one_half([-phi for phi in holes if phi > 0], delta, drive.ratio)
    return [*left, *((360 - end, 360 - start) for start, end in mirrored)]


@pytest.mark.parametrize("pins", [6, 7, 8, 9, 10])
def test_the_text_gives_the_library_s_counts(reference: cs.Drive, pins: int) -> None:
    drive = reference.replace(output_pin_count=pins)
    windows = np.array(windows_by_the_text(drive))
    found = drive.active_pins("published-map")
    mean = drive.disc_count * (windows[:, 1] - windows[:, 0]).sum() / 360
    assert mean == pytest.approx(found.mean, rel=1e-12)
    edges = np.unique(np.clip(np.append(windows.ravel(), [0.0, 360.0]), 0, 360))
    middles = 0.5 * (edges[1:] + edges[:-1])[np.diff(edges) > 1e-9]
    open_at = (windows[:, 0] < middles[:, None]) & (middles[:, None] < windows[:, 1])
    counts = drive.disc_count * open_at.sum(axis=1)
    assert (counts.min(), counts.max()) == (found.minimum, found.maximum)


def test_the_worked_example_of_the_page(reference: cs.Drive) -> None:
    """H1 stands at -23.7 deg; counted as +23.7 deg its window would open at 112.8 deg."""
    delta = math.degrees(math.asin(0.62 / 90))
    [(start, end)] = windows_of_one_half([-22.5 - 1.2], delta, 87)
    first = reference.hole_windows("published-map").row(0, named=True)
    assert (first["hole"], first["half"]) == (1, "left")
    assert (first["start_deg"], first["end_deg"]) == pytest.approx((start, end), abs=1e-9)
    assert (start, end) == pytest.approx((65.94, 243.11), abs=5e-3)
    assert reference.active_pins("published-map").mean == pytest.approx(6.6743, abs=5e-5)


def test_the_printed_mean_needs_a_carrier_that_does_not_turn(reference: cs.Drive) -> None:
    """At 87:1, no eccentricity and no clocking it is 6.696; 6.75 is the limit of the ratio."""
    symmetric = reference.replace(eccentricity_mm=1e-9, hole_clocking_deg=0.0)
    assert symmetric.active_pins("published-map").mean == pytest.approx(6.696, abs=5e-4)
    slow = symmetric.replace(ratio=300).active_pins("published-map").mean
    assert 6.73 < slow < 6.75
