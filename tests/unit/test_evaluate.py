"""Tables of designs: whatever their form, labels and order kept, each mistake one line."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from polars.testing import assert_frame_equal

import cyclosweep as cs
from cyclosweep.sweep.table_files import read_table, write_table

DRIVE = cs.Drive.reference_87()
DESIGNS = {"eccentricity_mm": [0.5, 0.9, 0.62], "output_pin_count": [6, 8, 9]}
FRAME = pl.DataFrame({"label": ["a", "Größe b", None], "price": [1.0, 2.0, 3.0], **DESIGNS})
WHOLE = cs.sweep(cs.Space.table(DRIVE, pl.DataFrame(DESIGNS)))


def command(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


RECORDS = np.array(
    list(zip(*DESIGNS.values(), strict=True)),
    dtype=[("eccentricity_mm", "f8"), ("output_pin_count", "i4")],
)


@pytest.mark.parametrize(
    "table",
    [
        DESIGNS,
        {name: np.array(values) for name, values in DESIGNS.items()},
        pd.DataFrame(DESIGNS),
        pd.DataFrame(DESIGNS).convert_dtypes(),
        pa.table(DESIGNS),
        pl.LazyFrame(DESIGNS),
        RECORDS,
        RECORDS.view(np.recarray),
        [dict(zip(DESIGNS, row, strict=True)) for row in zip(*DESIGNS.values(), strict=True)],
    ],
    ids=[
        "dict",
        "arrays",
        "pandas",
        "nullable",
        "pyarrow",
        "lazy",
        "structured",
        "records",
        "rows",
    ],
)
def test_a_space_of_any_table(table: Any) -> None:
    assert_frame_equal(cs.sweep(cs.Space.table(DRIVE, table)), WHOLE, check_exact=True)


@pytest.mark.parametrize(
    "table", [3, "a.csv", np.eye(2), {"eccentricity_mm": [1.0], "ratio": [3, 4]}]
)
def test_what_is_no_table(table: Any) -> None:
    with pytest.raises(cs.InputError, match=r"^frame: "):
        cs.Space.table(DRIVE, table)


def test_labels_order_and_reasons() -> None:
    found = cs.evaluate_table(DRIVE, FRAME)
    assert found.columns[:6] == [*FRAME.columns, "status", "reason"]
    assert_frame_equal(found.select(FRAME.columns[:2]), FRAME.select(FRAME.columns[:2]))
    assert_frame_equal(found.select(WHOLE.columns[1:]), WHOLE.drop("variant"), check_exact=True)
    reasons = found["reason"].to_list()
    assert reasons[0] is reasons[2] is None
    assert "eccentricity" in reasons[1]
    # Its own results, evaluated again, are what they were.
    assert_frame_equal(cs.evaluate_table(DRIVE, found), found, check_exact=True)


def test_a_label_with_the_name_of_a_result_is_said(caplog: pytest.LogCaptureFixture) -> None:
    labelled = FRAME.with_columns(pl.Series("status", ["ordered"] * FRAME.height))
    found = cs.evaluate_table(DRIVE, labelled)
    assert found["status"][0] == "ok"
    assert "status: replaced by the result" in caplog.text
    caplog.clear()
    cs.evaluate_table(DRIVE, found)
    assert "replaced" not in caplog.text


def test_pandas_text_and_missing_values_are_labels() -> None:
    table = pd.DataFrame({"label": ["a", None, "c"], **DESIGNS, "bush_wall_mm": [1.0, None, 2.0]})
    found = cs.evaluate_table(DRIVE, table)
    assert found["label"].to_list() == ["a", None, "c"]
    assert found["status"][1] in ("eccentricity_too_large_for_ring", "non_finite_input")


@pytest.mark.parametrize("read", [".csv", ".xlsx", ".parquet"])
@pytest.mark.parametrize("written", [".csv", ".xlsx", ".parquet"])
def test_the_command_reads_and_writes_every_format(tmp_path: Path, read: str, written: str) -> None:
    source, target = tmp_path / f"Entwürfe {read[1:]}{read}", tmp_path / f"out{written}"
    write_table(FRAME, source)
    run = command("evaluate", source, "--out", target)
    assert run.returncode == 0, run.stderr
    assert "price: no input of a drive, passed through" in run.stderr
    assert run.stdout.strip().endswith("2 ok, 1 eccentricity_too_large_for_ring")
    found = read_table(target)
    expected = cs.evaluate_table(DRIVE, FRAME)
    assert found.columns == expected.columns
    for name in ("label", "status", "reason"):
        assert found[name].cast(pl.String).to_list() == expected[name].cast(pl.String).to_list()
    for name in ("price", "twist_1tn_deg"):
        assert found[name].is_null().to_list() == expected[name].is_null().to_list()
        numbers = expected[name].drop_nulls().to_list()
        assert found[name].drop_nulls().to_list() == pytest.approx(numbers, rel=1e-15)


def test_the_command_takes_a_drive_and_a_base(tmp_path: Path) -> None:
    DRIVE.replace(name="mine", free_play_deg=5.0).to_toml(tmp_path / "mine.toml")
    run = command("evaluate", tmp_path / "mine.toml", "--out", tmp_path / "one.csv", "--json")
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout)["status"] == {"ok": 1}
    one = read_table(tmp_path / "one.csv")
    assert one["name"].to_list() == ["mine"]
    (tmp_path / "designs.csv").write_text("eccentricity_mm\n0.62\n")
    for base in ((), ("--drive", tmp_path / "mine.toml")):
        out = tmp_path / "out.csv"
        run = command("evaluate", tmp_path / "designs.csv", *base, "--loads", "2", "--out", out)
        assert run.returncode == 0, run.stderr
        drive = cs.Drive.load(base[1]) if base else DRIVE
        expected = drive.evaluate(loads_tn=(2.0,))["twist_2tn_deg"]
        assert read_table(out)["twist_2tn_deg"][0] == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            "eccentricity_mm,label\n0.5,a\n\nO.6,b\n",
            "row 4, eccentricity_mm: found 'O.6', expected a",
        ),
        ("label,eccentricty_mm\na,0.5\n", "eccentricty_mm: no such input of a drive, did you mean"),
        ("eccentricity_mm,criterion\n0.5,insid\n", "row 2, criterion: found 'insid', expected one"),
        ("label,cost\na,3\n", "table: no column is an input"),
        ("a,b\n1,2,3\n", "row 2: found 3 cells, expected 2"),
    ],
)
def test_a_mistake_is_one_line_and_leaves_the_results(
    tmp_path: Path, text: str, words: str
) -> None:
    (tmp_path / "designs.csv").write_text(text)
    out = tmp_path / "out.csv"
    out.write_text("before")
    run = command("evaluate", tmp_path / "designs.csv", "--out", out)
    assert run.returncode == 2
    assert len(run.stderr.strip().splitlines()) == 1
    assert words in run.stderr
    assert str(tmp_path / "designs.csv") in run.stderr
    assert out.read_text() == "before"


def test_an_ending_that_cannot_be_written_is_refused_before_work(tmp_path: Path) -> None:
    run = command("evaluate", "reference-87", "--out", tmp_path / "out.doc")
    assert (run.returncode, len(run.stderr.splitlines())) == (2, 1)
    assert ".csv, .xlsx or .parquet" in run.stderr


PLUGIN = """
import polars as pl
from cyclosweep import plugins

