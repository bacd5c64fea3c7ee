"""Percentiles over tolerances against a brute-force Monte Carlo, and the robust choice."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.sweep.tolerances import deviations

TOLERANCES = cs.Tolerances(
    {
        "eccentricity_mm": cs.normal(sd=0.004),
        "shaft_1_diameter_mm": cs.uniform(-0.3, 0.3),
        "youngs_modulus_gpa": cs.log_uniform(0.97, 1.03),
    },
    {"eccentricity_mm": cs.normal(sd=0.003)},
    batch_size=8,
)
RESULTS = ["twist_1tn_deg", "output_stiffness_nm_per_arcmin"]


def designs(count: int) -> pl.DataFrame:
    space = cs.Space.sobol(
        cs.Drive.reference_87(), count, seed=3, eccentricity_mm=(0.4, 0.78),
        output_pin_diameter_mm=(12.0, 22.0), output_pin_count=(6, 10),
    )  # fmt: skip
    return cs.sweep(space).select("variant", *(axis.name for axis in space.axes))


def test_percentiles_are_those_of_pieces_evaluated_one_by_one_on_100_designs() -> None:
    table, count = designs(100), 40
    found = cs.tolerance_percentiles(
        table, TOLERANCES, RESULTS, (2.5, 50, 100), count=count, seed=9, limits="hole_web_mm > 4"
    )
    drawn = deviations(TOLERANCES, count, seed=9)
    drive = cs.Drive.reference_87()
    for row, answer in zip(table.rows(named=True), found.rows(named=True), strict=True):
        base = drive.replace(**{name: row[name] for name in row if name != "variant"})
        values: dict[str, list[float]] = {name: [] for name in RESULTS}
        good = 0
        for k in range(count):
            drawing = base.values()
            changes = {name: drawing[name] * f[k] + a[k] for name, (f, a) in drawn.items()}
            try:
                piece: dict[str, Any] = dict(base.replace(**changes).evaluate())
            except cs.DesignError:
                continue
            good += piece["hole_web_mm"] > 4
            for name in RESULTS:
                values[name].append(piece[name])
        assert answer["share_ok"] == good / count
        for name in RESULTS:
            for suffix, rank in (("p2_5", 2.5), ("p50", 50), ("p100", 100)):
                if values[name]:
                    expected = np.percentile(values[name], rank)
                    assert math.isclose(answer[f"{name}_{suffix}"], expected, rel_tol=1e-12)
                else:
                    assert answer[f"{name}_{suffix}"] is None


def test_percentiles_are_those_of_independent_draws_within_their_error() -> None:
    table = designs(100)
    spread = {"eccentricity_mm": cs.normal(sd=0.004), "shaft_1_diameter_mm": 0.3}
    found = cs.tolerance_percentiles(table, spread, "twist_1tn_deg", (5, 95), count=1024)
    generator = np.random.default_rng(1)
    drive = cs.Drive.reference_87()
    within, compared = 0, 0
    for row, answer in zip(table.rows(named=True), found.rows(named=True), strict=True):
        count = 4000
        pieces = pl.DataFrame(
            {
                "eccentricity_mm": row["eccentricity_mm"] + generator.normal(0, 0.004, count),
                "shaft_1_diameter_mm": drive.values()["shaft_1_diameter_mm"]
                + generator.uniform(-0.3, 0.3, count),
            }
        ).with_columns(
            output_pin_diameter_mm=pl.lit(row["output_pin_diameter_mm"]),
            output_pin_count=pl.lit(row["output_pin_count"]),
        )
        values = cs.sweep(cs.Space.table(drive, pieces))["twist_1tn_deg"].drop_nulls().to_numpy()
        if len(values) < 200:
            continue
        for rank, name in ((5, "p5"), (95, "p95")):
            # Three standard errors of a percentile of independent draws, by its neighbours' ranks.
            spread_of_rank = 300 * math.sqrt(0.05 * 0.95 / len(values))
            low, high = np.percentile(values, [max(rank - spread_of_rank, 0),
                                               min(rank + spread_of_rank, 100)])  # fmt: skip
            within += low <= answer[f"twist_1tn_deg_{name}"] <= high
            compared += 1
    assert compared > 150
    assert within / compared > 0.98


def test_the_best_choice_is_the_one_that_stays_good() -> None:
    drive = cs.Drive.reference_87()
    # The largest eccentricity lies at an edge beyond which none can be built.
    table = pl.DataFrame({"eccentricity_mm": [0.70, 0.75, 0.80, 0.83, 0.84, 0.855]})
    feasible = cs.sweep(cs.Space.table(drive, table)).filter(pl.col("status") == "ok")
    edge = table.filter(pl.col("eccentricity_mm").is_in(feasible["eccentricity_mm"].implode()))
    best = cs.robust_choice(
        edge,
        {"eccentricity_mm": cs.normal(sd=0.02)},
        cs.Objective("eccentricity_mm", maximise=True),
    )
    assert best["rank"].to_list() == list(range(1, edge.height + 1))
    # 0.84 and 0.83 are greater as drawn, but too many of their pieces cannot be built.
    assert best.select("eccentricity_mm", "rank_nominal").row(0) == (0.80, 3)
    assert best["share_ok"][0] > 0.99
    assert best["share_ok"].to_list()[-1] < 0.9
    assert "eccentricity_mm_p5" in best.columns


def test_drives_and_their_table_give_the_same() -> None:
    table = designs(5).drop("variant")
    drive = cs.Drive.reference_87()
    drives = [drive.replace(**row) for row in table.rows(named=True)]
    spread = {"shaft_1_diameter_mm": 0.3}
    by_table = cs.tolerance_percentiles(table, spread, "2 * twist_1tn_deg", count=64)
    by_drive = cs.tolerance_percentiles(drives, spread, "2 * twist_1tn_deg", count=64)
    assert by_table.drop(table.columns).equals(by_drive.drop("drive"))
    one = cs.tolerance_percentiles(drives[0], spread, "2 * twist_1tn_deg", count=64)
    assert one.equals(by_drive[:1])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"designs": []}, "expected drives or a table"),
        ({"designs": pl.DataFrame({"label": [1]})}, "no rows with columns that are inputs"),
        ({"designs": pl.DataFrame({"eccentricity_mm": [0.5], "share_ok": [1]})}, "share_ok"),
        ({"results": []}, "results: none"),
        ({"results": "twist_tn_deg"}, "results: no column twist_tn_deg, did you mean"),
        ({"percentiles": [105]}, "percentiles: found 105"),
        ({"tolerances": {"output_pin_count": 1}}, "tolerances.output_pin_count"),
        ({"tolerances": {"excentricity": 1}}, "excentricity"),
    ],
)
def test_bad_input_is_one_line(change: dict[str, Any], message: str) -> None:
    given: dict[str, Any] = {
        "designs": cs.Drive.reference_87(), "tolerances": {"eccentricity_mm": 0.01},
        "results": "twist_1tn_deg", "percentiles": [5],
    }  # fmt: skip
    with pytest.raises(cs.InputError, match=message):
        cs.tolerance_percentiles(*(given | change).values())
