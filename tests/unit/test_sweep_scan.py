"""The lazy source: same rows as a sweep whatever the query, and no more work than it needs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import cyclosweep as cs
from cyclosweep.sweep.kernel_columns import result_columns
from cyclosweep.sweep.rows import frame

SPACE = cs.Space.grid(
    cs.Drive.reference_87(),
    eccentricity_mm=cs.linspace(0.3, 0.9, 31),
    output_pin_count=[6, 8, 9, 10, 12],
    output_pin_diameter_mm=cs.linspace(10, 30, 17),
    criterion=["published-map", "inside", "statics"],
)
STUDY = cs.Study.of(SPACE, limits={"hole_web_mm": (2.0, None)})
WHOLE = cs.sweep(STUDY)

col = pl.col
# Conditions, and whether inputs of the same row alone decide them.
CONDITIONS: dict[str, tuple[pl.Expr, bool]] = {
    "one input": (col("output_pin_count") > 8, True),
    "variant": (col("variant").is_between(1000, 1999), True),
    "or of inputs": ((col("output_pin_count") == 6) | (col("eccentricity_mm") < 0.4), True),
    "not": (~(col("output_pin_count") == 6), True),
    "is_in": (col("output_pin_count").is_in([6, 9]), True),
    "between": (col("eccentricity_mm").is_between(0.5, 0.6), True),
    "criterion": (col("criterion") == "statics", True),
    "criterion in": (col("criterion").is_in(["statics", "inside"]), True),
    "arithmetic": (col("eccentricity_mm") * 20 > col("output_pin_diameter_mm"), True),
    "and of three": (
        (col("output_pin_count") > 6)
        & (col("eccentricity_mm") < 0.7)
        & (col("output_pin_diameter_mm") > 12),
        True,
    ),
    "nothing": (pl.lit(False), True),
    "everything": (pl.lit(True), True),
    "no row": (col("output_pin_count") > 100, True),
    "status": (col("status") == "ok", False),
    "status in": (col("status").is_in(["holes_overlap", "limit_hole_web_mm"]), False),
    "not status": (col("status") != "ok", False),
    "result": (col("twist_1tn_deg") < 48, False),
    "null result": (col("twist_1tn_deg").is_null(), False),
    "not of a null": (~(col("twist_1tn_deg") < 48), False),
    "filled null": (col("hole_web_mm").fill_null(0.0) < 3, False),
    "or with a null": ((col("hole_web_mm") > 5) | (col("output_pin_count") == 6), False),
    "two results": (col("hole_web_mm") > col("hole_diameter_mm") / 5, False),
    "flag": (col("statics_applicable"), False),
    "mixed": ((col("output_pin_count") > 8) & (col("active_pins_min") > 8), False),
    "maximum": (col("hole_web_mm") == col("hole_web_mm").max(), False),
    "maximum of an input": (col("eccentricity_mm") == col("eccentricity_mm").max(), False),
    "shifted": (col("eccentricity_mm").shift(1) != col("eccentricity_mm"), False),
    "over": (col("hole_web_mm").max().over("output_pin_count") == col("hole_web_mm"), False),
    "rank": (col("eccentricity_mm").rank("ordinal") < 100, False),
}


@pytest.mark.parametrize("engine", ["in-memory", "streaming"])
@pytest.mark.parametrize("name", CONDITIONS)
def test_a_condition_keeps_the_rows_it_keeps_after_a_sweep(
    name: str, engine: pl._typing.EngineType
) -> None:
    condition, _ = CONDITIONS[name]
    expected = WHOLE.filter(condition)
    assert_frame_equal(
        cs.scan(STUDY).filter(condition).collect(engine=engine),
        expected,
        check_exact=True,
        check_row_order=engine == "in-memory",
    )
    few = ["twist_2tn_deg", "variant"]
    found = cs.scan(STUDY).filter(condition).select(few).collect()
    assert_frame_equal(found, expected.select(few), check_exact=True)


def rows_evaluated(query: Callable[[pl.LazyFrame], pl.LazyFrame]) -> tuple[pl.DataFrame, int]:
    study = cs.Study.of(SPACE)
    frame = query(cs.scan(study)).collect()
    return frame, study.core.evaluated


@pytest.mark.parametrize("name", [name for name, (_, early) in CONDITIONS.items() if early])
def test_conditions_on_inputs_run_before_the_kernel(name: str) -> None:
    condition, _ = CONDITIONS[name]
    frame, evaluated = rows_evaluated(
        lambda lazy: lazy.filter(condition).select("twist_1tn_deg", "hole_web_mm")
    )
    assert evaluated == frame.height == WHOLE.filter(condition).height


def test_only_the_part_on_inputs_runs_before_the_kernel() -> None:
    early, late = col("output_pin_count") == 9, col("twist_1tn_deg") < 48
    frame, evaluated = rows_evaluated(lambda lazy: lazy.filter(late & early).select("variant"))
    assert evaluated == WHOLE.filter(early).height
    expected = cs.sweep(SPACE).filter(early, late)
    assert 0 < frame.height < evaluated
    assert frame["variant"].to_list() == expected["variant"].to_list()
    _, chained = rows_evaluated(lambda lazy: lazy.filter(late).filter(early))
    assert chained == evaluated


def test_a_query_on_inputs_alone_never_starts_the_kernel() -> None:
    frame, evaluated = rows_evaluated(
        lambda lazy: lazy.filter(col("eccentricity_mm") > 0.5).select("output_pin_count")
    )
    assert evaluated == 0
    expected = WHOLE.filter(col("eccentricity_mm") > 0.5).select("output_pin_count")
    assert_frame_equal(frame, expected)


def test_only_results_asked_for_are_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def watched(study: cs.Study, names: list[str], *rest: Any) -> list[pl.Series]:
        asked.extend(names)
        return result_columns(study, names, *rest)

    monkeypatch.setitem(frame.__globals__, "result_columns", watched)
    lazy = cs.scan(SPACE).filter(col("status") == "ok", col("eccentricity_mm") > 0.8)
    lazy.select("hole_web_mm", "output_pin_count").collect()
    assert set(asked) == {"status", "hole_web_mm"}


@pytest.mark.parametrize(
    "columns",
    [
        ["twist_1tn_deg"],
        ["status"],
        ["hole_web_mm", "twist_4p5tn_deg"],
        ["variant"],
        ["criterion"],
        ["statics_applicable", "active_pins_max"],
        ["twist_1tn_deg", "eccentricity_mm", "status", "variant"],
    ],
)
def test_any_choice_of_columns_in_any_order(columns: list[str]) -> None:
    found = cs.scan(STUDY).select(columns).collect()
    assert_frame_equal(found, WHOLE.select(columns), check_exact=True)


@pytest.mark.parametrize("name", list(WHOLE.columns))
def test_every_single_column_is_the_same_alone(name: str) -> None:
    """What other columns are computed beside it must not change a column."""
    assert_frame_equal(cs.scan(STUDY).select(name).collect(), WHOLE.select(name), check_exact=True)


def test_rows_are_counted() -> None:
    assert cs.scan(STUDY).select(pl.len()).collect().item() == len(SPACE)
    ok = cs.scan(STUDY).filter(col("status") == "ok").select(pl.len()).collect().item()
    assert ok == (WHOLE["status"] == "ok").sum()


@pytest.mark.parametrize("rows", [0, 1, 7, 7905, 100_000])
def test_head_computes_no_more_than_it_shows(rows: int) -> None:
    frame, evaluated = rows_evaluated(lambda lazy: lazy.head(rows))
    assert_frame_equal(frame, cs.sweep(SPACE).head(rows), check_exact=True)
    assert evaluated == min(rows, len(SPACE))


@pytest.mark.parametrize("engine", ["in-memory", "streaming"])
def test_head_and_condition_keep_their_order(engine: pl._typing.EngineType) -> None:
    lazy = cs.scan(STUDY)
    condition = (col("output_pin_count") > 8) & (col("status") == "ok")
    queries: tuple[Callable[[pl.LazyFrame], pl.LazyFrame], ...] = (
        lambda frame: frame.head(500).filter(condition),
        lambda frame: frame.filter(condition).head(20),
        lambda frame: frame.slice(1000, 300).filter(condition),
        lambda frame: frame.filter(condition).tail(5),
        lambda frame: frame.sort("twist_1tn_deg", nulls_last=True).head(10),
        lambda frame: frame.group_by("status", maintain_order=True).len(),
    )
    for query in queries:
        found = query(lazy).collect(engine=engine)
        assert_frame_equal(found, query(WHOLE.lazy()).collect(), check_exact=True)


@pytest.mark.parametrize("batch", [1, 3, 4096, 7905])
def test_any_batch_size_gives_the_same_frame(batch: int, monkeypatch: pytest.MonkeyPatch) -> None:
    space = SPACE[500:1100] if batch < 10 else SPACE
    monkeypatch.setitem(cs.scan.__globals__, "DEFAULT_BATCH", batch)
    assert_frame_equal(cs.scan(space).collect(), cs.sweep(space), check_exact=True)


def test_streaming_to_a_file(tmp_path: object) -> None:
    path = f"{tmp_path}/out.parquet"
    cs.scan(STUDY).filter(col("status") == "ok").sink_parquet(path)
    assert_frame_equal(pl.read_parquet(path), WHOLE.filter(col("status") == "ok"))


def test_scanned_schema_is_the_swept_one() -> None:
    assert cs.scan(STUDY).collect_schema() == WHOLE.schema
    for name in ("active_pins_min", "output_pin_count"):
        assert WHOLE.schema[name] == pl.UInt32
    assert WHOLE.schema["variant"] == pl.UInt64
    assert WHOLE.schema["statics_applicable"] == pl.Boolean
    assert isinstance(WHOLE.schema["status"], pl.Enum)


def test_a_table_without_rows_is_an_empty_frame() -> None:
    empty = pl.DataFrame(schema={"eccentricity_mm": pl.Float64})
    space = cs.Space.table(cs.Drive.reference_87(), empty)
    assert cs.scan(space).collect().shape == cs.sweep(space).shape == (0, 34)


def test_more_rows_than_a_frame_holds_are_refused_rather_than_attempted() -> None:
    space = cs.Space.sobol(cs.Drive.reference_87(), 2**60, eccentricity_mm=(0.3, 0.8))
    with pytest.raises(cs.InputError, match="do not fit into one frame"):
        cs.sweep(space)
