"""The commands for exploring a study: what they print, write and refuse."""

from __future__ import annotations

import json
from pathlib import Path

import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.cli import main

EXAMPLES = Path(__file__).parents[2] / "examples"
STUDY = """
[sample]
method = "sobol"
count = 512
[axes]
eccentricity_mm = { from = 0.3, to = 1.0 }
output_pin_diameter_mm = { from = 12, to = 22 }
[objective]
minimise = "twist_1tn_deg"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a study file and its sweep."""
    (tmp_path / "study.toml").write_text(STUDY)
    cs.sink(cs.Study.from_toml(tmp_path / "study.toml"), tmp_path / "Maße 1")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr("sys.argv", ["cyclosweep", *arguments])
    with pytest.raises(SystemExit) as caught:
        main()
    return int(caught.value.code or 0)


TOLERANCES = str(EXAMPLES / "tolerances-87.toml")


@pytest.mark.parametrize(
    ("arguments", "schema"),
    [
        (["nearest", "Maße 1", "--target", "twist_1tn_deg=60", "--rows", "3"], "nearest"),
        (["feasible", "Maße 1", "--limit", "hole_web_mm > 3"], "feasible"),
        (["feasible", "study.toml"], "feasible"),
        (["sensitivity", "Maße 1", "--results", "twist_1tn_deg"], "sensitivity"),
        (["sensitivity", "study.toml", "--results", "hole_web_mm", "--most-draws", "64"],
         "sensitivity"),
        (["robust", "Maße 1", "--tolerances", TOLERANCES, "--pieces", "64", "--candidates", "5"],
         "robust"),
        (["robust", "reference-87", "--tolerances", TOLERANCES, "--pieces", "64",
          "--maximise", "hole_web_mm"], "robust"),
        (["robust", "designs.csv", "--tolerances", TOLERANCES, "--pieces", "64",
          "--minimise", "twist_1tn_deg"], "robust"),
    ],
)  # fmt: skip
def test_each_prints_a_table_or_json_and_writes_a_table(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    schema: str,
) -> None:
    (folder / "designs.csv").write_text("label,eccentricity_mm\na,0.5\nb,0.6\n")
    if arguments[:2] == ["sensitivity", "study.toml"]:
        pytest.importorskip("SALib")
    assert run(monkeypatch, *arguments) == 0
    assert len(capsys.readouterr().out.splitlines()) > 4
    assert run(monkeypatch, *arguments, "--json", "--out", "table.csv") == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["schema"] == f"cyclosweep.{schema}/1"
    assert pl.read_csv("table.csv").height >= 1
    assert sorted(path.name for path in folder.iterdir()) == [
        "Maße 1", "designs.csv", "study.toml", "table.csv",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nearest", "Maße 1", "--target", "twist"], "--target: found 'twist', expected"),
        (["nearest", "Maße 1", "--target", "twist_1=3"], "no column twist_1"),
        (["feasible", "none"], "none"),
        (["feasible", "Maße 1", "--out", "x.doc"], "x.doc"),
        (["feasible", "Maße 1", "--out", "no/x.csv"], "a folder that exists"),
        (["sensitivity", "study.toml", "--limit", "hole_web_mm > 3"], "--limit: for the folder"),
        (["sensitivity", "study.toml", "--results", "twist"], "results: no column twist"),
        (["robust", "reference-87", "--tolerances", TOLERANCES], "no objective"),
        (["robust", "Maße 1", "--tolerances", "none.toml"], "none.toml"),
        (["best", "Maße 1", "--minimise", "nope"], "Maße 1: objective: no column nope"),
        (["sweep", "study.toml", "--out", "o", "--scheduler", "tcp://x"], "only for engine dask"),
        (["robust", "a.csv", "b.csv", "--tolerances", TOLERANCES], "expected one folder"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_bad_input_is_one_line_and_status_2(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    message: str,
) -> None:
    assert run(monkeypatch, *arguments) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("nope_mm = 0.01", "tolerances.nope_mm: no such input"),
        ("output_pin_count = 1", "tolerances.output_pin_count: a whole number or a word does not"),
    ],
)
def test_a_deviation_that_does_not_fit_names_the_tolerance_file(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    line: str,
    message: str,
) -> None:
    (folder / "wrong.toml").write_text(f"[tolerances]\n{line}\n")
    assert run(monkeypatch, "robust", "Maße 1", "--tolerances", "wrong.toml") == 2
    error = capsys.readouterr().err
    assert f"wrong.toml: {message}" in error
    assert error.count("\n") == 1


def test_answers_of_an_unfinished_study_say_so(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    cs.sink(cs.Study.from_toml("study.toml"), "part of it", rows_per_part=128)
    asked = (
        ["best"],
        ["nearest", "--target", "twist_1tn_deg=60"],
        ["feasible", "--json"],
        ["sensitivity", "--results", "twist_1tn_deg"],
        ["robust", "--tolerances", TOLERANCES, "--pieces", "8", "--candidates", "2"],
    )
    for lost, said in (
        (None, ""),
        ("part-000002.parquet", "the study is unfinished, the answer is of 384 of 512 variants\n"),
    ):
        if lost is not None:
            (folder / "part of it" / lost).unlink()
        for command, *options in asked:
            assert run(monkeypatch, command, "part of it", *options) == 0
            errors = capsys.readouterr().err
            assert errors == (f"cyclosweep: part of it: {said}" if said else ""), command


def test_pieces_have_to_keep_the_limits_of_the_study(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["--tolerances", TOLERANCES, "--pieces", "64", "--candidates", "3", "--json"]
    found = []
    for name, limits, options in (
        ("free", "", []),
        ("typed", "", ["--limit", "hole_web_mm > 6.345"]),
        ("own", "[limits]\nhole_web_mm = { min = 6.345 }\n", []),
    ):
        Path("study.toml").write_text(STUDY + limits)
        cs.sink(cs.Study.from_toml("study.toml"), name)
        assert run(monkeypatch, "robust", name, *asked, *options) == 0
        designs = json.loads(capsys.readouterr().out)["designs"]
        found.append([(each["variant"], each["share_ok"]) for each in designs])
    assert found[1] == found[2] != found[0]
    assert any(share < 1.0 for _, share in found[2])


def test_a_percentile_beyond_100_is_named_as_it_was_given(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--maximise", "hole_web_mm", "--tolerances", TOLERANCES, "--percentile", "120"]
    assert run(monkeypatch, "robust", "reference-87", *options) == 2
    assert "percentile: found 120, expected 0 to 100" in capsys.readouterr().err


def test_a_result_that_no_variant_has_says_nothing_of_the_draws(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("SALib")
    cs.Drive.reference_87().replace(input_inertia_kg_m2=None).to_toml(folder / "drive.toml")
    asked = ["--results", "natural_frequency_hz,hole_web_mm", "--most-draws", "64"]
    for highest, is_said in ((0.7, False), (1.0, True)):
        study = f'drive = "drive.toml"\n{STUDY}'.replace("to = 1.0", f"to = {highest}")
        Path("study.toml").write_text(study)
        assert run(monkeypatch, "sensitivity", "study.toml", *asked) == 0
        out = " ".join(capsys.readouterr().out.split())
        assert "natural_frequency_hz no variant has it" in out
        assert ("of the draws a variant cannot be built or has no hole_web_mm" in out) is is_said
        assert "100%" not in out
