"""Feasible ranges and the influence of inputs, against counts and averages of whole tables."""

from __future__ import annotations

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.explore import tables


@pytest.fixture(scope="module")
def space() -> cs.Space:
    return cs.Space.sobol(
        cs.Drive.reference_87(), 4096, seed=2, eccentricity_mm=(0.3, 1.2),
        output_pin_diameter_mm=(10.0, 30.0), output_pin_count=(6, 12),
    )  # fmt: skip


def test_ranges_are_those_of_the_whole_table(
    space: cs.Space, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tables, "_BATCH_ROWS", 500)
    found = cs.feasible_ranges(space, {"hole_web_mm": (3.0, None)}, intervals=10)
    table = cs.sweep(space)
    good = table.filter(pl.col("status") == "ok", pl.col("hole_web_mm") >= 3)
    assert (found.rows, found.feasible) == (4096, good.height)
    for name, low, high, feasible_low, feasible_high in found.inputs.iter_rows():
        assert (low, high) == (table[name].min(), table[name].max())
        assert (feasible_low, feasible_high) == (good[name].min(), good[name].max())
        intervals = found.intervals.filter(pl.col("input") == name)
        assert intervals["rows"].sum() == 4096
        assert intervals["feasible"].sum() == good.height
    counts = found.intervals.filter(pl.col("input") == "output_pin_count")
    assert counts["low"].to_list() == [6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0]
    assert counts["feasible"].to_list() == [
        good.filter(pl.col("output_pin_count") == k).height for k in range(6, 13)
    ]
    values = table["eccentricity_mm"].to_numpy()
    edges = np.linspace(values.min(), values.max(), 11)
    expected = np.histogram(good["eccentricity_mm"], edges)[0]
    shown = found.intervals.filter(pl.col("input") == "eccentricity_mm")["feasible"]
    assert shown.to_list() == expected.tolist()


def test_a_rule_rules_out_what_it_says_and_nothing_feasible(space: cs.Space) -> None:
    found = cs.feasible_ranges(space)
    table = cs.sweep(space)
    assert found.rules.height >= 1
    assert found.rules["rule"][0].startswith("eccentricity_mm >=")
    for rule, rows, share in found.rules.iter_rows():
        name, sign, value = rule.split()
        meets = table.filter(
            pl.col(name) >= float(value) if sign == ">=" else pl.col(name) < float(value)
        )
        assert abs(meets.height - rows) <= 2
        assert meets.filter(pl.col("status") == "ok").height <= 1
        assert share == rows / (found.rows - found.feasible)


def test_ranges_of_what_is_nowhere_feasible_are_empty(space: cs.Space) -> None:
    found = cs.feasible_ranges(space, "eccentricity_mm > 9")
    assert found.feasible == 0
    assert found.inputs["feasible_low"].to_list() == [None] * 3
    assert found.rules.is_empty()


def test_influence_is_the_share_of_variance_between_groups() -> None:
    drive = cs.Drive.reference_87()
    grid = cs.Space.grid(
        drive, output_pin_count=[6, 8, 10], shaft_1_length_mm=cs.linspace(60, 110, 8),
        output_pin_diameter_mm=cs.linspace(14, 18, 8),
    )  # fmt: skip
    found = cs.input_influence(grid, ["twist_1tn_deg", "nominal_torque_nm", "2 * hole_web_mm"])
    table = cs.sweep(grid)
    values = table["twist_1tn_deg"].to_numpy()
    whole = ((values - values.mean()) ** 2).sum()
    for name in ("output_pin_count", "shaft_1_length_mm", "output_pin_diameter_mm"):
        groups = table.group_by(name).agg(pl.col("twist_1tn_deg").mean().alias("m"), pl.len())
        means, sizes = groups["m"].to_numpy(), groups["len"].to_numpy()
        between = ((means - values.mean()) ** 2 * sizes).sum()
        within = (whole - between) / (table.height - groups.height)
        expected = max(between - (groups.height - 1) * within, 0) / whole
        assert found[name][0] == pytest.approx(expected, rel=1e-9)
    assert found["driven_by"].to_list()[1] is None
    assert found["output_pin_diameter_mm"].to_list()[1] is None


def test_influence_estimates_first_order_sobol_indices() -> None:
    pytest.importorskip("SALib")
    space = cs.Space.sobol(
        cs.Drive.reference_87(), 2**14, seed=1, output_pin_diameter_mm=(14.0, 18.0),
        shaft_1_diameter_mm=(45.0, 55.0), output_pin_length_mm=(30.0, 50.0),
    )  # fmt: skip
    result = "output_stiffness_nm_per_arcmin"
    shares = cs.input_influence(space, result)
    indices = cs.sobol_indices(space, result, half_width=0.02)
    for name, index, width in indices.select(
        "input", "first_order", "first_order_half_width"
    ).iter_rows():
        assert abs(shares[name].item() - index) < width + 0.01
    noise = pl.DataFrame({"x": np.linspace(0, 1, 500), "y": np.random.default_rng(3).random(500)})
    assert cs.input_influence(noise, "y", inputs=["x"])["x"].item() < 0.05


def test_bad_input_is_one_line(space: cs.Space) -> None:
    table = cs.sweep(space)
    for function, message in (
        (lambda: cs.feasible_ranges(table.drop("variant")), "inputs: none given"),
        (lambda: cs.feasible_ranges(table, inputs=["pins"]), "no column pins"),
        (lambda: cs.feasible_ranges(table, inputs=["status"]), "status holds no numbers"),
        (lambda: cs.input_influence(table.drop("status"), inputs=["variant"]), "results: none"),
        (lambda: cs.input_influence(table, "twist"), "results: no column twist"),
    ):  # fmt: skip
        with pytest.raises(cs.InputError, match=message):
            function()
