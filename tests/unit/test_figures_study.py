"""Pictures of a study: samples are fair and bounded, cells are means, fronts are the front."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from matplotlib.collections import LineCollection, QuadMesh

import cyclosweep as cs
from cyclosweep.figures.pages import parallel_page, pareto_page, response_page
from cyclosweep.figures.parallel import parallel_figure
from cyclosweep.figures.pareto import pareto_figure
from cyclosweep.figures.response import response_figure
from cyclosweep.figures.rows import How, cells_of, rows_of, sample_of
from cyclosweep.figures.words import axis_label
from tests.support.pictures import artists, cut, lines

ROOT = Path(__file__).parents[2]
OBJECTIVES = ["twist_1tn_deg", "max hole_web_mm"]


@pytest.fixture(scope="module")
def table() -> pl.DataFrame:
    space = cs.Space.sobol(
        cs.Drive.reference_87(),
        6000,
        output_pin_circle_radius_mm=(38.0, 50.0),
        output_pin_diameter_mm=(10.0, 22.0),
        output_pin_count=(5, 12),
    )
    return cs.sweep(space)


def test_a_sample_is_fair_the_same_each_time_and_knows_how_many_there_were() -> None:
    rows = pl.DataFrame({"variant": np.arange(250_000), "value": np.arange(250_000) / 250_000})
    sample = sample_of(rows, ["value"], most=2000)
    assert (sample.frame.height, sample.total) == (2000, 250_000)
    assert sample.frame["variant"].is_sorted()
    assert sample.frame["variant"].n_unique() == 2000
    deciles, _ = np.histogram(sample.frame["value"], bins=10, range=(0, 1))
    assert ((deciles - 200) ** 2 / 200).sum() < 27.9  # chi squared, 9 degrees, one in a thousand
    assert sample.frame.equals(sample_of(rows.lazy(), ["value"], most=2000).frame)
    assert sample.said == "2,000 of 250,000 variants, drawn at random."


def test_a_sample_leaves_out_what_cannot_be_built_or_breaks_a_limit(table: pl.DataFrame) -> None:
    sample = sample_of(table, ["hole_web_mm"], most=10_000, limits="hole_web_mm > 4")
    wanted = table.filter(pl.col("status") == "ok", pl.col("hole_web_mm") > 4)
    assert sample.frame["variant"].to_list() == wanted["variant"].to_list()
    assert sample.said == f"All {wanted.height:,} variants."
    with pytest.raises(cs.InputError, match="no variant is left"):
        sample_of(table, ["hole_web_mm"], most=10, limits="hole_web_mm > 1000")


@pytest.mark.parametrize("how", ["mean", "min", "max"])
def test_cells_are_those_of_a_group_by(table: pl.DataFrame, how: How) -> None:
    diameter = (pl.col("output_pin_diameter_mm") * 2).round() / 2
    rows = table.with_columns(diameter)
    cells = cells_of(rows, "output_pin_count", "output_pin_diameter_mm", "twist_1tn_deg", how=how)
    assert cells.is_exact
    wanted = (
        rows.filter(status="ok")
        .group_by("output_pin_count", "output_pin_diameter_mm")
        .agg(getattr(pl.col("twist_1tn_deg"), how)(), pl.len())
    )
    for count, at, value, number in wanted.iter_rows():
        place = np.searchsorted(cells.y, at), np.searchsorted(cells.x, count)
        assert cells.values[place] == pytest.approx(value)
        assert cells.counts[place] == number
    assert np.isfinite(cells.values).sum() == wanted.height


def test_many_values_share_equal_steps(table: pl.DataFrame) -> None:
    names = "output_pin_circle_radius_mm", "output_pin_diameter_mm", "hole_web_mm"
    cells = cells_of(table, *names)
    assert not cells.is_exact
    x, y, z = (table.filter(status="ok")[name].to_numpy() for name in names)
    counts, _, _ = np.histogram2d(y, x, bins=40)
    sums, _, _ = np.histogram2d(y, x, bins=40, weights=z)
    assert np.array_equal(cells.counts, counts)
    filled = counts > 0
    assert cells.values[filled] == pytest.approx(sums[filled] / counts[filled])
    assert np.isnan(cells.values[~filled]).all()


def test_the_drawn_front_is_the_front_and_bounds_every_variant(table: pl.DataFrame) -> None:
    figure = pareto_figure(table, OBJECTIVES, chosen=[0])
    front = cs.pareto_front(table, OBJECTIVES).sort("twist_1tn_deg")
    [drawn] = lines(figure, "front")
    assert drawn.tolist() == front.select("twist_1tn_deg", "hole_web_mm").to_numpy().tolist()
    [behind] = lines(figure, "feasible")
    assert len(behind) == 4000
    # Above the stairs nothing can be had: the best web among all of less twist.
    reached = np.searchsorted(drawn[:, 0], behind[:, 0], side="right") - 1
    assert np.all(behind[:, 1] <= drawn[reached, 1])
    [chosen] = lines(figure, "chosen")
    assert chosen.tolist() == [list(table.select("twist_1tn_deg", "hole_web_mm").row(0))]
    assert cut(figure) == []


def test_lines_across_parallel_axes_are_variants(table: pl.DataFrame) -> None:
    names = ["output_pin_count", "output_pin_diameter_mm", "hole_web_mm", "2 * twist_1tn_deg"]
    figure = parallel_figure(table, names, chosen=[1, 0])
    [drawn] = artists(figure, "line")
    assert isinstance(drawn, LineCollection)
    segments = np.array(drawn.get_segments())
    assert segments.shape == (400, 4, 2)
    assert segments[:, :, 1].min() == 0
    assert segments[:, :, 1].max() == 1
    sample = sample_of(table, names, most=400).frame
    marked = rows_of(table, [1, 0], names)
    assert marked["variant"].to_list() == [1, 0]
    low = min(sample["hole_web_mm"].min(), marked["hole_web_mm"].min())  # type: ignore[type-var]
    high = max(sample["hole_web_mm"].max(), marked["hole_web_mm"].max())  # type: ignore[type-var]
    first = lines(figure, "chosen")[0]
    assert low + (high - low) * first[2, 1] == pytest.approx(marked["hole_web_mm"][0])  # type: ignore[operator]
    assert cut(figure) == []
    assert cut(parallel_figure(table, [f"{k} * hole_web_mm" for k in range(1, 13)])) == []


def test_a_map_of_a_whole_grid_has_contours_one_with_gaps_has_cells(table: pl.DataFrame) -> None:
    drive = cs.Drive.reference_87()
    grid = cs.Space.grid(
        drive, output_pin_diameter_mm=[10, 12, 14, 16], output_pin_circle_radius_mm=[40, 42, 44]
    )
    names = (
        "output_pin_diameter_mm",
        "output_pin_circle_radius_mm",
        "output_stiffness_nm_per_arcmin",
    )
    whole = response_figure(grid, *names)
    assert artists(whole, "cells") == []
    assert cut(whole) == []
    figure = response_figure(table, *names)
    [mesh] = artists(figure, "cells")
    assert isinstance(mesh, QuadMesh)
    cells = cells_of(table, *names).values
    drawn: Any = mesh.get_array()
    assert drawn.compressed() == pytest.approx(cells[np.isfinite(cells)])
    assert cut(figure) == []


def test_ticks_of_a_map_stand_apart_and_among_the_values() -> None:
    clearances = [0.0, 0.005, 0.01]
    frame = pl.DataFrame(
        [(x, y, x + y) for x in clearances for y in (0.0, 2.5e-3, 5e-3, 7.5e-3) if x + y < 0.015],
        schema=["hole_clearance_mm", "ring_clearance_mm", "lost_motion_3pct_arcmin"],
        orient="row",
    )
    figure = response_figure(frame, *frame.columns)
    figure.draw_without_rendering()
    panel = figure.axes[0]
    for axis, low, high in ((panel.xaxis, 0.0, 0.01), (panel.yaxis, 0.0, 7.5e-3)):
        ticks = axis.get_ticklocs()
        assert len(ticks) >= 3
        assert ticks.min() >= low - 1e-9
        assert ticks.max() <= high + 1e-9
        boxes = [label.get_window_extent() for label in axis.get_ticklabels()]
        assert not any(a.overlaps(b) for a, b in itertools.pairwise(boxes))


def test_pages_are_small_whatever_the_table(table: pl.DataFrame) -> None:
    many = pl.concat([table] * 40).with_columns(variant=pl.int_range(pl.len(), dtype=pl.UInt64))
    pages = {
        "pareto": pareto_page(many, OBJECTIVES),
        "parallel": parallel_page(many, ["output_pin_count", "hole_web_mm", "twist_1tn_deg"]),
        "response": response_page(
            many, "output_pin_count", "output_pin_diameter_mm", "hole_web_mm"
        ),
    }
    for name, page in pages.items():
        text = page.to_json()
        assert len(text) < 60_000, name
        assert "variants" in json.loads(text)["layout"]["meta"]["said"]
    whole = pareto_page(table, OBJECTIVES)
    assert "one in" not in whole.layout.meta["said"]
    assert len(whole.data[1].x) == cs.pareto_front(table, OBJECTIVES).height
    assert "Of the front one in" in pages["pareto"].layout.meta["said"]
    assert len(pages["pareto"].data[1].x) <= 2000


def test_labels_carry_units() -> None:
    assert axis_label("pin_bending_stress_mpa") == "pin bending stress [MPa]"
    assert axis_label("twist_4p5tn_deg") == "twist at 4.5 T_N [deg]"
    assert axis_label("shaft_1_diameter_mm") == "shaft 1 diameter [mm]"
    assert axis_label("my_own") == "my_own"


def plot(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "cyclosweep", "plot", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


def test_the_command_draws_a_table_a_folder_and_a_study_file(
    table: pl.DataFrame, tmp_path: Path
) -> None:
    csv, folder, study = tmp_path / "t.csv", tmp_path / "stu dy", tmp_path / "study.toml"
    table.head(500).write_csv(csv)
    space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 7, 8, 9, 10])
    cs.sink(space, folder)
    study.write_text('drive = "reference-87"\n[axes]\noutput_pin_count = { values = [6, 8, 9] }\n')
    axes = ["--column", "output_pin_count", "--column", "twist_1tn_deg"]
    for source, out in ((csv, "a.png"), (folder, "b.svg"), (study, "c.pdf")):
        done = plot("parallel", source, *axes, "--out", tmp_path / out)
        assert (done.returncode, done.stderr) == (0, ""), source
        assert (tmp_path / out).stat().st_size > 1000


@pytest.mark.parametrize(
    ("arguments", "found"),
    [
        (("pareto", "t.csv"), "--objective"),
        (("pareto", "t.csv", "--objective", "hole_web_mm"), "expected two"),
        (("pareto", "t.csv", "--objective", "hole_webmm", "--objective", "ratio"), "hole_web_mm"),
        (("parallel", "t.csv", "--column", "hole_web_mm"), "expected two to twelve"),
        (("parallel", "t.csv"), "--column"),
        (("parallel", "none.csv", "--column", "a", "--column", "b"), "none.csv"),
        (("response", "t.csv", "--x", "output_pin_count"), "--x, --y, --z"),
        (("pareto", "t.csv", "--objective", "hole_web_mm", "--objective", "twist_1tn_deg",
          "--variant", "999999"), "variant 999999"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line(
    arguments: tuple[str, ...],
    found: str,
    table: pl.DataFrame,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    table.head(50).write_csv("t.csv")
    done = plot(*arguments, "--out", "a.png")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1), done.stderr
    assert found in done.stderr
    assert not Path("a.png").exists()
