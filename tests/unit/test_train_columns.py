"""Columns of the torsional train in sweeps, and many chains at once."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Literal

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.dynamics import natural_frequencies_hz

COLUMNS = ["natural_frequency_1_hz", "natural_frequency_2_hz", "reversal_shock_factor"]
COUPLING = {"flange_inertia_kg_m2": 0.012, "coupling_stiffness_nm_per_rad": 1e6}
PARTS = {"ring_pin_radius_mm": 2.0, "disc_width_mm": 12.0, "hole_clearance_mm": 0.05}


@pytest.mark.parametrize("load", [None, 5.0])
@pytest.mark.parametrize("coupling", [{}, COUPLING])
def test_columns_are_the_modes_of_the_drive_s_train(
    load: float | None, coupling: dict[str, float]
) -> None:
    drive = cs.Drive.reference_87().replace(
        load_inertia_kg_m2=load, eccentric_inertia_kg_m2=4e-4, **coupling
    )
    space = cs.Space.grid(drive, output_pin_count=[6, 8, 12], input_inertia_kg_m2=[0.001, 0.0035])
    table = cs.sweep(space)
    for row in table.iter_rows(named=True):
        names = ("output_pin_count", "input_inertia_kg_m2")
        train = drive.replace(**{name: row[name] for name in names}).train()
        found = [float(f) for f in train.modes().frequencies_hz if f > 0]
        assert row["natural_frequency_1_hz"] == pytest.approx(found[0], rel=1e-9)
        if coupling:
            assert row["natural_frequency_2_hz"] == pytest.approx(found[1], rel=1e-9)
        else:
            assert row["natural_frequency_2_hz"] is None
        torque = drive.nominal_torque_nm
        locked = drive.replace(
            output_pin_count=row["output_pin_count"], load_inertia_kg_m2=None,
            flange_inertia_kg_m2=None, coupling_stiffness_nm_per_rad=None,
        ).train()  # fmt: skip
        run = locked.transient({0: -torque}, 0.5, 2, preload_nm={0: torque})
        assert row["reversal_shock_factor"] == pytest.approx(run.shock_factor, rel=1e-9)


def test_component_columns_follow_stiffness_and_backlash() -> None:
    drive = cs.Drive.reference_87().replace(**PARTS, load_inertia_kg_m2=5.0)
    space = cs.Space.grid(drive, hole_clearance_mm=[0.02, 0.1])
    table = cs.sweep(space, model="components")
    for row in table.iter_rows(named=True):
        stiffness = row["tangent_stiffness_100pct_nm_per_arcmin"] * 10_800 / math.pi / 87**2
        orbit = 2 * row["disc_mass_kg"] * (drive.eccentricity_mm * 1e-3) ** 2
        inertia = (drive.input_inertia_kg_m2 or math.nan) + orbit
        expected = math.sqrt(stiffness * (1 / inertia + 87**2 / 5.0)) / math.tau
        assert row["natural_frequency_1_hz"] == pytest.approx(expected)
    factors = table["reversal_shock_factor"]
    assert factors[1] > factors[0] > 3


def test_columns_are_there_only_where_a_part_of_the_train_is() -> None:
    drive = cs.Drive.reference_87()
    assert not set(COLUMNS) & set(cs.sweep(cs.Space.grid(drive, output_pin_count=[8])).columns)
    space = cs.Space.grid(drive, load_inertia_kg_m2=[1.0, 5.0])
    plan = cs.scan(space).select("natural_frequency_1_hz")
    assert plan.collect()["natural_frequency_1_hz"].is_sorted(descending=True)


def test_a_filter_on_inputs_and_on_the_columns_gives_the_same_rows() -> None:
    space = cs.Space.grid(
        cs.Drive.reference_87(), load_inertia_kg_m2=[1.0, 5.0, 20.0], output_pin_count=[6, 8, 10]
    )
    whole = cs.sweep(space)
    some = (pl.col("output_pin_count") == 8) & (pl.col("natural_frequency_1_hz") > 30)
    lazy = cs.scan(space).filter(some).select("variant", *COLUMNS).collect()
    assert lazy.equals(whole.filter(some).select("variant", *COLUMNS))
    assert lazy.height == 2


def test_a_refused_variant_has_null() -> None:
    space = cs.Space.grid(
        cs.Drive.reference_87().replace(load_inertia_kg_m2=5.0), eccentricity_mm=[0.6, 0.9]
    )
    assert cs.sweep(space)["natural_frequency_1_hz"].is_null().to_list() == [False, True]


@pytest.mark.parametrize("model", ["published", "components"])
@pytest.mark.parametrize(
    ("name", "value", "status"),
    [
        ("load_inertia_kg_m2", 0.0, "non_positive_dimension"),
        ("load_inertia_kg_m2", -1.0, "non_positive_dimension"),
        ("load_inertia_kg_m2", math.inf, "non_finite_input"),
        ("load_inertia_kg_m2", math.nan, "ok"),
        ("flange_inertia_kg_m2", -1.0, "non_positive_dimension"),
        ("coupling_stiffness_nm_per_rad", 0.0, "non_positive_dimension"),
        ("eccentric_inertia_kg_m2", 0.0, "ok"),
        ("eccentric_inertia_kg_m2", -1e-4, "negative_dimension"),
    ],
)
def test_a_train_that_cannot_be_is_refused(
    model: Literal["published", "components"], name: str, value: float, status: str
) -> None:
    drive = cs.Drive.reference_87().replace(**PARTS, **COUPLING, load_inertia_kg_m2=5.0)
    space = cs.Space.grid(drive, **{name: [getattr(drive, name) or 1e-4, value]})
    study = cs.Study.of(space, model=model)
    table = cs.sweep(study)
    assert table["status"].to_list() == ["ok", status]
    assert table["natural_frequency_1_hz"].is_null().to_list() == [False, status != "ok"]
    reason = study.core.explain(1)
    assert reason is None if status == "ok" else reason is not None and name in reason
    # What is left out of a train is not there: without a load the output is locked.
    if math.isnan(value):
        locked = cs.sweep(cs.Space.grid(drive.replace(**{name: None}), ratio=[87]), model=model)
        column = "natural_frequency_1_hz"
        assert table[column][1] == pytest.approx(locked[column][0], rel=1e-12)


def test_a_limit_on_a_train_column() -> None:
    space = cs.Space.grid(cs.Drive.reference_87(), load_inertia_kg_m2=[1.0, 5.0])
    free = cs.sweep(space)["natural_frequency_1_hz"].to_list()
    between = 0.5 * sum(free)
    frame = cs.sweep(space, limits={"natural_frequency_1_hz": (between, None)})
    expected = ["ok" if value >= between else "limit_natural_frequency_1_hz" for value in free]
    assert frame["status"].to_list() == expected
    assert set(expected) == {"ok", "limit_natural_frequency_1_hz"}
    assert frame["twist_1tn_deg"].is_null().to_list() == [value != "ok" for value in expected]


def test_a_study_writes_stiffness_frequency_and_shock_factor(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(
        'drive = "reference-87"\n'
        "[axes]\nload_inertia_kg_m2 = { values = [1.0, 5.0] }\n"
        "output_pin_count = { values = [6, 8] }\n"
    )
    study = cs.Study.from_toml(tmp_path / "study.toml")
    cs.sink(study, tmp_path / "out")
    found = cs.scan_dataset(tmp_path / "out").collect().sort("variant")
    assert found.select(COLUMNS).equals(cs.sweep(study).select(COLUMNS))
    other = cs.Space.grid(
        cs.Drive.reference_87().replace(eccentric_inertia_kg_m2=1e-4),
        load_inertia_kg_m2=[1.0, 5.0], output_pin_count=[6, 8],
    )  # fmt: skip
    assert cs.Study.of(other).hash != study.hash


@pytest.mark.parametrize("grounded", [False, True])
def test_many_chains_have_the_frequencies_of_each(grounded: bool) -> None:
    rng = np.random.default_rng(5)
    inertias = 10 ** rng.uniform(-4, -1, (50, 5))
    stiffnesses = 10 ** rng.uniform(1, 4, (50, 5 if grounded else 4))
    found = natural_frequencies_hz(inertias, stiffnesses)
    for row in range(50):
        train = cs.Train(inertias[row].tolist(), stiffnesses[row].tolist(), None, grounded)
        np.testing.assert_allclose(found[row], train.modes().frequencies_hz, rtol=1e-9, atol=1e-12)
    stiffnesses[3, 1] = -1.0
    assert np.isnan(natural_frequencies_hz(inertias, stiffnesses)[3]).all()
    with pytest.raises(cs.InputError, match="as many springs as inertias or one fewer"):
        natural_frequencies_hz(inertias, stiffnesses[:, :2])
