"""Derived inputs, constraints, own columns and several objectives of a study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import cyclosweep as cs

DRIVE = cs.Drive.reference_87()
AXES: dict[str, Any] = {"eccentricity_mm": [0.4, 0.6, 0.9], "output_pin_count": [6, 8, 9]}
GRID = cs.Space.grid(DRIVE, **AXES)
RIM = {"rim_mm": "12 + eccentricity_mm", "disc_outer_radius_mm": "75 - rim_mm"}
STIFFNESS = "output_stiffness_nm_per_arcmin"


def test_a_derived_input_is_the_input_of_each_variant() -> None:
    """Every result is that of a table in which the derived values stand as numbers."""
    space = GRID.derive(**RIM)
    frame = cs.sweep(space)
    assert frame.columns[:6] == ["variant", *AXES, *RIM, "status"]
    assert frame["disc_outer_radius_mm"].to_list() == [
        75 - (12 + e) for e in AXES["eccentricity_mm"] for _ in range(3)
    ]
    table = frame.select(*AXES, "disc_outer_radius_mm")
    expected = cs.sweep(cs.Space.table(DRIVE, table))
    assert_frame_equal(frame.drop("rim_mm"), expected, check_exact=True)
    assert frame["hole_web_mm"][0] < cs.sweep(GRID)["hole_web_mm"][0] - 1
    for k in (0, 4, 8):
        assert space[k].disc_outer_radius_mm == frame["disc_outer_radius_mm"][k]
    assert_frame_equal(cs.scan(space).collect(), frame, check_exact=True)
    assert_frame_equal(cs.sweep(space[3:7]), frame[3:7], check_exact=True)


def test_derived_counts_and_components() -> None:
    drive = DRIVE.replace(ring_pin_radius_mm=3.0, disc_width_mm=12.0)
    space = cs.Space.grid(drive, eccentricity_mm=[0.5, 0.6]).derive(
        output_pin_count="round(10 * eccentricity_mm) + 1", disc_width_mm="20 * eccentricity_mm"
    )
    frame = cs.sweep(space, model="components")
    table = frame.select("eccentricity_mm", "output_pin_count", "disc_width_mm")
    expected = cs.sweep(cs.Space.table(drive, table), model="components")
    assert table["output_pin_count"].to_list() == [6.0, 7.0]
    count = pl.col("output_pin_count").cast(pl.Float64)
    assert_frame_equal(frame, expected.with_columns(count), check_exact=True)
    assert space[1].output_pin_count == 7


def test_a_derived_value_that_is_none_is_a_status() -> None:
    space = cs.Space.grid(DRIVE, eccentricity_mm=[0.5, 0.6, 0.7]).derive(
        disc_bore_radius_mm="case when eccentricity_mm > 0.55 then 25 end",
        output_pin_count="case when eccentricity_mm = 0.6 then 8.5 else 8 end",
    )
    expected = ["non_finite_input", "pin_count_out_of_range", "ok"]
    assert cs.sweep(space)["status"].to_list() == expected


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"disc_outer_radius_mm": "75 - eccentricty_mm"}, "did you mean eccentricity_mm?"),
        ({"eccentricity_mm": "0.6"}, "is an axis too"),
        ({"hole_web_mm": "1"}, "is a result"),
        ({"twist_1tn_deg": "1"}, "is a column of every study"),
        ({"a_mm": "b_mm", "b_mm": "a_mm + 1"}, "follow from each other"),
        ({"disc_outer_radius_mm": "70 - ring_pin_radius_mm"}, "has no ring_pin_radius_mm"),
        ({"disc_outer_radius_mm": "hole_web_mm"}, "no column hole_web_mm"),
        ({"criterion": "inside"}, "derived.criterion"),
        ({"bush_wall_mm": "true"}, "bush_wall_mm: found 'true', which is no number"),
        ({"bush_wall_mm": "eccentricity_mm > 0.4"}, "which is no number, expected one"),
        ({"disc_outer_radius_mm": "criterion"}, "is no number"),
    ],
)
def test_a_derived_input_that_makes_no_sense(given: dict[str, str], words: str) -> None:
    with pytest.raises(cs.InputError) as caught:
        GRID.derive(**given)
    assert words in str(caught.value)
    assert str(caught.value).startswith("derived")
    assert "\n" not in str(caught.value)


def test_constraints_and_limits_on_expressions_keep_the_row_and_name_themselves() -> None:
    plain = cs.sweep(GRID)
    frame = cs.sweep(
        GRID,
        constraints={
            "few_pins": "output_pin_count < 9",
            "stiff": pl.col(STIFFNESS) > 37,
            "own": lambda rows: rows["hole_web_mm"] + rows["eccentricity_mm"] < 10,
        },
        limits={"hole_web_mm - eccentricity_mm": (8.0, None)},
    )
    expected = []
    for row in plain.iter_rows(named=True):
        if row["output_pin_count"] >= 9:
            expected.append("constraint_few_pins")
        elif row["status"] != "ok":
            expected.append(row["status"])
        elif row["hole_web_mm"] - row["eccentricity_mm"] < 8:
            expected.append("limit_hole_web_mm - eccentricity_mm")
        elif row[STIFFNESS] <= 37:
            expected.append("constraint_stiff")
        elif row["hole_web_mm"] + row["eccentricity_mm"] >= 10:
            expected.append("constraint_own")
        else:
            expected.append("ok")
    assert frame["status"].to_list() == expected
    assert len(set(expected)) >= 4
    kept = frame["status"] == "ok"
    results = [name for name in plain.columns if name not in ("variant", *AXES, "status")]
    assert_frame_equal(
        frame.filter(kept).drop("status"), plain.filter(kept).drop("status"), check_exact=True
    )
    assert frame.filter(~kept).select(results).null_count().row(0) == ((~kept).sum(),) * len(
        results
    )


def test_constraints_on_inputs_alone_are_applied_before_the_models() -> None:
    before = cs.kernel_evaluations().variants
    cs.sweep(GRID, constraints={"few_pins": "output_pin_count < 7"})
    assert cs.kernel_evaluations().variants - before == 3


def own(batch: pl.DataFrame) -> Any:
    return np.sqrt(batch["hole_web_mm"].to_numpy())


COLUMNS: dict[str, Any] = {
    "cost": "output_pin_count * (1.5 + output_pin_diameter_mm)",
    "stiffness_per_cost": pl.col(STIFFNESS) / pl.col("cost"),
    "root": cs.Column(own, needs=["hole_web_mm"], unit="mm^0.5", meaning="root of the web"),
    "is_soft": "output_stiffness_nm_per_arcmin < 38",
}


def test_own_columns_behave_like_results(tmp_path: Path) -> None:
    study = cs.Study.of(
        GRID,
        columns=COLUMNS,
        limits={"cost": (None, 140.5)},
        objective=cs.Objective("stiffness_per_cost", maximise=True),
    )
    frame = cs.sweep(study)
    plain = cs.sweep(GRID)
    cost = plain["output_pin_count"].cast(pl.Float64) * (1.5 + DRIVE.output_pin_diameter_mm)
    ok = (plain["status"] == "ok") & (cost <= 140.5)
    assert frame["cost"].to_list() == [c if o else None for c, o in zip(cost, ok, strict=True)]
    assert set(frame["status"]) == {"ok", "limit_cost", "eccentricity_too_large_for_ring"}
    kept = frame.filter(pl.col("status") == "ok")
    assert kept["root"].to_list() == np.sqrt(kept["hole_web_mm"].to_numpy()).tolist()
    assert kept["is_soft"].to_list() == (kept[STIFFNESS] < 38).to_list()
    assert kept["stiffness_per_cost"].to_list() == (kept[STIFFNESS] / kept["cost"]).to_list()

    summary = cs.sink(study, tmp_path / "study", rows_per_part=4)
    best = kept.sort("stiffness_per_cost", descending=True)
    assert summary.best[0]["variant"] == best["variant"][0]
    assert summary.ranges["root"] == (kept["root"].min(), kept["root"].max())
    assert_frame_equal(cs.scan_dataset(tmp_path / "study").collect(), frame, check_exact=True)
    assert study.units()["root"]["unit"] == "mm^0.5"
    lazy = cs.scan(study).filter(pl.col("cost") < 130).select("root")
    assert_frame_equal(lazy.collect(), frame.filter(pl.col("cost") < 130).select("root"))


def test_a_lazy_query_computes_only_what_own_columns_need() -> None:
    before = cs.kernel_evaluations()
    cs.scan(GRID, columns=COLUMNS).filter(pl.col("output_pin_count") < 7).select("root").collect()
    after = cs.kernel_evaluations()
    assert (after.variants - before.variants, after.values - before.values) == (3, 3)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"cost": "output_pin_cont * 2"}, "columns.cost: no column output_pin_cont, did you mean"),
        ({"cost": pl.col("output_pin_cont")}, "columns.cost: no column output_pin_cont"),
        ({"cost": pl.col("hole_web_mm") - pl.col("hole_web_mm").mean()}, "from its own row"),
        ({"cost": pl.col("hole_web_mm").cum_sum()}, "from its own row"),
        ({"cost": pl.col("hole_web_mm").max()}, "from its own row"),
        ({"cost": pl.lit("a")}, "expected a number"),
        ({"cost": 3}, "expected an expression"),
        ({"hole_web_mm": "1"}, "is a column of every study"),
        ({"eccentricity_mm": "1"}, "columns.eccentricity_mm"),
        ({"my cost": "1"}, "letters, digits"),
    ],
)
def test_own_columns_that_make_no_sense(columns: Any, words: str) -> None:
    with pytest.raises(cs.InputError) as caught:
        cs.Study.of(GRID, columns=columns)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_function_that_fails_is_one_line() -> None:
    for function, words in (
        (lambda rows: [1.0], "found 1 values of 9 rows"),
        (lambda rows: rows["nothing"], "cost: ColumnNotFoundError"),
        (lambda rows: 1 / 0, "cost: ZeroDivisionError"),
    ):
        with pytest.raises(cs.InputError) as caught:
            cs.sweep(GRID, columns={"cost": function})
        assert words in str(caught.value)
        assert "\n" not in str(caught.value)


def test_several_objectives_and_what_is_to_be_said_of_them(tmp_path: Path) -> None:
    study = cs.Study.of(
        cs.Space.grid(DRIVE, output_pin_count=[6, 8, 9], bush_wall_mm=[1.0, 1.5, 2.0]),
        objective=[
            cs.Objective(STIFFNESS, maximise=True),
            cs.Objective("output_pin_count - 0.1 * bush_wall_mm"),
            cs.Objective("nominal_torque_nm"),
        ],
    )
    summary = cs.sink(study, tmp_path, rows_per_part=2)
    frame = cs.sweep(study).filter(pl.col("status") == "ok")
    assert summary.objective == f"maximise {STIFFNESS}"
    words = "minimise output_pin_count - 0.1 * bush_wall_mm"
    value = pl.col("output_pin_count").cast(pl.Float64) - 0.1 * pl.col("bush_wall_mm")
    order = frame.with_columns(value.alias("value")).sort("value", "variant")
    best = summary.to_json()["objectives"][words]["best"]
    assert [row["variant"] for row in best] == order["variant"].to_list()
    # The bush's wall does not enter the published stiffness: three variants are equally stiff.
    tie, unmoved = summary.remarks
    assert "3 variants are equally good" in tie
    assert tie.endswith("those listed differ in bush_wall_mm")
    assert "nominal_torque_nm: the same in all 9 variants" in unmoved
    assert cs.sink(study, tmp_path, rows_per_part=2) == summary


def test_draws_that_repeat_each_other_are_said_to_have_the_same_inputs(tmp_path: Path) -> None:
    study = cs.Study.of(
        cs.Space.sobol(DRIVE, 64, criterion=["inside", "statics"], output_pin_count=[6, 8]),
        objective=cs.Objective("torque_transfer_efficiency"),
    )
    [remark] = cs.sink(study, tmp_path).remarks
    assert remark.endswith("one of several; those listed have the same inputs")


def test_only_some_columns_of_the_variants_that_can_be_built(tmp_path: Path) -> None:
    study = cs.Study.of(
        GRID,
        keep=["hole_web_mm"],
        only_ok=True,
        objective=cs.Objective(STIFFNESS),
    )
    names = ["variant", *AXES, "status", "hole_web_mm"]
    expected = cs.sweep(GRID).filter(pl.col("status") == "ok").select(names)
    summary = cs.sink(study, tmp_path, rows_per_part=4)
    assert_frame_equal(cs.sweep(study), expected, check_exact=True)
    assert_frame_equal(cs.scan(study).collect(), expected, check_exact=True)
    assert_frame_equal(cs.scan_dataset(tmp_path).collect(), expected, check_exact=True)
    assert summary.rows == 9
    assert summary.status == {"ok": 6, "eccentricity_too_large_for_ring": 3}
    best = cs.sweep(GRID).filter(pl.col("status") == "ok").sort(STIFFNESS, "variant")
    assert [row["variant"] for row in summary.best] == best["variant"].to_list()
    assert cs.sink(study, tmp_path, rows_per_part=4) == summary


FILE = """
columns = { keep = ["cost"], cost = { expression = "2 * rim_mm" } }
only_ok = true
[axes]
eccentricity_mm = { from = 0.4, to = 0.6, steps = 3 }
output_pin_count = { values = [6, 8] }
[derived]
disc_outer_radius_mm = "ring_pin_circle_radius_mm - rim_mm"
rim_mm = "12 + eccentricity_mm"
[constraints]
few_pins = "output_pin_count < 7"
[limits]
"2 * hole_web_mm" = { min = 1 }
[[objective]]
maximise = "output_stiffness_nm_per_arcmin"
[[objective]]
minimise = "cost"
"""


def test_a_study_file_with_all_of_it(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(FILE)
    study = cs.Study.from_toml(tmp_path / "study.toml")
    space = cs.Space.grid(
        DRIVE, eccentricity_mm=cs.linspace(0.4, 0.6, 3), output_pin_count=[6, 8]
    ).derive(rim_mm=RIM["rim_mm"], disc_outer_radius_mm="ring_pin_circle_radius_mm - rim_mm")
    same = cs.Study.of(
        space,
        columns={"cost": "2 * rim_mm"},
        constraints={"few_pins": "output_pin_count < 7"},
        limits={"2 * hole_web_mm": (1, None)},
        keep=["cost"],
        only_ok=True,
        objective=[cs.Objective(STIFFNESS, maximise=True), cs.Objective("cost")],
    )
    assert study.hash == same.hash
    assert study.objectives == same.objectives
    frame = cs.sweep(study)
    assert frame.columns == ["variant", *AXES, *RIM, "status", "cost"]
    assert frame["cost"].to_list() == [2 * (12 + e) for e in frame["eccentricity_mm"]]
    assert set(frame["status"]) == {"ok"}


AXIS = "[axes]\neccentricity_mm = { from = 0.3, to = 0.8, steps = 3 }\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (AXIS + "[derived]\nbush_wall_mm = 'a'", "derived.bush_wall_mm: no column a"),
        (AXIS + "[derived]\nbush_wall_mm = [1]", "derived.bush_wall_mm"),
        (AXIS + "[constraints]\nthin = 'hole_web_mm'", "constraints.thin: found 'hole_web_mm'"),
        (AXIS + "[limits]\n'hole_web_m * 2' = { min = 1 }", "limits.hole_web_m * 2: no column"),
        (
            AXIS + "[columns.cost]\nexpression = '1'\nunits = 'mm'",
            "columns.cost.units: unknown key",
        ),
        (AXIS + "[columns.cost]\nexpression = 'a'", "columns.cost: no column a"),
        ("columns = ['cost']\n" + AXIS, "columns: no column cost"),
        ("only_ok = 3\n" + AXIS, "only_ok: found 3"),
        (AXIS + "[[objective]]\nminimise = 'a * 2'", "objective: no column a"),
        (AXIS + "[[objective]]\nleast = 'a'", "objective.least: unknown key"),
    ],
)
def test_one_clear_line_for_what_is_wrong(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text)
    with pytest.raises(cs.InputError) as caught:
        cs.Study.from_toml(path)
    assert str(caught.value).startswith(f"{path}: {words}")
    assert "\n" not in str(caught.value)


def test_another_definition_is_another_study() -> None:
    """What decides the numbers or the columns decides the hash; what does not does not."""
    plain = cs.Study.of(GRID)
    studies = [
        plain,
        cs.Study.of(GRID.derive(bush_wall_mm="eccentricity_mm")),
        cs.Study.of(GRID.derive(bush_wall_mm="2 * eccentricity_mm")),
        cs.Study.of(GRID, columns={"a": "eccentricity_mm"}),
        cs.Study.of(GRID, columns={"a": "2 * eccentricity_mm"}),
        cs.Study.of(GRID, columns={"a": lambda rows: rows["eccentricity_mm"]}),
        cs.Study.of(GRID, columns={"a": lambda rows: rows["eccentricity_mm"] * 2}),
        cs.Study.of(GRID, columns={"a": pl.col("eccentricity_mm")}),
        cs.Study.of(GRID, columns={"a": pl.col("output_pin_count")}),
        cs.Study.of(GRID, constraints={"a": "eccentricity_mm < 1"}),
        cs.Study.of(GRID, limits={"2 * eccentricity_mm": (1, 2)}),
        cs.Study.of(GRID, keep=["hole_web_mm"]),
        cs.Study.of(GRID, only_ok=True),
    ]
    assert len({study.hash for study in studies}) == len(studies)
    assert cs.Study.of(GRID, objective=cs.Objective("hole_web_mm")).hash == plain.hash
    assert cs.Study.of(GRID, columns={"a": own}).hash == cs.Study.of(GRID, columns={"a": own}).hash
