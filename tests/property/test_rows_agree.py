"""No row of a sweep contradicts itself: each result follows from other columns of the same row."""

from __future__ import annotations

import math
from typing import Any

import pytest

import cyclosweep as cs
from cyclosweep.design.drive import Criterion
from tests.drives import random_drives

LOADS = (-4.5, -1.0, 0.5, 1.0, 3.0)
CRITERIA: tuple[Criterion, ...] = ("published-map", "inside", "statics")


def twist_name(load: float) -> str:
    return f"twist_{load:g}tn_deg".replace(".", "p").replace("-", "minus_")


def drives(criterion: Criterion, **fixed: Any) -> list[cs.Drive]:
    return list(random_drives(41, 120, criterion=criterion, **fixed))


@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize("stiffness", [None, 12.5])
def test_every_twist_follows_from_its_row(criterion: Criterion, stiffness: float | None) -> None:
    found = 0
    fixed: dict[str, Any] = {"input_inertia_kg_m2": 0.003}
    if stiffness is not None:
        fixed["output_stiffness_nm_per_arcmin"] = stiffness
    for drive in drives(criterion, **fixed):
        row = drive.evaluate(LOADS)
        compliance = row["output_compliance_rad_per_nm"]
        if compliance is None:
            assert criterion == "statics"
            assert row["statics_applicable"] == 0
            names = [
                *("reflected_compliance_rad_per_nm", "reflected_stiffness_nm_per_rad"),
                *("output_stiffness_nm_per_arcmin", "natural_frequency_hz"),
                *("natural_frequency_with_efficiency_hz", *map(twist_name, LOADS)),
            ]
            assert all(row[name] is None for name in names)
            continue
        found += 1
        measured = drive.output_stiffness_nm_per_arcmin is not None
        eta = row["torque_transfer_efficiency"]
        assert eta is not None
        factor = 1.0 if measured or criterion == "statics" else eta
        reflected = compliance * drive.ratio**2
        slope = math.degrees(factor * reflected * drive.nominal_torque_nm)
        expected = {
            "compliance_factor": factor,
            "reflected_compliance_rad_per_nm": reflected,
            "reflected_stiffness_nm_per_rad": 1 / reflected,
            "output_stiffness_nm_per_arcmin": math.pi / 10800 / compliance,
            "natural_frequency_hz": math.sqrt(1 / reflected / 0.003) / math.tau,
            "natural_frequency_with_efficiency_hz": math.sqrt(1 / (factor * reflected) / 0.003)
            / math.tau,
        }
        for load in LOADS:
            expected[twist_name(load)] = slope * load + math.copysign(drive.free_play_deg, load)
        if not measured:
            pins = float(drive.output_pin_count)
            if criterion == "statics":
                share = row["pin_participation_statics"]
                assert share is not None
                pins = drive.output_pin_count * share
                by_statics = row["output_compliance_statics_rad_per_nm"]
                assert by_statics == pytest.approx(compliance, rel=1e-14)
            shaft, pin = row["shaft_compliance_rad_per_nm"], row["pin_compliance_rad_per_nm"]
            assert shaft is not None
            assert pin is not None
            expected["output_compliance_rad_per_nm"] = shaft + pin / pins
        for name, value in expected.items():
            assert row[name] == pytest.approx(value, rel=1e-12), (name, drive)
    assert found > 40


@pytest.mark.parametrize("disc_count", [1, 2, 3, 4])
@pytest.mark.parametrize("criterion", CRITERIA)
def test_what_rests_on_statics_is_null_where_they_do_not_apply(
    disc_count: int, criterion: Criterion
) -> None:
    applies = disc_count <= 2
    space = cs.Space.grid(
        cs.Drive.reference_87().replace(disc_count=disc_count, criterion=criterion),
        eccentricity_mm=[0.5, 0.6],
    )
    frame = cs.sweep(space)
    assert frame["status"].to_list() == ["ok", "ok"]
    for name in ("pin_participation_statics", "output_compliance_statics_rad_per_nm"):
        assert frame[name].is_null().any() is not applies
    for name in ("output_compliance_rad_per_nm", "twist_1tn_deg", "natural_frequency_hz"):
        assert frame[name].is_null().any() is not (applies or criterion != "statics")
    assert not frame["pin_force_max_n"].is_null().any()


def test_a_line_by_statics_needs_one_or_two_discs() -> None:
    drive = cs.Drive.reference_87().replace(disc_count=3, criterion="statics")
    with pytest.raises(cs.DesignError, match="one or two discs, found 3"):
        drive.nominal_line()


@pytest.mark.parametrize("criterion", CRITERIA)
def test_negative_loads_are_positive_ones_in_a_mirror(criterion: Criterion) -> None:
    for drive in random_drives(3, 40, criterion=criterion, disc_count=2):
        row = drive.evaluate((2.5, -2.5))
        assert row["twist_minus_2p5tn_deg"] == -(row["twist_2p5tn_deg"] or math.nan)


@pytest.mark.parametrize("load", [math.nan, math.inf, -math.inf])
def test_a_load_that_is_no_number_is_refused(load: float) -> None:
    with pytest.raises(cs.InputError, match="loads_tn"):
        cs.Drive.reference_87().evaluate((1.0, load))


@pytest.mark.parametrize(("pins", "force"), [(5, 10_915.0), (3, 16_240.0), (7, 7_315.0)])
def test_the_largest_pin_force_of_one_disc_is_that_of_its_worst_position(
    pins: int, force: float
) -> None:
    """Against every position of the mesh zone; 585 N m on 45 mm."""
    drive = cs.Drive.reference_87().replace(disc_count=1, output_pin_count=pins)
    largest = 0.0
    for k in range(20_000):
        theta = math.tau * k / 20_000
        sines = [max(math.sin(theta - math.tau * pin / pins), 0.0) for pin in range(pins)]
        shares = math.fsum(sine**2 for sine in sines)
        largest = max(largest, 585.0 / 0.045 * max(sines) / shares)
    found = drive.evaluate()["pin_force_max_n"]
    assert found == pytest.approx(largest, rel=1e-6)
    assert found == pytest.approx(force, rel=1e-3)
