"""The Rust core against its slow twin, every column of random drives."""

from __future__ import annotations

import math

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from tests.drives import random_drive, random_drives
from tests.parity import twin

LOADS = (0.5, 1.0, 3.0, 4.5)
COUNTS = ("active_pins_min", "active_pins_max")


def differences(drive: cs.Drive) -> list[str]:
    """Columns in which core and twin disagree, with both numbers."""
    computed = drive.evaluate(LOADS)
    expected = twin.evaluate(drive, LOADS)
    assert list(computed) == list(expected)
    size = drive.disc_outer_radius_mm
    found = []
    for name, value in expected.items():
        here = computed[name]
        if value is None or here is None:
            same = value is here
        elif name in COUNTS:
            same = here == value
        else:
            # A web is a difference of lengths as large as the disc.
            same = math.isclose(here, value, rel_tol=1e-12) or (
                name == "hole_web_mm" and math.isclose(here, value, abs_tol=1e-13 * size)
            )
        if not same:
            found.append(f"{name}: core {here!r}, twin {value!r}")
    return found


@pytest.mark.parametrize("seed", range(8))
def test_every_column_of_random_drives(seed: int) -> None:
    for drive in random_drives(seed, 125):
        assert differences(drive) == [], drive


@pytest.mark.parametrize("criterion", ["published-map", "inside", "statics"])
@pytest.mark.parametrize("disc_count", [1, 2, 3, 4])
def test_every_pin_count(criterion: str, disc_count: int) -> None:
    rng = np.random.default_rng(disc_count)
    for pins in range(3, 65):
        drive = random_drive(rng, output_pin_count=pins, disc_count=disc_count, criterion=criterion)
        assert differences(drive) == [], drive


@pytest.mark.parametrize("ratio", [3, 4, 5, 8, 299, 300])
def test_extreme_ratios(ratio: int) -> None:
    rng = np.random.default_rng(ratio)
    for _ in range(60):
        drive = random_drive(rng, ratio=ratio)
        assert differences(drive) == [], drive


def test_the_reference_drive(reference: cs.Drive) -> None:
    assert differences(reference) == []


@pytest.mark.parametrize("turns", [1, -3, 50, 1e4])
def test_clocking_by_whole_pitches_changes_nothing(reference: cs.Drive, turns: float) -> None:
    """Holes bear no numbers; far clockings must not cost digits either."""
    clocked = reference.replace(hole_clocking_deg=45.0 * turns)
    straight = reference.replace(hole_clocking_deg=0.0)
    expected = straight.evaluate()
    for name, value in clocked.evaluate().items():
        assert value == pytest.approx(expected[name], rel=1e-12), name


@pytest.mark.parametrize("criterion", ["published-map", "inside", "statics"])
@pytest.mark.parametrize("clocking", [1e17, -1e300])
def test_an_absurd_clocking_is_answered(
    reference: cs.Drive, criterion: cs.drive.Criterion, clocking: float
) -> None:
    """Where the clocking's own digits end, the counts still are counts."""
    pins = reference.replace(hole_clocking_deg=clocking, output_pin_count=9).active_pins(criterion)
    assert 0 < pins.minimum <= pins.mean <= pins.maximum <= 18
    assert pins.sectors["end_deg"][-1] == pytest.approx(360)


def test_status_of_wild_variants() -> None:
    """A variant is refused exactly when the twin finds a reason, and for one of its reasons."""
    rng = np.random.default_rng(11)
    rows = 4000
    drive = next(random_drives(5, 1, ratio=20, output_pin_count=8))
    drive = drive.replace(shaft=cs.Drive.reference_87().shaft, output_stiffness_nm_per_arcmin=None)
    base = drive.values()
    table = {}
    names = [name for name in drive.inputs() if name != "criterion"]
    for name in names:
        value = base[name] if math.isfinite(base[name]) else 1.0
        wild = np.full(rows, value)
        touched = rng.random(rows) < 2.0 / len(names)
        factors = rng.choice([-1, 0, 0.01, 0.5, 1.5, 3, 30, np.nan, np.inf], size=rows)
        wild[touched] = value * factors[touched] if value else factors[touched]
        table[name] = wild
    table["input_inertia_kg_m2"][::7] = np.nan
    frame = pl.DataFrame(table)
    statuses = cs.sweep(cs.Space.table(drive, frame))["status"].to_list()
    kinds = [segment.kind for segment in drive.shaft]
    for status, row in zip(statuses, frame.iter_rows(named=True), strict=True):
        reasons = twin.refusals({"criterion": 0.0, **row}, kinds)
        assert (status == "ok" and not reasons) or status in reasons, (status, reasons, row)
    assert len(set(statuses)) > 10
