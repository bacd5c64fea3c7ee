"""Measured loops: read as they are, turned into a null, and with effects laid over them."""

import gzip
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cyclosweep_challenge.measured.loops import (
    INJECTABLE,
    as_template,
    injected,
    left_over,
    one_after_the_other,
    read_loops,
    repeated_null,
    repeated_nulls,
    repeats,
    signature,
    with_angle,
    write_loops,
)
from cyclosweep_challenge.measured.run import doubts, run_measured
from cyclosweep_challenge.record.real import real_drive
from cyclosweep_challenge.runner.work import Options

STAND_IN = Path(__file__).parent / "stand_in.py"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Ramps like the measured ones: a line with play, three rows a clock tick."""
    rng = np.random.default_rng(1)
    target = tmp_path / "loops" / "2024__torqueramp__base_runin1.csv.gz"
    target.parent.mkdir()
    with gzip.open(target, "wt", encoding="utf-8-sig") as out:
        out.write("TIME,POSITION,TORQUE,CONTROL_TORQUE,Q_CURRENT,FAULT,test_nr\n")
        clock = 0.0
        for ramp in (0, 100, 101, 102):
            top = 4.0 if ramp == 0 else 40.0
            for command in top * np.sin(np.linspace(0.0, 2.0 * np.pi, 300)):
                clock += 0.015
                torque = np.clip(command, -25.0, 25.0)
                angle = np.sign(torque) + 0.1 * torque + 0.002 * rng.normal()
                for _ in range(3):
                    out.write(f"{clock},{angle / 360.0},{torque},{command},0,0,{ramp}\n")
    return target


def test_reads_ticks_of_large_ramps_and_marks_those_beyond_the_current_limit(file: Path) -> None:
    loops = read_loops(file)
    assert set(loops.run) == {100, 101, 102}
    assert np.abs(loops.torque_nm[loops.counts]).max() <= 24.0 < np.abs(loops.torque_nm).max()
    assert np.all(np.diff(loops.time_s) > 0.0)
    assert np.abs(loops.angle_deg[loops.counts]).max() == pytest.approx(3.4, abs=0.05)


def test_null_has_the_noise_of_one_repeat_and_nothing_else(file: Path) -> None:
    null = repeated_null(read_loops(file))
    columns = np.column_stack(
        [np.ones_like(null.torque_nm), np.sign(null.torque_nm), null.torque_nm]
    )
    left = null.angle_deg - columns @ np.linalg.lstsq(columns, null.angle_deg)[0]
    assert np.std(left) == pytest.approx(0.002, rel=0.15)
    assert np.abs(null.torque_nm).min() >= 3.0


@pytest.mark.parametrize("name", INJECTABLE)
def test_injected_size_is_what_a_calibration_leaves(name: str, file: Path) -> None:
    loops = read_loops(file)
    change = injected(loops, name, 0.3, np.random.default_rng(3)).angle_deg - loops.angle_deg
    assert np.sqrt(np.mean(left_over(loops, change) ** 2)) == pytest.approx(0.3, rel=1e-6)


def test_other_effects_are_refused(file: Path) -> None:
    with pytest.raises(ValueError, match="creep"):
        signature("creep", read_loops(file), np.random.default_rng(1))


def test_written_loops_say_how_to_read_them(file: Path, tmp_path: Path) -> None:
    write_loops(read_loops(file), tmp_path / "a", "thirteen.toml", (100,), (102,))
    text = (tmp_path / "a" / "recording.toml").read_text()
    assert 'side = "output"' in text
    assert "conditioning_runs = [100]" in text
    assert "holdout_runs = [102]" in text
    # A programme is predicted whole, what was held out with it.
    assert "holdout" not in (tmp_path / "a" / "program.toml").read_text()
    # A prediction sees no drive file.
    assert "drive" not in (tmp_path / "a" / "program.toml").read_text()


def test_nulls_of_a_file_come_in_both_orders_and_by_flank(file: Path) -> None:
    nulls = dict(repeated_nulls(file))
    assert [n.split(" ramps ")[1] for n in nulls] == [
        f"{pair}{side}"
        for pair in ("101 and 102", "102 and 101")
        for side in ("", ", positive flank", ", negative flank")
    ]
    there, back = nulls["large ramps 101 and 102"], nulls["large ramps 102 and 101"]
    noise = [left_over(x, x.angle_deg) for x in (there, back)]
    assert np.corrcoef(noise[0], noise[1])[0, 1] < -0.9
    assert np.all(nulls["large ramps 101 and 102, negative flank"].torque_nm < 0.0)


def test_a_ramp_predicts_its_own_kind(file: Path) -> None:
    loops = read_loops(file)
    second = loops.only(102)
    error = as_template(loops.only(101), second) - second.angle_deg
    loaded = np.abs(second.torque_nm) > 1.0
    assert np.sqrt(np.mean(error[loaded] ** 2)) < 0.02


def test_two_files_as_one_recording_share_no_run_and_no_datum(file: Path) -> None:
    loops = read_loops(file)
    joined = one_after_the_other(loops, with_angle(loops, loops.angle_deg + 7.0))
    assert set(joined.run) == {100, 101, 102, 200, 201, 202}
    assert np.all(np.diff(joined.time_s) > 0.0)
    assert joined.angle_deg.max() < 4.0


def test_whole_run_with_a_stand_in_and_none_without_data(file: Path, tmp_path: Path) -> None:
    drive = tmp_path / "thirteen.toml"
    drive.write_text('name = "thirteen"\n')
    options = Options(program=(sys.executable, str(STAND_IN)))
    rows = run_measured(file.parent, tmp_path / "out", drive, sizes_deg=(0.3,), options=options)
    kinds = [row.kind for row in rows]
    assert kinds[:2] == ["both ramps", "predicted"]
    assert kinds.count("repeated loops") == 6
    assert [row.detail for row in rows if row.kind == "effect injected"] == list(INJECTABLE)
    assert all(row.verdict != "FAILURE" for row in rows)
    assert (tmp_path / "out" / "measured.json").exists()
    page = real_drive(json.loads((tmp_path / "out" / "measured.json").read_text()))
    assert "### Repeated loops" in page
    assert run_measured(tmp_path / "nowhere", tmp_path / "none", drive) == []
    assert "were not there" in real_drive([])


@pytest.mark.parametrize(
    ("diagnosis", "good"),
    [
        ({"verdict": "IDENTIFIED", "effects": [{"name": "creep"}]}, False),
        ({"verdict": "UNKNOWN_PHYSICS", "effects": [{"name": "creep"}]}, True),
        ({"verdict": "AMBIGUOUS", "effects": [{"name": "thermal_drift"}]}, False),
        ({"verdict": "UNKNOWN_PHYSICS", "stationary": False}, True),
        ({"verdict": "INSUFFICIENT_DATA"}, False),
        ({"failure": "exit status 1"}, False),
    ],
)
def test_confounded_causes_are_answered_right_by_doubt(
    diagnosis: dict[str, Any], good: bool
) -> None:
    assert doubts(diagnosis) is good


@pytest.mark.shared
def test_all_real_files_repeat_but_the_one_that_drifts(shared_recordings: Path) -> None:
    files = sorted((shared_recordings / "cycloidal-13-to-1").glob("*.csv.gz"))
    assert len(files) == 5
    for path in files:
        null = repeated_null(read_loops(path))
        assert null.torque_nm.size > 400
        assert repeats(null) is ("910_unr_runin1" not in path.name)