@plugins.column("pins_mm", needs=["output_pin_count", "output_pin_diameter_mm"], meaning="pins")
def pins(rows):
    return rows["output_pin_count"] * rows["output_pin_diameter_mm"]

@plugins.constraint("few_pins", needs=["output_pin_count"])
def few(rows):
    return rows["output_pin_count"] < 9
"""


@pytest.mark.parametrize("place", ["before", "after"])
@pytest.mark.parametrize("engine", ["threads", "processes"])
def test_a_plugin_s_columns_and_constraints(tmp_path: Path, place: str, engine: str) -> None:
    (tmp_path / "mine.py").write_text(PLUGIN)
    (tmp_path / "study.toml").write_text(
        "[axes]\noutput_pin_count = { values = [6, 8, 9] }\n[objective]\nminimise = 'pins_mm'\n"
    )
    plugin = ("--plugin", tmp_path / "mine.py")
    sweep = ("sweep", tmp_path / "study.toml", "--out", tmp_path / "out", "--engine", engine)
    run = command(*plugin, *sweep) if place == "before" else command(*sweep, *plugin)
    assert run.returncode == 0, run.stderr
    found = cs.scan_dataset(tmp_path / "out").collect()
    assert found["pins_mm"].to_list() == [96.0, 128.0, None]
    assert found["status"].to_list() == ["ok", "ok", "constraint_few_pins"]


@pytest.mark.parametrize(
    ("content", "words"),
    [(None, "No such file"), ("1 / 0", "ZeroDivisionError"), ("import nothing_there", "ModuleNot")],
)
def test_a_plugin_that_cannot_be_imported(tmp_path: Path, content: str | None, words: str) -> None:
    if content is not None:
        (tmp_path / "mine.py").write_text(content)
    run = command("validate", "--plugin", tmp_path / "mine.py")
    assert (run.returncode, len(run.stderr.strip().splitlines())) == (2, 1)
    assert words in run.stderr


HUGE = """
[axes]
eccentricity_mm = { from = 0.3, to = 0.8, steps = 100_000 }
free_play_deg = { from = 1, to = 9, steps = 100_000 }
output_pin_length_mm = { from = 20, to = 30, steps = 100_000 }
"""


def test_a_sweep_says_its_size_and_refuses_what_no_disk_holds(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(HUGE)
    program = (
        "import resource, sys; from cyclosweep.cli import main\n"
        "resource.setrlimit(resource.RLIMIT_AS, (4 * 2**30, 4 * 2**30))\n"
        "sys.argv[1:] = sys.argv[1:]; main()"
    )
    run = subprocess.run(
        [
            sys.executable,
            "-c",
            program,
            "sweep",
            str(tmp_path / "study.toml"),
            "--out",
            str(tmp_path / "o"),
        ],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
        stdin=subprocess.DEVNULL,
    )
    assert run.returncode == 2, run.stderr
    (refusal,) = run.stderr.strip().splitlines()
    assert "no room for 1,000,000,000,000,000 variants" in refusal
    assert not (tmp_path / "o").exists()
    few = command("sweep", tmp_path / "study.toml", "--out", tmp_path / "o", "--rows", 50_000)
    assert few.returncode == 0, few.stderr
    assert few.stderr.startswith("50,000 variants, about ")
    written = sum(path.stat().st_size for path in (tmp_path / "o").glob("part-*"))
    said = few.stderr.split("about ")[1].split(" and")[0]
    number, unit = said.split()
    assert 0.5 < float(number) * {"kB": 1e3, "MB": 1e6}[unit] / written < 2
    again = command("sweep", tmp_path / "study.toml", "--out", tmp_path / "o", "--rows", 50_000)
    assert again.stderr.startswith("0 variants, about 0 B")
