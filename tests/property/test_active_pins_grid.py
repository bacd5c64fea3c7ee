"""Closed form of the active pins against each criterion's rule, point by point on a theta grid.

The oracle asks of every hole of every disc and every 0.01 deg of the mesh zone's travel whether
the rule holds; it knows no windows. CYCLOSWEEP_GRID_DRIVES sets how many random drives are
compared; 10,000 take five to ten minutes on one core.
"""

from __future__ import annotations

import os

import numpy as np
import numpy.typing as npt
import pytest

import cyclosweep as cs
from cyclosweep.design.drive import CRITERIA, Criterion
from tests.drives import random_drive, random_drives
from tests.parity import twin

DRIVES = int(os.environ.get("CYCLOSWEEP_GRID_DRIVES", "300"))
STEP_DEG = 0.01
POINTS = 36_000
THETA_DEG = (np.arange(POINTS) + 0.5) * STEP_DEG
THETA = np.radians(THETA_DEG)
MESH = np.exp(1j * THETA)  # unit vector of the eccentricity
EARLY_HALF = THETA_DEG < 180


def counted(drive: cs.Drive) -> dict[Criterion, npt.NDArray[np.int16]]:
    """Active contacts at every point of the grid, by every criterion."""
    e, radius = drive.eccentricity_mm, drive.output_pin_circle_radius_mm
    # Direction of the eccentricity as seen from a disc that spins back by theta / i.
    seen = MESH * np.exp(1j * THETA / drive.ratio)
    ahead, aside = np.ascontiguousarray(seen.real), np.ascontiguousarray(seen.imag)
    inside = np.zeros(POINTS, np.int16)
    statics = np.zeros(POINTS, np.int16)
    mapped = np.zeros(POINTS, np.int16)

    def is_inside(angle: float) -> npt.NDArray[np.bool_]:
        # |c|^2 of c = e u(theta) + R u(angle - theta / i), by the law of cosines.
        along = ahead * np.cos(angle) + aside * np.sin(angle)
        inside: npt.NDArray[np.bool_] = e**2 + radius**2 + 2 * e * radius * along < radius**2
        return inside

    for angle in np.radians(twin.hole_angles(drive)):
        for disc in range(drive.disc_count):
            phi = angle - 2 * np.pi * disc / drive.disc_count
            inside += is_inside(phi)
            # The push along the eccentricity turns the pin when it points ahead of it.
            statics += aside * np.cos(phi) - ahead * np.sin(phi) > 0
    reduced = [180 - (180 - angle) % 360 for angle in twin.hole_angles(drive)]
    left = [phi for phi in reduced if phi <= 0]
    # The right half is the left half's rule seen in a mirror.
    right = [-phi for phi in reduced if phi > 0]
    for half, direction in ((left, 1), (right, -1)):
        for phi in half:
            unclipped = EARLY_HALF | (phi == max(half))
            mapped += (is_inside(np.radians(phi)) & unclipped)[::direction]
    return {
        "inside": inside,
        "statics": statics,
        "published-map": (mapped * drive.disc_count).astype(np.int16),
    }


def disagreements(drive: cs.Drive) -> list[str]:
    """What closed form and grid do not agree on."""
    found = []
    for criterion, active in counted(drive).items():
        closed = drive.active_pins(criterion)
        lasts = twin.count(drive, criterion)
        windows, times = twin.windows_of(drive, criterion)
        # Each edge of a window falls between two points: half a step at most is lost there.
        resolution = len(windows) * times / POINTS
        if abs(closed.mean - active.mean()) > resolution:
            found.append(f"{criterion}: mean {closed.mean} against {active.mean()}")
        for here, there, duration in (
            (closed.minimum, active.min(), lasts.least_lasts),
            (closed.maximum, active.max(), lasts.most_lasts),
        ):
            if here != there and duration > STEP_DEG:
                found.append(f"{criterion}: extreme {here} against {there} for {duration} deg")
        if not closed.minimum <= active.min() <= active.max() <= closed.maximum:
            found.append(f"{criterion}: {active.min()}..{active.max()} leaves the closed form's")
    return found


@pytest.mark.parametrize("seed", range(6))
def test_closed_form_is_the_rule_on_the_grid(seed: int) -> None:
    for drive in random_drives(1000 + seed, -(-DRIVES // 6)):
        assert disagreements(drive) == [], drive


@pytest.mark.parametrize("ratio", [3, 4, 5])
def test_at_low_ratios_where_a_window_opens_twice(ratio: int) -> None:
    rng = np.random.default_rng(ratio)
    for _ in range(20):
        drive = random_drive(rng, ratio=ratio)
        assert disagreements(drive) == [], drive


def test_the_reference_drive(reference: cs.Drive) -> None:
    assert disagreements(reference) == []


@pytest.mark.parametrize("criterion", CRITERIA)
def test_sectors_are_the_grid_s_stretches(reference: cs.Drive, criterion: Criterion) -> None:
    for drive in [reference, *random_drives(3, 20)]:
        active = counted(drive)[criterion]
        sectors = drive.active_pins(criterion).sectors
        starts, ends = sectors["start_deg"].to_numpy(), sectors["end_deg"].to_numpy()
        assert starts[0] == 0
        assert ends[-1] == pytest.approx(360)
        assert np.array_equal(starts[1:], ends[:-1])
        assert np.all(ends > starts)
        expected = sectors["active"].to_numpy()[np.searchsorted(ends, THETA_DEG)]
        wrong = np.flatnonzero(expected != active)
        # A point within rounding of an edge may fall to either side.
        nearest = np.min(np.abs(THETA_DEG[wrong, None] - ends[None, :]), axis=1, initial=np.inf)
        assert np.all(nearest < 1e-9)
