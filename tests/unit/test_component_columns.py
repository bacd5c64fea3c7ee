"""Columns of the component model against single states, and what bad input makes of a row."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.design.part_units import PART_OUTPUTS

EXAMPLE = Path(__file__).parents[2] / "examples" / "components-87.toml"


@pytest.fixture(scope="module")
def drive() -> cs.Drive:
    return cs.Drive.from_toml(EXAMPLE).replace(hole_gap_errors_mm=[0.0] * 3 + [-0.03] + [0.0] * 4)


def test_worst_contacts_and_extremes_are_those_of_the_states(drive: cs.Drive) -> None:
    row = cs.sweep(cs.Space.grid(drive), model="components", solver="full").row(0, named=True)
    # One hole differs: all eight periods of the output pins are looked through.
    cranks = [360 / 8 * 87 / 88 * k / 8 for k in range(8 * 8)]
    states = [drive.loaded(crank_rad=math.radians(crank)) for crank in cranks]
    output = np.array([state.output_pin_forces_n for state in states])
    worst, _, pin = np.unravel_index(output.argmax(), output.shape)
    assert row["output_contact_pressure_max_pin"] == pin
    assert row["output_contact_pressure_max_crank_deg"] == pytest.approx(cranks[worst])
    assert row["output_pin_force_peak_min_n"] == pytest.approx(output.max(axis=(1, 2)).min())
    ring = np.array([state.ring_pin_forces_n for state in states])
    assert row["ring_pin_force_peak_min_n"] == pytest.approx(ring.max(axis=(1, 2)).min())
    pressures = [state.contact_pressures_mpa["ring"] for state in states]
    assert row["ring_contact_pressure_max_crank_deg"] == pytest.approx(
        cranks[int(np.argmax(pressures))]
    )
    forces = ring[int(np.argmax(pressures))].max(axis=0)
    assert forces[row["ring_contact_pressure_max_pin"]] > 0
    shifts = np.array([state.disc_translation_mm for state in states])
    bearing = 4e5 * np.hypot(shifts[..., 0], shifts[..., 1])
    assert row["eccentric_bearing_force_min_n"] == pytest.approx(bearing.min())
    assert row["eccentric_bearing_force_max_n"] == pytest.approx(bearing.max())
    moment = (output.max(axis=(0, 2)) * [8.0, 24.0]).max()
    assert row["pin_root_stress_max_mpa"] == pytest.approx(32 * moment / (math.pi * 16**3))
    assert row["pin_yield_ratio_max"] == pytest.approx(row["pin_root_stress_max_mpa"] / 750)
    pressure = max(row["ring_contact_pressure_max_mpa"], row["output_contact_pressure_max_mpa"])
    assert row["contact_yield_ratio_max"] == pytest.approx(2 * 0.30028 * pressure / 1700)


def test_stiffness_without_clearance_is_that_of_the_tight_drive(drive: cs.Drive) -> None:
    name = "tangent_stiffness_100pct_without_clearance_nm_per_arcmin"
    loose = drive.replace(ring_circle_enlargement_mm=0.005, eccentric_bearing_clearance_mm=0.01)
    tight = drive.replace(hole_clearance_mm=0, ring_clearance_mm=0, hole_gap_errors_mm=None)
    scan = cs.scan(cs.Space.grid(loose), model="components", solver="full")
    found = scan.select(name).collect().item()
    full = cs.scan(cs.Space.grid(tight), model="components", solver="full")
    expected = full.select("tangent_stiffness_100pct_nm_per_arcmin").collect().item()
    assert found == pytest.approx(expected, rel=1e-9)


def swept(drive: cs.Drive, solver: Any, **inputs: list[float]) -> pl.DataFrame:
    frame = pl.DataFrame(inputs)
    found = cs.sweep(cs.Space.table(drive, frame), model="components", solver=solver)
    assert found.height == frame.height
    results = found.select(*PART_OUTPUTS)
    for name, dtype in results.schema.items():
        if dtype.is_float():
            values = results[name].drop_nulls()
            assert values.is_finite().all(), name
    return found


@pytest.mark.parametrize("solver", ["full", "quadratic"])
@pytest.mark.parametrize(
    ("inputs", "status"),
    [
        ({"ring_pin_radius_mm": [3.0], "eccentricity_mm": [0.99]}, "profile_undercut"),
        ({"ring_pin_radius_mm": [3.5]}, "ring_pins_overlap"),
        ({"disc_width_mm": [0.0]}, "component_input_out_of_range"),
        ({"disc_width_mm": [-1.0]}, "component_input_out_of_range"),
        ({"disc_width_mm": [math.inf]}, "component_input_out_of_range"),
        ({"disc_width_mm": [math.nan]}, "component_input_missing"),
        ({"hole_clearance_mm": [-0.9]}, "component_input_out_of_range"),
        ({"hole_clearance_mm": [9.0]}, "component_input_out_of_range"),
        ({"ring_clearance_mm": [0.9]}, "component_input_out_of_range"),
        ({"ring_clearance_mm": [math.inf]}, "component_input_out_of_range"),
        ({"eccentric_bearing_stiffness_n_per_mm": [0.0]}, "component_input_out_of_range"),
        ({"friction_ring": [-0.1]}, "component_input_out_of_range"),
        ({"contact_yield_strength_mpa": [0.0]}, "component_input_out_of_range"),
        ({"disc_poisson_ratio": [0.6]}, "component_input_out_of_range"),
    ],
)
def test_what_cannot_be_built_keeps_its_row(
    drive: cs.Drive, inputs: dict[str, list[float]], status: str, solver: str
) -> None:
    row = swept(drive, solver, **inputs).row(0, named=True)
    assert row["status"] == status
    assert [row[name] for name in PART_OUTPUTS] == [None] * len(PART_OUTPUTS)


@pytest.mark.parametrize("solver", ["full", "quadratic"])
def test_an_interference_is_a_preload(drive: cs.Drive, solver: str) -> None:
    even = drive.replace(hole_gap_errors_mm=None, ring_clearance_mm=0.0)
    gaps = [0.0, -0.01, -0.05, -0.5]
    found = swept(even, solver, hole_clearance_mm=gaps, ring_clearance_mm=gaps)
    assert found["status"].to_list() == ["ok"] * 4
    assert found["solver_status"].to_list() == [solver] * 4
    # The tighter, the stiffer near zero load and the less lost motion; beyond yield at last.
    assert found["lost_motion_3pct_arcmin"].is_sorted(descending=True)
    assert found["tangent_stiffness_3pct_nm_per_arcmin"].is_sorted()
    assert found["backlash_arcmin"].max() == 0
    assert found["contact_yield_ratio_max"][0] < 1 < found["contact_yield_ratio_max"][-1]


@pytest.mark.parametrize("solver", ["full", "quadratic"])
def test_a_load_beyond_yield_is_said_and_one_without_equilibrium_is_null(
    drive: cs.Drive, solver: str
) -> None:
    found = swept(drive, solver, output_torque_nm=[585.0, 2e4, 1e8, 1e-6])
    assert found["status"].to_list() == ["ok"] * 4
    assert found["contact_yield_ratio_max"][0] < 1 < found["contact_yield_ratio_max"][1]
    assert found["pin_yield_ratio_max"][0] < 1 < found["pin_yield_ratio_max"][1]
    assert found["solver_status"][2] == "failed"
    for name in ("loaded_twist_arcmin", "contact_yield_ratio_max", "efficiency"):
        assert found[name][2] is None
    # Without any force that counts as one there may be no equilibrium either; then it says so.
    assert (found["solver_status"][3] == "failed") == (found["loaded_twist_arcmin"][3] is None)


def test_a_single_state_refuses_with_a_reason(drive: cs.Drive) -> None:
    for changes, message in (
        ({"hole_clearance_mm": -1.0}, "hole_clearance_mm is -1, expected above minus"),
        ({"hole_clearance_mm": 9.0}, "holes do not meet"),
        ({"ring_clearance_mm": 1.0}, "ring_clearance_mm is 1, expected with profile_offset_mm"),
        ({"ring_pin_radius_mm": 3.5}, "overlap"),
    ):
        with pytest.raises(cs.DesignError, match=message):
            drive.replace(**changes).loaded()
        with pytest.raises(cs.DesignError, match=message):
            drive.replace(**changes).torque_twist()


def test_the_curve_of_a_preloaded_drive_has_no_free_play(drive: cs.Drive) -> None:
    tight = drive.replace(hole_gap_errors_mm=None, hole_clearance_mm=-0.01, ring_clearance_mm=-0.01)
    curve = tight.torque_twist("output", points=20)
    assert curve.reached
    assert max(map(abs, curve.free_play_deg)) < 1e-6
    assert curve.table["converged"].all()
    beyond = drive.torque_twist("output", to_load_tn=1e5, points=20)
    assert not beyond.reached
    missing = beyond.table.filter(~pl.col("converged"))
    assert missing["torque_nm"].null_count() == missing.height
