"""Diagnosis of a folder: every recording has a row, what is done is kept, a dose reads as one."""

import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import polars as pl
import pytest
from rich.console import Console
from rich.rule import Rule

import cyclosweep as cs
from cyclosweep.atomic import write_text
from cyclosweep.cli.diagnose import _FolderTable, shortened
from cyclosweep.cli.output import print_tables
from cyclosweep.diagnosis.folder import recordings_in
from cyclosweep.diagnosis.series import conditions_of, small_loops_of, trends
from cyclosweep.recording.metadata import Metadata
from cyclosweep.report.series_page import write_series_page
from cyclosweep.report.straight_lines import straight_lines

SHARED = Path(os.environ.get("CYCLOSWEEP_SHARED", Path(__file__).parents[3] / "shared"))
PRELOAD = SHARED / "recordings" / "cycloidal-13-to-1" / "preload-series"
EXAMPLE = Path(__file__).parents[2] / "examples" / "measured-13-to-1"


def write_loop(path: Path, friction_nm: float, play_deg: float, seed: int) -> None:
    """Write two runs of a loop with friction and play at the input of the reference drive."""
    rng = np.random.default_rng(seed)
    branch = np.r_[0:9:100j, 9:-9:200j, -9:0:100j]
    direction = np.sign(np.gradient(branch))
    elastic = branch - friction_nm * direction
    angle = np.sign(elastic) * play_deg + 2.7 * elastic
    rows = ["torque_nm,angle_deg,run"]
    for run in range(2):
        noise = rng.normal(0.0, 0.1, len(branch))
        rows += [f"{t:.4f},{a + n:.3f},{run}" for t, a, n in zip(branch, angle, noise, strict=True)]
    path.write_text("\n".join(rows) + "\n")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Six recordings of three doses, and one that is no recording."""
    place = tmp_path / "recordings"
    place.mkdir()
    for dose in (1, 2, 3):
        for repeat in (1, 2):
            name = f"dose{dose}_repeat{repeat}.csv"
            write_loop(place / name, 0.3 + 0.2 * dose, 30.0 - 2.0 * dose, 10 * dose + repeat)
    (place / "broken.csv").write_text("torque_nm,angle_deg\n1,2\n2,three\n")
    (tmp_path / "how.toml").write_text(
        'drive = "reference-87"\nconditions_from_name = "dose(?P<dose>[0-9])"\n'
    )
    return place


def test_a_folder_s_recordings_are_all_that_can_be_read(tmp_path: Path) -> None:
    endings = (
        "csv", "tsv", "txt", "dat", "asc", "parquet", "pq", "lvm", "tdms", "mat", "h5", "hdf5",
        "json", "jsonl", "xlsx", "xlsm", "xlsb", "xls", "ods", "csv.gz", "txt.gz", "XLS",
    )  # fmt: skip
    wanted = {f"loop{place}.{ending}" for place, ending in enumerate(endings)}
    others = {"loop.toml", "notes.md", "photo.png", "~$loop0.xlsx", "._loop0.csv", ".csv", "csv",
              "loop.xls.gz", "loop.csv.part"}  # fmt: skip
    (tmp_path / "folder.csv").mkdir()
    for name in others:
        (tmp_path / name).touch()
    with pytest.raises(cs.InputError, match=r"found no recording.*\.ods.*\.xlsb") as caught:
        recordings_in(tmp_path)
    assert "\n" not in str(caught.value)
    for name in wanted:
        (tmp_path / name).touch()
    assert {path.name for path in recordings_in(tmp_path)} == wanted


def test_tables_that_a_series_left_are_no_recordings(tmp_path: Path) -> None:
    write_loop(tmp_path / "loop.csv", 0.5, 25.0, 1)
    (tmp_path / "table.csv").write_text("torque_nm,angle_deg\n1,2\n")
    assert len(recordings_in(tmp_path)) == 2
    for name in ("table.parquet", "index.html"):
        (tmp_path / name).touch()
    assert recordings_in(tmp_path) == [tmp_path / "loop.csv"]


def test_recordings_of_one_name_are_both_said(tmp_path: Path) -> None:
    paths = [tmp_path / place / "loop.csv" for place in ("a", "b")]
    with pytest.raises(cs.InputError, match=r"found .*a/loop\.csv and .*b/loop\.csv, expected"):
        cs.diagnose_folder(paths, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_what_no_recording_can_have_is_refused_before_any_work(tmp_path: Path) -> None:
    write_loop(tmp_path / "loop.csv", 0.5, 25.0, 1)
    paths, out = [tmp_path / "loop.csv"], tmp_path / "out"
    with pytest.raises(cs.InputError, match="recordings: found none, expected a folder"):
        cs.diagnose_folder([], out)
    with pytest.raises(cs.InputError, match=r"option: found 'sed', .* did you mean seed\?"):
        cs.diagnose_folder(paths, out, sed=1)
    with pytest.raises(cs.InputError, match="tolerance_deg: found -1, expected"):
        cs.diagnose_folder(paths, out, tolerance_deg=-1)
    with pytest.raises(cs.InputError, match="seed: found -1, expected"):
        cs.diagnose_folder(paths, out, seed=-1)
    with pytest.raises(cs.InputError, match=r"without: found 'crep'.*creep"):
        cs.diagnose_folder(paths, out, without=["crep"])
    with pytest.raises(cs.InputError, match="full: found 'no', expected bool"):
        cs.diagnose_folder(paths, out, full="no")  # type: ignore[arg-type]
    with pytest.raises(cs.InputError, match="drive: found 'reference-87', expected Drive"):
        cs.diagnose_folder(paths, out, drive="reference-87")  # type: ignore[arg-type]
    assert not out.exists()


def test_a_file_that_is_not_there_is_said_to_be(tmp_path: Path) -> None:
    missing = tmp_path / "gone.csv"
    (row,) = cs.diagnose_folder([missing], tmp_path / "out").table.to_dicts()
    assert row["reason"] == f"{missing}: no such file"


def test_an_error_of_the_program_is_logged_with_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fails(*_: object, **__: object) -> None:
        raise KeyError("loop")

    write_loop(tmp_path / "loop.csv", 0.5, 25.0, 1)
    monkeypatch.setattr("cyclosweep.diagnosis.folder.diagnose", fails)
    (row,) = cs.diagnose_folder([tmp_path / "loop.csv"], tmp_path / "out").table.to_dicts()
    assert row["reason"] == "KeyError: 'loop'"
    (logged,) = [each for each in caplog.records if each.exc_info]
    assert "loop.csv" in logged.getMessage()
    caplog.clear()
    cs.diagnose_folder([tmp_path / "gone.csv"], tmp_path / "out")
    assert not [each for each in caplog.records if each.exc_info]


def test_the_seed_reaches_the_orders_by_which_trends_are_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seeds: list[int] = []

    def asked(*given: object) -> list[object]:
        seeds.append(given[2] if len(given) > 2 else 0)  # type: ignore[arg-type]
        return []

    monkeypatch.setattr("cyclosweep.diagnosis.folder.trends", asked)
    cs.diagnose_folder([tmp_path / "gone.csv"], tmp_path / "out", seed=7)
    assert seeds == [7]


def test_a_bad_file_keeps_its_row_and_does_not_stop_the_rest(folder: Path) -> None:
    out = folder.parent / "out"
    said: list[str] = []
    series = cs.diagnose_folder(
        folder, out, meta=folder.parent / "how.toml", full=False, progress=said.append
    )
    assert series.table.height == 7
    assert series.failed == 1
    broken = series.table.filter(pl.col("recording") == "broken").to_dicts()[0]
    assert "conditions_from_name" in broken["reason"]
    assert pl.read_parquet(out / "table.parquet").equals(series.table)
    assert pl.read_csv(out / "table.csv").columns == series.table.columns
    assert "Not diagnosed" in (out / "index.html").read_text(encoding="utf-8")
    assert len(said) == 7
    by_measure = {trend.measure: trend for trend in series.trends}
    friction, play = by_measure["friction_nm"], by_measure["play_deg"]
    assert (friction.rising, friction.pairs) == (12, 12)
    assert (play.rising, play.pairs) == (0, 12)
    assert "12 of 12 pairs" in friction.text
    assert [round(level.mean, 1) for level in friction.levels] == [0.5, 0.7, 0.9]
    interval = friction.levels[0].ci95
    assert interval is not None
    assert interval[0] < friction.levels[0].mean < interval[1]
    # What is done is kept; what is changed is done again.
    kept = {path: path.stat().st_mtime_ns for path in out.glob("*/diagnosis.json")}
    write_loop(folder / "dose3_repeat2.csv", 0.9, 24.0, 99)
    again = cs.diagnose_folder(folder, out, meta=folder.parent / "how.toml", full=False)
    changed = [p.parent.name for p, t in kept.items() if p.stat().st_mtime_ns != t]
    assert changed == ["dose3_repeat2"]
    assert again.table.height == 7


def test_two_workers_give_the_table_of_one(folder: Path) -> None:
    for path in folder.glob("dose[23]*"):
        path.unlink()
    how = folder.parent / "how.toml"
    one = cs.diagnose_folder(folder, folder.parent / "a", meta=how, full=False)
    two = cs.diagnose_folder(folder, folder.parent / "b", meta=how, full=False, workers=2)
    assert one.table.equals(two.table)
    links = re.findall('href="([^"]+/[^"]+)"', (folder.parent / "a" / "index.html").read_text())
    assert len(links) == one.table["verdict"].count()
    assert all((folder.parent / "a" / unquote(link)).is_file() for link in links)


def test_the_command_names_what_has_no_diagnosis(folder: Path) -> None:
    for path in folder.glob("dose[23]*"):
        path.unlink()
    command = [sys.executable, "-m", "cyclosweep", "diagnose", str(folder), "--quick", "--json"]
    command += ["--meta", str(folder.parent / "how.toml"), "--out", str(folder.parent / "out")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "1 of 3 recordings have no diagnosis" in done.stderr
    found = json.loads(done.stdout)
    assert len(found["table"]) == 3
    assert found["trends"] == []


def test_nothing_rises_by_chance() -> None:
    rng = np.random.default_rng(0)
    false = 0
    for _ in range(40):
        rows = [
            {"dose": float(k // 3), "friction_nm": rng.normal(), "play_deg": rng.normal()}
            for k in range(12)
        ]
        false += any(trend.p_value <= 0.05 for trend in trends(rows, ["dose"]))
    assert false <= 6  # one in twenty is expected


def test_a_name_of_another_form_is_said() -> None:
    meta = Metadata(conditions_from_name="(?P<step>[0-9])pre", conditions={"grease": "NLGI 2"})
    assert conditions_of("conic_2pre6", meta) == {"step": 2.0, "grease": "NLGI 2"}
    with pytest.raises(cs.InputError, match="conditions_from_name"):
        conditions_of("base", meta)
    with pytest.raises(ValueError, match="named groups"):
        Metadata(conditions_from_name="[0-9]pre")


@pytest.mark.skipif(not PRELOAD.is_dir(), reason="the measured files are not here")
def test_the_measured_preload_series_is_in_the_makers_order() -> None:
    meta = Metadata.read(EXAMPLE / "preload-series.toml")
    rows = []
    for path in sorted(PRELOAD.glob("*.csv.gz")):
        recording = cs.Recording.read(path, EXAMPLE / "preload-series.toml")
        lines = straight_lines(recording)
        rows.append(
            {
                **conditions_of(path.name, meta),
                "friction_nm": float(np.mean([line.friction_nm for line in lines])),
                "play_deg": float(np.mean([line.play_deg for line in lines])),
                **small_loops_of(path, meta, EXAMPLE / "preload-series.toml"),
            }
        )
    found = {
        (trend.condition, trend.measure): trend
        for trend in trends(rows, ["preload_step", "mesh_position"])
    }
    friction = found["preload_step", "friction_nm"]
    play = found["preload_step", "play_deg"]
    assert "Friction rises with preload step" in friction.text
    assert "Play falls with preload step" in play.text
    assert [level.mean for level in friction.levels] == sorted(x.mean for x in friction.levels)
    # Steps 1 and 2 differ by less than their intervals; from there on each step takes play away.
    assert play.levels[1].mean > play.levels[2].mean > play.levels[3].mean
    assert play.levels[0].mean == pytest.approx(play.levels[1].mean, abs=0.05)
    assert all(level.ci95 is not None for level in (*friction.levels, *play.levels))
    # The makers read their play from the small ramps: there every step takes some away.
    lost = found["preload_step", "lost_motion_deg"]
    assert "Lost motion falls with preload step" in lost.text
    means = [level.mean for level in lost.levels]
    assert means == sorted(means, reverse=True)


def test_small_loops_are_read_for_lost_motion_and_nothing_else(tmp_path: Path) -> None:
    wave = np.sin(np.linspace(0, 2 * np.pi, 200))
    rows = ["torque_nm,angle_deg,run"]
    for run, top in ((0, 2.0), (1, 2.0), (2, 30.0)):
        torque = top * wave
        angle = 0.1 * torque + 0.4 * np.sign(torque)
        rows += [f"{t:.6f},{a:.6f},{run}" for t, a in zip(torque, angle, strict=True)]
    path = tmp_path / "loop.csv"
    write_text(path, "\n".join(rows))
    meta = Metadata.model_validate(
        {"side": "output", "select": {"run": [2]}, "holdout_runs": [2], "lost_motion_runs": [0, 1]}
    )
    row = small_loops_of(path, meta, None)
    assert row["lost_motion_torque_nm"] == pytest.approx(2.0, abs=1e-3)
    # From one end to the other: twice the flank's 0.2 deg, less the end's width, and the play.
    assert row["lost_motion_deg"] == pytest.approx(2 * (0.4 + 0.1 * 1.95), abs=0.02)
    assert row["lost_motion_deg_low"] <= row["lost_motion_deg"] <= row["lost_motion_deg_high"]
    assert small_loops_of(path, Metadata(), None) == {}
    with pytest.raises(cs.InputError, match="no row"):
        small_loops_of(path, meta.model_copy(update={"lost_motion_runs": [7]}), None)


def few(*values: float, width: float = 0.1) -> list[dict[str, float | str]]:
    return [
        {"dose": float(k), "friction_nm": v, "friction_nm_low": v - width,
         "friction_nm_high": v + width}
        for k, v in enumerate(values)
    ]  # fmt: skip


def test_three_or_four_recordings_say_their_order_and_no_trend() -> None:
    (rising,) = trends(few(6.87, 7.20, 7.80, 8.27), ["dose"])
    assert rising.text.startswith("Friction rises with dose from each recording to the next, 6.87 ")
    assert "order 4 recordings so in 8.3 % of cases" in rising.text
    assert "intervals of the first and the last lie apart" in rising.text
    assert "4 recordings are too few to state a trend: 6 or more are needed" in rising.text
    (wide,) = trends(few(6.87, 7.20, 7.80, width=2.0), ["dose"])
    assert "intervals of the first and the last overlap" in wide.text
    assert "33 % of cases" in wide.text
    (mixed,) = trends(few(6.87, 7.80, 7.20, 6.5), ["dose"])
    assert "Friction neither rises nor falls throughout with dose" in mixed.text
    bare = [{"dose": row["dose"], "friction_nm": row["friction_nm"]} for row in few(3, 2, 1)]
    (falling,) = trends(bare, ["dose"])
    assert "falls with dose" in falling.text
    assert "no intervals to compare" in falling.text
    assert trends(few(1.0, 2.0), ["dose"]) == []


def row(name: str, **values: object) -> dict[str, object]:
    return {"recording": name, "status": "ok", "verdict": "UNKNOWN_PHYSICS", "effects": "creep",
            "side": "output", "friction_nm": 4.5, "play_deg": 3.07} | values  # fmt: skip


def page_of(tmp_path: Path, rows: list[dict[str, object]]) -> str:
    write_series_page(tmp_path / "index.html", rows, [], [])
    return (tmp_path / "index.html").read_text("utf-8")


def test_the_page_says_verdicts_in_words_and_what_to_check(tmp_path: Path) -> None:
    text = page_of(tmp_path, [row("a", remarks="the compliance is 2.54 times"), row("b")])
    assert "Known effects found, and something without a name" in text
    assert "UNKNOWN_PHYSICS" not in text
    assert "<h2>Check first</h2><ul><li>A: the compliance is 2.54 times</li></ul>" in text
    assert "<h2>Every recording</h2>" in text


def test_a_measure_that_nobody_has_makes_no_column(tmp_path: Path) -> None:
    text = page_of(tmp_path, [row("a"), row("b")])
    assert "lost motion" not in text
    assert "()" not in text
    assert "lost motion (deg)" in page_of(tmp_path, [row("a", lost_motion_deg=0.5)])


def test_recordings_at_the_input_stand_apart_with_how_they_were_read(tmp_path: Path) -> None:
    by_hand = row("lever", side="input", read_by="calibrated model", friction_nm=None)
    none = row("stuck", not_read="friction hides play and stiffness", play_deg=None)
    text = page_of(tmp_path, [row("a"), by_hand, none])
    output, other = (text.index(f"Measured at the {side} shaft") for side in ("output", "input"))
    assert output < text.index(">a<") < other < text.index(">lever<")
    assert "Lever: play and compliance are those of the calibrated model, with the" in text
    assert "Stuck: a value is missing because friction hides play and stiffness" in text


def test_names_in_the_terminal_are_not_broken() -> None:
    names = [f"2024-07-12__14-07-4{k}__torqueramp__conic_{k}pre1" for k in range(3)]
    assert shortened(names, 60) == names
    short = shortened(names, 36)
    assert short == [f"…4{k}__torqueramp__conic_{k}pre1" for k in range(3)] or all(
        len(each) <= 36 and each.endswith("pre1") for each in short
    )
    assert shortened(["alone_and_much_too_long"], 5) == ["alone_and_much_too_long"]


@pytest.mark.parametrize("width", [40, 50, 60, 80, 120])
def test_the_table_of_a_folder_fits_its_terminal_and_breaks_no_word(width: int) -> None:
    headings = ["recording", "lubricant", "verdict", "play (deg)", "compliance (deg/(N m))"]
    row = ["a_long_name", "NLGI 2", "Cause identified", "56.1", "2.69"]
    stream = io.StringIO()
    table = _FolderTable(headings, [row, ["b", *row[1:]]], set(headings[:3]))
    Console(file=stream, width=width, color_system=None).print(table)
    text = stream.getvalue()
    assert max(len(line.rstrip()) for line in text.splitlines()) <= width
    assert "…" not in text
    for word in " ".join([*headings[1:], *row]).split():
        assert word in text


def test_tables_are_as_wide_as_columns_says_and_120_without_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for columns, width in (("50", 50), (None, 120)):
        if columns is None:
            monkeypatch.delenv("COLUMNS", raising=False)
        else:
            monkeypatch.setenv("COLUMNS", columns)
        print_tables([Rule(characters="-")], any_width=True)
        assert len(capsys.readouterr().out.strip()) == width


def test_the_page_shows_no_play_below_zero(tmp_path: Path) -> None:
    text = page_of(tmp_path, [row("a", play_deg=-0.05, play_deg_low=-0.13, play_deg_high=0.02)])
    assert "0 (0 … 0.02)" in text
    assert "0.13" not in text
