"""The Pareto front and the nearest variants: brute force, ties, limits, expressions, bad input."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cyclosweep as cs
from cyclosweep.explore import dominance, tables


def brute_force(points: np.ndarray) -> list[int]:
    """Rows that no other row dominates, one by one; less is better."""
    return [
        k
        for k, point in enumerate(points)
        if not any(np.all(other <= point) and np.any(other < point) for other in points)
    ]


numbers = st.one_of(
    st.integers(-3, 3).map(float), st.floats(-1e9, 1e9), st.just(float("inf")), st.none(),
    st.just(float("nan")),
)  # fmt: skip


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_the_front_is_that_of_brute_force(data: st.DataObject) -> None:
    count = data.draw(st.integers(1, 5))
    rows = data.draw(st.lists(st.tuples(*[numbers] * count), max_size=60))
    senses = data.draw(st.lists(st.sampled_from(["min", "max"]), min_size=count, max_size=count))
    names = [f"x{k}" for k in range(count)]
    columns = [pl.Series(name, [row[k] for row in rows], pl.Float64)
               for k, name in enumerate(names)]  # fmt: skip
    table = pl.DataFrame(columns).with_row_index("row")
    whole = [k for k, row in enumerate(rows) if all(v is not None and v == v for v in row)]
    signs = np.array([1.0 if sense == "min" else -1.0 for sense in senses])
    points = np.array([rows[k] for k in whole], float).reshape(len(whole), count) * signs
    expected = {whole[k] for k in brute_force(points)}
    with pytest.MonkeyPatch.context() as patch:
        # Small batches and blocks, so that a front is put together from many pieces.
        patch.setattr(tables, "_BATCH_ROWS", 7)
        patch.setattr(dominance, "_LEAST_WAITING", data.draw(st.sampled_from([1, 10, 1000])))
        patch.setattr(dominance, "_BLOCK", data.draw(st.sampled_from([1, 50])))
        front = cs.pareto_front(table, dict(zip(names, senses, strict=True)))
    assert sorted(front["row"]) == sorted(expected)
    assert front["x0"].is_sorted(descending=senses[0] == "max")


@pytest.mark.parametrize("objectives", [1, 2, 3, 4])
def test_a_front_of_many_batches_is_that_of_all_rows_at_once(objectives: int) -> None:
    generator = np.random.default_rng(objectives)
    points = np.round(generator.random((30_000, objectives)), 3)
    front = dominance.Front(objectives)
    for first in range(0, len(points), 1000):
        rows = np.arange(first, first + 1000, dtype=np.uint64)
        front.add(points[first : first + 1000], rows)
    found, rows = front.result()
    assert np.array_equal(rows, np.flatnonzero(dominance.non_dominated(points)))
    assert np.array_equal(found, points[rows])


@pytest.fixture(scope="module")
def space() -> cs.Space:
    return cs.Space.grid(
        cs.Drive.reference_87(),
        eccentricity_mm=cs.linspace(0.3, 0.9, 7),
        output_pin_diameter_mm=cs.linspace(10, 22, 9),
        output_pin_count=[6, 8, 10],
    )


def test_space_frame_folder_and_file_give_the_same_front(space: cs.Space, tmp_path: Path) -> None:
    table = cs.sweep(space)
    cs.sink(space, tmp_path / "Maße 1")
    table.write_parquet(tmp_path / "table.parquet")
    wanted = {"twist_1tn_deg": "min", "output_pin_diameter_mm * output_pin_count": "min"}
    limits = {"hole_web_mm": (3.0, None), "2 * eccentricity_mm": (None, 1.5)}
    fronts = [
        cs.pareto_front(source, wanted, limits)
        for source in (
            space,
            table,
            cs.scan(space),
            tmp_path / "Maße 1",
            str(tmp_path / "table.parquet"),
        )
    ]
    assert all(front.equals(fronts[0]) for front in fronts)
    inside = table.filter(
        pl.col("status") == "ok", pl.col("hole_web_mm") >= 3, pl.col("eccentricity_mm") <= 0.75
    ).with_columns(size=pl.col("output_pin_diameter_mm") * pl.col("output_pin_count"))
    expected = brute_force(inside.select("twist_1tn_deg", "size").to_numpy())
    assert sorted(fronts[0]["variant"]) == sorted(inside["variant"][expected])
    assert fronts[0].columns == [*table.columns, "output_pin_diameter_mm * output_pin_count"]


def test_rows_of_the_same_variant_number_are_told_apart() -> None:
    rows = {"variant": [0, 0, 0, 1], "x": [1.0, 2.0, 1.0, 3.0]}
    table = pl.DataFrame(rows, schema_overrides={"variant": pl.UInt64})
    assert cs.pareto_front(table, "x")["x"].to_list() == [1.0, 1.0]


def test_what_is_infeasible_counts_only_where_it_is_asked_for(space: cs.Space) -> None:
    wanted = ["max eccentricity_mm"]
    assert cs.pareto_front(space, wanted)["status"].unique().to_list() == ["ok"]
    everything = cs.pareto_front(space, wanted, only_ok=False)
    assert everything["eccentricity_mm"].unique().to_list() == [0.9]
    assert cs.pareto_front(space, wanted, "eccentricity_mm > 5").is_empty()


@pytest.mark.parametrize(
    ("objectives", "limits", "message"),
    [
        ({"twist_1tn_dgg": "min"}, None, "objective: no column twist_1tn_dgg, did you mean twist"),
        ({"twist_1tn_deg": "smallest"}, None, "found 'smallest', expected min or max"),
        ({}, None, "objectives: none, expected at least one column"),
        (["twist_1tn_deg", "max twist_1tn_deg"], None, "twist_1tn_deg twice"),
        ("status", None, "no number"),
        ("twist_1tn_deg", {"hole_web_mm": (3, 2)}, "limits.hole_web_mm: found 3 to 2"),
        ("twist_1tn_deg", {"hole_web_mm": 3}, "limits.hole_web_mm: found 3, expected"),
        ("twist_1tn_deg", ["hole_web_mm"], "expected a comparison"),
    ],
)
def test_bad_input_is_one_line(
    space: cs.Space, objectives: object, limits: object, message: str
) -> None:
    with pytest.raises(cs.InputError, match=message) as caught:
        cs.pareto_front(space, objectives, limits)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_the_nearest_variants_are_those_of_a_sort(space: cs.Space) -> None:
    table = cs.sweep(space)
    target = {"twist_1tn_deg": 90.0, "output_pin_diameter_mm": 15.0}
    near = cs.nearest_variants(space, target, count=5, limits={"hole_web_mm": (4.0, None)})
    inside = table.filter(pl.col("status") == "ok", pl.col("hole_web_mm") >= 4)
    squares = [((pl.col(name) - value) / pl.col(name).std()) ** 2 for name, value in target.items()]
    distance = ((squares[0] + squares[1]) / 2).sqrt()
    expected = inside.with_columns(distance=distance).sort("distance", maintain_order=True).head(5)
    assert near["variant"].to_list() == expected["variant"].to_list()
    assert np.allclose(near["distance"], expected["distance"], rtol=1e-12)
    one = cs.nearest_variants(space, target, count=1, scales={"twist_1tn_deg": 1e-9})
    assert one["twist_1tn_deg"].item() == min(
        table.filter(pl.col("status") == "ok")["twist_1tn_deg"], key=lambda v: abs(v - 90)
    )


@pytest.mark.parametrize(
    ("target", "scales", "message"),
    [
        ({}, None, "target: none"),
        ({"eccentricity_mm": float("nan")}, None, "expected a finite number"),
        ({"eccentricity_mm": "0.5"}, None, "expected a finite number"),
        ({"eccentricity": 0.5}, None, "no column eccentricity, did you mean eccentricity_mm"),
        ({"eccentricity_mm": 0.5}, {"eccentricity_mm": 0.0}, "expected more than 0"),
        ({"eccentricity_mm": 0.5}, {"hole_web_mm": 1.0}, "not in the target"),
    ],
)
def test_a_wish_that_makes_no_sense_is_one_line(
    space: cs.Space, target: dict[str, float], scales: dict[str, float] | None, message: str
) -> None:
    with pytest.raises(cs.InputError, match=message):
        cs.nearest_variants(space, target, scales=scales)


def test_a_table_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    for table, message in (
        (tmp_path, "no parts of a study"),
        (tmp_path / "none.csv", "none.csv"),
        (3, "expected a frame"),
    ):
        with pytest.raises(cs.InputError, match=message):
            cs.pareto_front(table, "x")  # type: ignore[arg-type]
