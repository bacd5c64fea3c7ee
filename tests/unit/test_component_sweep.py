"""The component model in a sweep: statuses, pushdown, limits, datasets and one drive's state."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.design.part_units import PART_INPUTS, PART_OUTPUTS
from cyclosweep.design.parts import PART_DEFAULTS
from cyclosweep.sweep.size import estimate

ASSUMED = [
    name for name, (kind, *_) in PART_DEFAULTS.items() if kind in ("number", "same", "widths")
]
"""Inputs of the component model for which a drive file that leaves them out has a number."""


@pytest.fixture(scope="module")
def drive() -> cs.Drive:
    """The reference drive with what the component model needs."""
    return cs.Drive.reference_87().replace(
        ring_pin_radius_mm=1.5,
        disc_width_mm=12.0,
        ring_clearance_mm=0.01,
        hole_clearance_mm=0.03,
        eccentric_bearing_stiffness_n_per_mm=4e5,
    )


def test_every_input_and_result_has_a_meaning() -> None:
    assert set(PART_INPUTS) == set(PART_DEFAULTS)
    study = cs.Study.of(cs.Space.grid(cs.Drive.reference_87()), model="components")
    parts = [name for name in study.outputs if name in PART_OUTPUTS]
    assert parts == list(PART_OUTPUTS)


def test_a_drive_file_keeps_the_parts(drive: cs.Drive, tmp_path: Path) -> None:
    given = drive.replace(
        contact_law="johnson",
        pin_root_compliance=(1.2, 0.2, 5.0),
        ring_gap_errors_mm=[0.001] * 88,
    )
    given.to_toml(tmp_path / "drive.toml")
    assert cs.Drive.from_toml(tmp_path / "drive.toml") == given


def test_defaults_are_marked_as_assumed(drive: cs.Drive) -> None:
    table = drive.part_table()
    marks = dict(zip(table["key"], table["mark"], strict=True))
    assert marks["disc_width_mm"] == "given"
    assert marks["friction_ring"] == "assumed: default"
    assert cs.Drive.reference_87().part_table()["value"].null_count() == 6


def test_a_drive_without_parts_has_no_component_model() -> None:
    reference = cs.Drive.reference_87()
    with pytest.raises(cs.DesignError, match="ring_pin_radius_mm is missing"):
        reference.loaded()
    frame = cs.sweep(cs.Space.grid(reference), model="components")
    assert frame["status"].to_list() == ["component_input_missing"]
    assert frame["twist_1tn_deg"].null_count() == 1


@pytest.mark.parametrize(
    ("name", "value", "status"),
    [
        ("disc_width_mm", 0.0, "component_input_out_of_range"),
        ("friction_ring", -0.1, "component_input_out_of_range"),
        ("ring_poisson_ratio", 0.6, "component_input_out_of_range"),
        ("ring_pin_radius_mm", 4.0, "ring_pins_overlap"),
        ("eccentricity_mm", 0.82, "profile_undercut"),
        ("ring_pin_radius_mm", math.nan, "component_input_missing"),
        *((name, math.nan, "non_finite_input") for name in ASSUMED),
        ("eccentricity_mm", 0.9, "eccentricity_too_large_for_ring"),
    ],
)
def test_what_cannot_be_keeps_its_row(
    drive: cs.Drive, name: str, value: float, status: str
) -> None:
    table = drive.part_table()
    usual = dict(zip(table["key"], table["value"], strict=True)).get(name, drive.eccentricity_mm)
    space = cs.Space.table(drive, pl.DataFrame({name: [usual, value]}))
    frame = cs.sweep(space, model="components")
    assert frame["status"].to_list() == ["ok", status]
    results = frame.select(pl.exclude("variant", "status", name))
    assert all(column[1] is None for column in results)
    assert frame["loaded_twist_arcmin"][0] > 0
    numbers = frame.select(pl.col(pl.Float64)).drop(name)
    assert not any(column.is_nan().any() for column in numbers)


def test_an_interference_is_a_preload(drive: cs.Drive) -> None:
    space = cs.Space.grid(drive, hole_clearance_mm=[-0.005, 0.0, 0.03], ring_clearance_mm=[0.0])
    frame = cs.sweep(space, model="components")
    assert frame["solver_status"].null_count() == 0
    assert (frame["solver_status"] != "failed").all()
    stiffness = frame["tangent_stiffness_3pct_nm_per_arcmin"].to_list()
    assert stiffness[0] > stiffness[1] > stiffness[2]
    assert frame["backlash_arcmin"][0] == 0 < frame["backlash_arcmin"][2]


def test_an_empty_cell_says_why_the_row_has_no_results(drive: cs.Drive) -> None:
    designs = {"hole_clearance_mm": [0.05, None, 0.02]}
    found = cs.evaluate_table(drive, designs, model="components")
    assert found["status"].to_list() == ["ok", "non_finite_input", "ok"]
    assert found["reason"][1] == "hole_clearance_mm is not a finite number"


def test_a_stiffness_that_is_given_replaces_the_shaft(drive: cs.Drive) -> None:
    both = drive.replace(output_stiffness_nm_per_arcmin=20.0)
    column = "loaded_twist_arcmin"
    without, given, alone = (
        cs.sweep(cs.Space.grid(each), model="components")[column][0]
        for each in (drive, both, both.replace(shaft=()))
    )
    assert given == alone < without
    assert given == pytest.approx(both.loaded(both.output_torque_nm).twist_arcmin, rel=0.02)
    axis = pl.DataFrame({"output_stiffness_nm_per_arcmin": [None, 20.0]})
    rows = cs.sweep(cs.Space.table(drive, axis), model="components")
    assert rows[column].to_list() == [without, given]


@pytest.mark.parametrize(
    ("ring", "hole"),
    [
        *((clearance, 0.05) for clearance in (0.02, 0.0, -0.001, -0.01, -0.02)),
        *((0.02, clearance) for clearance in (-0.001, -0.02, -0.1)),
        (-0.01, -0.005),
    ],
)
def test_backlash_is_what_a_small_load_takes_up(drive: cs.Drive, ring: float, hole: float) -> None:
    # Contacts that interfere push the discs along their eccentricity, and so close others.
    preloaded = drive.replace(ring_clearance_mm=ring, hole_clearance_mm=hole)
    row = cs.sweep(cs.Space.grid(preloaded), model="components", solver="full").row(0, named=True)
    small = 1e-3 * preloaded.output_torque_nm
    period = 2 * math.pi / preloaded.output_pin_count * preloaded.ratio / (preloaded.ratio + 1)
    cranks = [period * k / 8 for k in range(8)]
    there, back = (
        np.mean([preloaded.loaded(sense * small, crank).twist_arcmin for crank in cranks])
        for sense in (1.0, -1.0)
    )
    tight = 2 * small / row["tangent_stiffness_3pct_nm_per_arcmin"]
    assert row["backlash_arcmin"] == pytest.approx(there - back, rel=0.03, abs=1.5 * tight)
    assert row["backlash_arcmin"] < row["lost_motion_3pct_arcmin"]


def test_a_column_is_the_same_whatever_is_asked_for_beside_it(drive: cs.Drive) -> None:
    space = cs.Space.sobol(drive, 16, hole_clearance_mm=(0, 0.1), disc_width_mm=(6, 14))
    whole = cs.sweep(space, model="components")
    for name in PART_OUTPUTS:
        alone = cs.scan(space, model="components").select(name).collect()
        assert alone[name].equals(whole[name]), name


def test_bits_do_not_depend_on_the_cut(drive: cs.Drive) -> None:
    space = cs.Space.sobol(drive, 40, hole_clearance_mm=(0, 0.1), ring_clearance_mm=(0, 0.02))
    whole = cs.sweep(space, model="components")
    parts = [cs.sweep(space[a:b], model="components") for a, b in ((0, 7), (7, 23), (23, 40))]
    assert pl.concat(parts).equals(whole)
    picked = cs.scan(space, model="components").filter(pl.col("variant").is_in([3, 30]))
    assert picked.collect().equals(whole[[3, 30]])


def test_a_limit_on_a_solved_column(drive: cs.Drive) -> None:
    space = cs.Space.grid(drive, hole_clearance_mm=[0.0, 0.1])
    limits = {"hole_web_mm": (0.1, None), "lost_motion_3pct_arcmin": (None, 10.0)}
    frame = cs.sweep(space, model="components", limits=limits)
    assert frame["status"].to_list() == ["ok", "limit_lost_motion_3pct_arcmin"]
    assert frame["loaded_twist_arcmin"].null_count() == 1
    with pytest.raises(cs.InputError, match="does not vary"):
        cs.sweep(space, model="components", limits={"disc_width_mm": (1, 2)})
    with pytest.raises(cs.InputError, match="no such column"):
        cs.sweep(space, limits={"lost_motion_3pct_arcmin": (None, 10.0)})


def test_a_dataset_is_resumed_and_knows_its_model(drive: cs.Drive, tmp_path: Path) -> None:
    space = cs.Space.sobol(drive, 32, hole_clearance_mm=(0, 0.1))
    cs.sink(space, tmp_path, model="components", rows_per_part=8)
    (tmp_path / "part-000001.parquet").unlink()
    cs.sink(space, tmp_path, model="components", rows_per_part=8)
    found = cs.scan_dataset(tmp_path).collect()
    assert found.equals(cs.sweep(space, model="components"))
    with pytest.raises(cs.InputError, match="another study"):
        cs.sink(space, tmp_path, model="components", solver="full", rows_per_part=8)


def test_the_size_on_disk_is_foretold(drive: cs.Drive, tmp_path: Path) -> None:
    space = cs.Space.sobol(drive, 16_000, seed=1, output_pin_diameter_mm=(12, 16))
    study = cs.Study.of(space, model="components")
    foretold = estimate(study, tmp_path / "study").needed_bytes
    cs.sink(study, tmp_path / "study")
    written = sum(path.stat().st_size for path in (tmp_path / "study").glob("part-*"))
    assert foretold == pytest.approx(written, rel=0.2)


def test_a_study_file_names_the_model(drive: cs.Drive, tmp_path: Path) -> None:
    drive.to_toml(tmp_path / "drive.toml")
    text = 'drive = "drive.toml"\nmodel = "components"\nsolver = "full"\n'
    text += "[axes]\ndisc_width_mm = { values = [10.0, 12.0] }\n"
    (tmp_path / "study.toml").write_text(text)
    study = cs.Study.from_toml(tmp_path / "study.toml")
    assert cs.sweep(study)["solver_status"].to_list() == ["full", "full"]


def test_parts_do_not_change_a_published_study() -> None:
    reference = cs.Drive.reference_87()
    plain = cs.Study.of(cs.Space.grid(reference, eccentricity_mm=[0.6]))
    with_parts = reference.replace(ring_pin_radius_mm=1.5, disc_width_mm=12.0)
    assert plain.hash == cs.Study.of(cs.Space.grid(with_parts, eccentricity_mm=[0.6])).hash


def test_the_engines_agree(drive: cs.Drive) -> None:
    space = cs.Space.sobol(
        drive,
        128,
        disc_width_mm=(6, 14),
        hole_clearance_mm=(0, 0.1),
        ring_clearance_mm=(0, 0.02),
        output_torque_nm=(60, 900),
    )
    full = cs.sweep(space, model="components", solver="full")
    quick = cs.sweep(space, model="components")
    assert set(quick["solver_status"]) == {"quadratic"}
    for name in (
        "loaded_twist_arcmin",
        "tangent_stiffness_100pct_nm_per_arcmin",
        "output_pin_force_max_n",
        "ring_pin_force_max_n",
    ):
        error = np.abs((quick[name] / full[name] - 1).to_numpy())
        assert np.median(error) < 0.02, name
        assert np.quantile(error, 0.99) < 0.05, name


def test_a_state_is_in_equilibrium_and_its_budget_is_its_twist(drive: cs.Drive) -> None:
    for engine, tolerance in (("full", 1e-9), ("quadratic", 0.02)):
        state = drive.loaded(300.0, 1.1, engine=engine)  # type: ignore[arg-type]
        assert state.converged
        assert state.output_pin_forces_n.shape == (2, 8)
        assert state.ring_pin_forces_n.shape == (2, 88)
        assert state.disc_translation_mm.shape == (2, 2)
        assert state.budget["twist_arcmin"].sum() == pytest.approx(
            state.twist_arcmin, rel=tolerance
        )
        assert state.budget["share"].sum() == pytest.approx(1.0)


def test_wrong_loads_are_refused(drive: cs.Drive) -> None:
    for torque in (0.0, math.inf, math.nan):
        with pytest.raises(cs.InputError, match="output_torque_nm"):
            drive.loaded(torque)
    with pytest.raises(cs.InputError, match="crank_rad"):
        drive.loaded(100.0, math.nan)
    with pytest.raises(cs.InputError, match="model: found"):
        cs.sweep(cs.Space.grid(drive), model="finite elements")  # type: ignore[arg-type]
