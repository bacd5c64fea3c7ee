"""The report of a study: it says what a plain reading of the rows says, and it is one page."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.design.parts import Engine
from cyclosweep.explore.influence import variance_share
from cyclosweep.explore.tables import open_table
from cyclosweep.study_report.aggregate import CELLS, Aggregate, aggregate
from cyclosweep.study_report.gather import gather
from cyclosweep.study_report.words import summary, why_not_robust

OUTCOMES = ("output_stiffness_nm_per_arcmin", "hole_web_mm")


def study() -> cs.Study:
    space = cs.Space.sobol(
        cs.Drive.reference_87(),
        4096,
        seed=2,
        eccentricity_mm=(0.4, 0.9),
        output_pin_count=(6, 12),
        output_pin_diameter_mm=(12.0, 24.0),
    )
    objective = cs.Objective("output_stiffness_nm_per_arcmin", maximise=True)
    return cs.Study.of(space, limits={"hole_web_mm": (2.0, None)}, objective=objective)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("Bericht") / "eine Studie ü"
    cs.sink(study(), path, rows_per_part=1000)
    return path


@pytest.fixture(scope="module")
def found(folder: Path) -> Aggregate:
    return aggregate(cs.open_study(folder), open_table(folder), OUTCOMES)


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return cs.report_study(folder, folder.parent / "bericht ö.html").read_text("utf-8")


def test_a_limit_without_an_end_is_said_in_words(page: str) -> None:
    plain = page.replace("<wbr>", "")
    assert "hole_web_mm at least 2.0" in plain
    assert "to inf" not in plain


def test_counts_and_means_are_those_of_the_rows(folder: Path, found: Aggregate) -> None:
    rows = cs.scan_dataset(folder).collect()
    ok = rows.filter(status="ok")
    assert (found.rows, found.feasible) == (rows.height, ok.height)
    pins = next(axis for axis in found.axes if axis.name == "output_pin_count")
    assert pins.is_listed
    assert pins.centres.tolist() == list(range(6, 13))
    by_count = ok.group_by("output_pin_count").agg(
        pl.len(), pl.col(OUTCOMES[0]).mean(), pl.col(OUTCOMES[0]).std(ddof=0).alias("std")
    ).sort("output_pin_count")  # fmt: skip
    assert pins.feasible.tolist() == by_count["len"].to_list()
    assert pins.means[OUTCOMES[0]] == pytest.approx(by_count[OUTCOMES[0]].to_numpy(), rel=1e-12)
    assert pins.deviations[OUTCOMES[0]] == pytest.approx(by_count["std"].to_numpy(), rel=1e-6)
    for axis in found.axes:
        assert axis.total.sum() == rows.height
        assert axis.feasible.sum() == ok.height
    assert found.cells is not None
    assert found.cells.shape == CELLS
    assert found.cells.sum() == ok.height


def test_shares_of_variance_are_first_order_indices(tmp_path: Path) -> None:
    """Without limits: indices by brute force, conditional means over many draws."""
    space = cs.Space.sobol(
        cs.Drive.reference_87(), 2**15, seed=5,
        eccentricity_mm=(0.5, 0.7), output_pin_diameter_mm=(14.0, 18.0),
        shaft_1_diameter_mm=(46.0, 54.0),
    )  # fmt: skip
    cs.sink(space, tmp_path)
    axes = aggregate(cs.open_study(tmp_path), open_table(tmp_path), OUTCOMES[:1]).axes
    rng = np.random.default_rng(1)
    drive = cs.Drive.reference_87()
    for axis in axes:
        low, high = {
            "eccentricity_mm": (0.5, 0.7),
            "output_pin_diameter_mm": (14.0, 18.0),
            "shaft_1_diameter_mm": (46.0, 54.0),
        }[axis.name]
        others = {
            name: ends
            for name, ends in {
                "eccentricity_mm": (0.5, 0.7),
                "output_pin_diameter_mm": (14.0, 18.0),
                "shaft_1_diameter_mm": (46.0, 54.0),
            }.items()
            if name != axis.name
        }
        means, spread = [], []
        for value in np.linspace(low, high, 41):
            drawn = {name: rng.uniform(*ends, 400) for name, ends in others.items()}
            table = pl.DataFrame({axis.name: np.full(400, value), **drawn})
            y = cs.sweep(cs.Space.table(drive, table))[OUTCOMES[0]].to_numpy()
            means.append(y.mean())
            spread.append(y.var())
        between = np.trapezoid((np.array(means) - np.mean(means)) ** 2, dx=1 / 40)
        expected = between / (between + np.mean(spread))
        assert axis.shares[OUTCOMES[0]] == pytest.approx(expected, abs=0.02), axis.name


def test_chance_gives_no_share() -> None:
    """An input without effect has no share, though means of few rows differ."""
    rng = np.random.default_rng(3)
    shares = []
    for _ in range(200):
        place, y = rng.integers(0, 20, 400), rng.normal(size=400)
        count = np.bincount(place, minlength=20).astype(float)
        sums, squares = (np.bincount(place, v, 20).astype(float) for v in (y, y * y))
        shares.append(variance_share(count, sums, float(squares.sum()), 0.0))
    assert np.mean(shares) < 0.02
    assert variance_share(np.array([3.0, 3.0]), np.array([3.0, 6.0]), 15.0, 0.0) == 1.0


def test_front_and_chosen_variants(folder: Path) -> None:
    facts = gather(folder)
    first, second = facts.objectives
    assert (first.column, first.maximise) == (OUTCOMES[0], True)
    senses = {each.column: "max" if each.maximise else "min" for each in facts.objectives}
    whole = cs.pareto_front(folder, senses)
    assert facts.front_size == whole.height > 3
    assert set(facts.front["variant"]) <= set(whole["variant"])
    best = cs.best_variants(folder, f"max {first.column}").table["variant"][0]
    assert best in facts.chosen
    assert len(facts.chosen) == 3
    assert second.column in facts.outcomes


def test_robust_percentiles_are_those_of_a_sweep_around_the_drive(folder: Path) -> None:
    tolerances = {"output_pin_diameter_mm": 0.05, "eccentricity_mm": 0.02}
    facts = gather(folder, tolerances=cs.Tolerances(tolerances))
    for each in facts.robust[:3]:
        drive = cs.open_study(folder).drive_of(each.variant)
        pieces = cs.Space.around(drive, tolerances, 1024, seed=1)
        table = cs.sweep(pieces).filter(status="ok")
        y = table[OUTCOMES[0]].to_numpy()
        assert each.percentiles[OUTCOMES[0]] == pytest.approx(np.percentile(y, [5, 50, 95]))
        assert each.usable == table.filter(pl.col("hole_web_mm") >= 2).height / 1024
        assert not math.isnan(each.nominal[OUTCOMES[0]])
    bad = [each.percentiles[OUTCOMES[0]][0] for each in facts.robust if each.usable >= 0.99]
    assert bad == sorted(bad, reverse=True)


class _Links(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in ("meta", "link", "img", "wbr", "br"):
            self.open.append(tag)
        for name, value in attrs:
            if name in ("src", "href") and value and not value.startswith(("data:", "#")):
                self.outside.append(value)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_page_is_whole_small_and_needs_nothing_else(page: str) -> None:
    reader = _Links()
    reader.feed(re.sub(r"(<(?:path|rect|circle|polyline|polygon)\b[^>]*)/>", "", page))
    assert reader.open == []
    assert reader.outside == []
    assert "url(" not in page.partition("</style>")[0]
    assert len(page) < 2_000_000
    for heading in (
        "Chosen variants", "Pareto front", "Robust candidates", "What drives what",
        "Which variants can be built", "Provenance", "Be careful",
    ):  # fmt: skip
        assert f"<h2>{heading}</h2>" in page, heading
    assert study().hash in page


def test_assumed_numbers_are_marked(page: str) -> None:
    assert '<tr class="assumed"><td>ring_<wbr>pin_<wbr>circle_<wbr>radius_<wbr>mm</td>' in page
    assert '<tr class="published"><td>ratio</td>' in page


def test_every_point_has_its_row(page: str) -> None:
    points = re.findall(r'<circle class="dot" data-variant="(\d+)"', page)
    rows = re.findall(r'<tr[^>]* data-variant="(\d+)">', page)
    assert points == rows
    assert len(points) > 3


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", *arguments],
        capture_output=True, text=True, check=False, cwd=cwd,
    )  # fmt: skip


def test_why_pieces_cannot_be_used_is_said(tmp_path: Path) -> None:
    """A first segment as thick as the next one: half of the pieces are thicker."""
    space = cs.Space.grid(cs.Drive.reference_87(), shaft_1_diameter_mm=[54.0, 55.0])
    cs.sink(space, tmp_path / "s", objective=cs.Objective("twist_1tn_deg"))
    facts = gather(tmp_path / "s")
    by_variant = {each.variant: each for each in facts.robust}
    assert by_variant[1].refused == "shaft_step_not_ascending"
    assert by_variant[1].usable == pytest.approx(0.5, abs=0.01)
    page = cs.report_study(tmp_path / "s", tmp_path / "r.html").read_text("utf-8")
    assert "shaft_step_not_ascending" in page.replace("<wbr>", "")


def test_objectives_and_limits_that_are_expressions(tmp_path: Path) -> None:
    """Without objectives on the command line; the limit is a ratio that half of the pieces meet."""
    space = cs.Space.grid(
        cs.Drive.reference_87(), output_pin_diameter_mm=[14.0, 15.0, 16.0], output_pin_count=[7, 8]
    )
    ratio, stiffness = "hole_web_mm / output_pin_diameter_mm", "output_stiffness_nm_per_arcmin"
    least = float(cs.sweep(space).select(pl.sql_expr(ratio)).to_series()[4])
    aims = [
        cs.Objective(f"{stiffness} / output_pin_count", maximise=True),
        cs.Objective("output_pin_count * output_pin_diameter_mm"),
    ]
    for name, objectives in (("one", aims[:1]), ("two", aims)):
        folder = tmp_path / name
        cs.sink(space, folder, objective=objectives, limits={ratio: (least, None)})
        facts = gather(folder)
        assert facts.objectives[: len(objectives)] == objectives
        assert len(facts.objectives) == 2
        by_variant = {each.variant: each for each in facts.robust}
        assert by_variant[4].usable == pytest.approx(0.5, abs=0.01)
        assert by_variant[4].refused == f"limit_{ratio}"
        row = cs.open_study(folder).row(4)
        nominal = by_variant[4].nominal[aims[0].column]
        assert nominal == pytest.approx(row[stiffness] / row["output_pin_count"])
        page = cs.report_study(folder, tmp_path / f"{name}.html").read_text("utf-8")
        assert "Robust candidates" in page


def test_command_with_objectives_limits_variants_and_tolerances(folder: Path) -> None:
    here = folder.parent
    (here / "tol.toml").write_text("[tolerances]\noutput_pin_diameter_mm = 0.02\n")
    result = run(
        "report", folder.name, "--out", "r 2.html", "--pareto",
        "max output_stiffness_nm_per_arcmin, output_pin_diameter_mm", "--limit", "hole_web_mm > 5",
        "--variant", "7", "--tolerances", "tol.toml", cwd=here,
    )  # fmt: skip
    assert result.returncode == 0, result.stderr
    text = (here / "r 2.html").read_text("utf-8")
    assert "least output_pin_diameter_mm" in text
    assert 'id="variant-7"' in text
    assert "±0.02" in text


def test_an_objective_of_the_user_s_own_says_why_no_pieces_are_made(tmp_path: Path) -> None:
    space = cs.Space.grid(cs.Drive.reference_87(), output_pin_diameter_mm=[14.0, 15.0])
    own = {"area": "output_pin_diameter_mm * output_pin_diameter_mm"}
    study = cs.Study.of(space, columns=own, objective=cs.Objective("area"))
    cs.sink(study, tmp_path / "s")
    page = cs.report_study(tmp_path / "s", tmp_path / "r.html").read_text("utf-8")
    assert "None: an objective or limit reads a column of your own" in page


@pytest.mark.parametrize("solver", ["quadratic", "full"])
def test_pieces_are_solved_by_the_study_s_engine(solver: Engine, tmp_path: Path) -> None:
    drive = cs.Drive.reference_87().replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
    space = cs.Space.grid(drive, output_pin_diameter_mm=[15.0, 16.0])
    objective = cs.Objective("loaded_twist_arcmin")
    study = cs.Study.of(space, model="components", solver=solver, objective=objective)
    cs.sink(study, tmp_path / "s")
    assert cs.open_study(tmp_path / "s").solver == solver
    row = cs.open_study(tmp_path / "s").row(1)
    robust = next(each for each in gather(tmp_path / "s").robust if each.variant == 1)
    assert robust.nominal["loaded_twist_arcmin"] == row["loaded_twist_arcmin"]


def test_the_limits_of_a_report_count_in_all_of_it(folder: Path, found: Aggregate) -> None:
    stored, rows = cs.open_study(folder), open_table(folder)
    few = gather(folder, limits=["hole_web_mm > 4"])
    kept = rows.frame.filter(pl.col("status").cast(pl.String) == "ok", pl.col("hole_web_mm") > 4)
    count = kept.select(pl.len()).collect().item()
    assert 0 < count < found.feasible
    assert few.aggregate.feasible == count
    assert few.aggregate.axes[0].feasible.sum() == count
    assert few.statuses["ok"] == count
    assert few.statuses["not hole_web_mm > 4"] == found.feasible - count
    assert sum(few.statuses.values()) == stored.summary.rows
    none = gather(folder, limits=["hole_web_mm > 4000"])
    assert why_not_robust(none) == "None: no variant can be built and keeps the limits."
    assert "Most of the others: not hole_web_mm > 4000" in summary(none)[0]


def test_a_study_with_nothing_feasible_has_a_report(tmp_path: Path) -> None:
    space = cs.Space.grid(cs.Drive.reference_87(), output_pin_diameter_mm=[40.0, 50.0])
    cs.sink(space, tmp_path / "s")
    text = cs.report_study(tmp_path / "s", tmp_path / "r.html").read_text("utf-8")
    assert "No feasible variant lies within the limits." in text
    assert "holes_overlap" in text.replace("<wbr>", "")


def test_a_study_of_the_component_model_has_its_budget(tmp_path: Path) -> None:
    drive = cs.Drive.from_toml(Path(__file__).parents[2] / "examples" / "components-87.toml")
    space = cs.Space.grid(drive, ring_pin_radius_mm=[1.9, 2.0, 2.1], output_pin_count=[7, 8])
    cs.sink(space, tmp_path / "s", model="components")
    text = cs.report_study(tmp_path / "s", tmp_path / "r.html").read_text("utf-8")
    assert "component model at rated torque" in text
    assert "clearances taken up" in text


BAD = {
    "no study": (["report", ".", "--out", "x.html"], "no study there"),
    "no folder": (["report", "S", "--out", "none/x.html"], "a folder that exists"),
    "a folder": (["report", "S", "--out", "S"], "is a folder"),
    "objective": (["report", "S", "--out", "x.html", "--pareto", "a,b"], "no column a"),
    "limit": (["report", "S", "--out", "x.html", "--limit", "hole_web > 1"], "did you mean"),
    "variant": (["report", "S", "--out", "x.html", "--variant", "9999"], "no variant 9999"),
    "tolerances": (["report", "S", "--out", "x.html", "--tolerances", "t.toml"], "t.toml"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line_and_leaves_nothing(case: str, folder: Path) -> None:
    arguments, words = BAD[case]
    before = sorted(folder.parent.iterdir())
    found = run(*(folder.name if a == "S" else a for a in arguments), cwd=folder.parent)
    assert (found.returncode, found.stdout) == (2, ""), found.stderr
    [line] = found.stderr.strip().splitlines()
    assert words in line
    assert sorted(folder.parent.iterdir()) == before


def test_an_input_that_follows_from_others_has_no_share_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(
        'drive = "reference-87"\n[sample]\nmethod = "sobol"\ncount = 200\n'
        "[axes]\neccentricity_mm = { from = 0.4, to = 0.8 }\n"
        '[derived]\ndisc_outer_radius_mm = "60 - 2 * eccentricity_mm"\n'
        '[objective]\nmaximise = "output_stiffness_nm_per_arcmin"\n'
    )
    cs.sink(cs.Study.from_toml(tmp_path / "study.toml"), tmp_path / "folder")
    stored = cs.open_study(tmp_path / "folder")
    assert "disc_outer_radius_mm" in stored.axes
    found = aggregate(stored, open_table(tmp_path / "folder"), OUTCOMES[:1])
    assert [axis.name for axis in found.axes] == ["eccentricity_mm"]
    page = cs.report_study(tmp_path / "folder", tmp_path / "report.html").read_text("utf-8")
    assert "disc_outer_radius_mm" in page
