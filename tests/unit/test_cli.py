"""What a user types: exit statuses, one-line errors, nothing lost."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import cyclosweep as cs

STUDY = """
drive = "reference-87"
[sample]
method = "grid"
[axes]
eccentricity_mm = { from = 0.3, to = 0.8, steps = 50 }
output_pin_count = { values = [6, 8, 9] }
[objective]
minimise = "twist_1tn_deg"
"""


def run(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", *arguments],
        capture_output=True,
        text=True,
        cwd=cwd,
        check=False,
    )


@pytest.mark.parametrize(
    "arguments",
    [["show", "reference-87"], ["show", "reference-87", "--json"], ["--help"], ["--version"]],
)
def test_a_reader_that_has_ended_ends_the_program_quietly(arguments: list[str]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "cyclosweep", *arguments]
    try:
        result = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, check=False)
    finally:
        os.close(writer)
    assert (result.returncode, result.stderr) == (141, b"")


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    return path


def assert_one_line(result: subprocess.CompletedProcess[str], status: int, *words: str) -> None:
    assert result.returncode == status, result.stderr
    assert result.stdout == ""
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    for word in words:
        assert word in lines[0]


def test_sweep_writes_and_repeats(study: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    first = run("sweep", str(study), "--out", str(out), "--json")
    assert first.returncode == 0, first.stderr
    summary = json.loads(first.stdout)
    assert summary["rows"] == 150
    assert summary["status"] == {"ok": 150}
    assert len(summary["best"]) == 10
    again = run("sweep", str(study), "--out", str(out), "--json")
    assert json.loads(again.stdout) == summary
    best = cs.scan_dataset(out).sort("twist_1tn_deg").first().collect()
    assert best["variant"].item() == summary["best"][0]["variant"]


def test_rows_limits_the_study(study: Path, tmp_path: Path) -> None:
    result = run("sweep", str(study), "--out", str(tmp_path / "o"), "--rows", "7", "--json")
    assert json.loads(result.stdout)["rows"] == 7


def test_shards_make_up_the_sweep(study: Path, tmp_path: Path) -> None:
    for index in ("1", "0"):
        result = run(
            "shard", str(study), "--out", str(tmp_path / "s"), "--index", index, "--of", "2"
        )
        assert result.returncode == 0, result.stderr
    run("sweep", str(study), "--out", str(tmp_path / "w"))
    sharded = cs.scan_dataset(tmp_path / "s").collect()
    assert sharded.equals(cs.scan_dataset(tmp_path / "w").collect())


def test_a_task_beyond_the_parts_says_that_there_is_nothing_to_do(
    study: Path, tmp_path: Path
) -> None:
    for index, said in (
        ("0", ""),
        ("1", "cyclosweep: the study has 1 part: from task 1 on there is nothing to do\n"),
    ):
        result = run(
            "shard", str(study), "--out", str(tmp_path / "s"), "--index", index, "--of", "9"
        )
        assert result.returncode == 0
        assert result.stderr == said


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("eccentricity_mm = { from = 0.3, to = 'x', steps = 5 }", ("eccentricity_mm.to", "'x'")),
        (
            "excentricity_mm = { from = 0.3, to = 0.8, steps = 5 }",
            ("did you mean eccentricity_mm",),
        ),
        ("eccentricity_mm = { from = 0.3, to = 0.8 }", ("eccentricity_mm.steps", "missing")),
        ("eccentricity_mm = { values = [] }", ("eccentricity_mm.values",)),
        ("eccentricity_mm = { from = 0.3, to = 0.8, stepz = 5 }", ("stepz", "unknown key")),
        ("output_pin_count = { from = 6, to = 9, steps = 5 }", ("whole",)),
        ("eccentricity_mm = [", ("not valid TOML", "line")),
    ],
)
def test_a_wrong_study_is_one_line(tmp_path: Path, line: str, words: tuple[str, ...]) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(f"[axes]\n{line}\n")
    result = run("sweep", str(path), "--out", str(tmp_path / "out"))
    assert_one_line(result, 2, str(path), *words)
    assert not (tmp_path / "out").exists()


def test_a_file_of_another_kind_is_said_to_be_one(study: Path, tmp_path: Path) -> None:
    kinds = {
        "a study": study,
        "a drive file": tmp_path / "drive.toml",
        "an event": tmp_path / "event.toml",
        "metadata of a recording": tmp_path / "loop.toml",
        "tolerances": tmp_path / "tolerances.toml",
    }
    cs.Drive.reference_87().to_toml(kinds["a drive file"])
    kinds["an event"].write_text('kind = "reversal"\nduration_s = 0.3\n')
    kinds["metadata of a recording"].write_text('side = "input"\nhistory = "continuous"\n')
    kinds["tolerances"].write_text("[tolerances]\neccentricity_mm = 0.01\n")
    recording = tmp_path / "loop.csv"
    recording.write_text("torque_nm,angle_deg\n1,2\n")
    out = ("--out", str(tmp_path / "out"))
    asked = {
        "a study": ("sweep", "FILE", *out),
        "a drive file": ("show", "FILE"),
        "an event": ("shock", "reference-87", "FILE", *out),
        "metadata of a recording": ("diagnose", str(recording), "--meta", "FILE", *out),
    }
    for expected, command in asked.items():
        for kind, path in kinds.items():
            if kind != expected:
                found = run(*(str(path) if word == "FILE" else word for word in command))
                assert_one_line(found, 2, f"{path}: this is {kind}, expected {expected}")
    with pytest.raises(cs.InputError, match="this is a study, expected tolerances"):
        cs.Tolerances.from_toml(study)


def test_what_a_sweep_says_it_has_to_do_counts_broken_parts(study: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert "150 variants, about" in run("sweep", str(study), "--out", str(out)).stderr
    part = out / "part-000000.parquet"
    part.write_bytes(part.read_bytes()[:-50])
    assert "150 variants, about" in run("sweep", str(study), "--out", str(out)).stderr
    assert "0 variants, about" in run("sweep", str(study), "--out", str(out)).stderr


@pytest.mark.skipif(not Path("/proc/version").exists(), reason="there is no /proc here")
def test_a_folder_in_which_nothing_can_be_made_is_refused_at_once(tmp_path: Path) -> None:
    recording = tmp_path / "loop.csv"
    recording.write_text("torque_nm,angle_deg\n1,2\n")
    result = run("diagnose", str(recording), "--out", "/proc/diagnosed")
    assert_one_line(result, 2, "--out: found /proc, expected a folder that can be written to")


def test_a_wrong_drive_is_one_line(study: Path, tmp_path: Path) -> None:
    drive = tmp_path / "drive.toml"
    cs.Drive.reference_87().to_toml(drive)
    for old, new, words in (
        ("output_pin_diameter_mm = 16.0", "output_pin_diameter_mm = -16.0", ("-16.0", "greater")),
        ("output_pin_diameter_mm = 16.0", "output_pin_diameter_mm = '16'", ("'16'", "number")),
        ("output_pin_diameter_mm = 16.0", "", ("output_pin_diameter_mm", "missing")),
        ('kind = "frustum"', 'kind = "cone"', ("shaft.6", "cone", "frustum")),
    ):
        text = drive.read_text().replace(old, new)
        wrong = tmp_path / "wrong.toml"
        wrong.write_text(text)
        path = tmp_path / "s.toml"
        path.write_text(STUDY.replace("reference-87", "wrong.toml"))
        result = run("sweep", str(path), "--out", str(tmp_path / "out"))
        assert_one_line(result, 2, str(wrong), *words)
        assert_one_line(run("validate", "--drive", str(wrong)), 2, str(wrong), *words)


def test_another_study_in_the_folder_is_refused_untouched(study: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    run("sweep", str(study), "--out", str(out))
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    other = tmp_path / "other.toml"
    other.write_text(STUDY.replace("0.8", "0.7"))
    assert_one_line(run("sweep", str(other), "--out", str(out)), 2, str(out), "--fresh")
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    assert run("sweep", str(other), "--out", str(out), "--fresh").returncode == 0


def test_a_file_in_place_of_the_folder_is_refused(study: Path, tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("precious")
    assert_one_line(run("sweep", str(study), "--out", str(file)), 2, str(file), "folder")
    assert file.read_text() == "precious"


def test_validate_counts_what_is_decided(tmp_path: Path) -> None:
    result = run("validate", "--json")
    assert result.returncode == 0
    report = json.loads(result.stdout)
    assert report["ok"] is True
    facts = {fact["fact"]: fact for fact in report["facts"]}
    assert facts["nominal input torque T_N"]["computed"] == pytest.approx(7.2575, abs=5e-5)
    assert facts["overall efficiency"]["computed"] == pytest.approx(0.9265, abs=5e-5)
    assert report["sectors"]["reconstruction_ideal"] == [4, 6, 8, 8, 6, 8, 8, 6]
    assert report["sectors"]["reconstruction_ideal_mean"] == 0.84375 * 8
    line = facts["twist at 2.5 T_N, 75 to 80 deg"]
    assert line["mark"] == "assumed"
    assert 75 <= line["computed"] <= 80
    silent = facts["theory against experiment at 4 T_N, within"]
    assert (silent["computed"], silent["ok"]) == (None, None)
    assert silent["note"]


def test_a_broken_fact_fails_the_validation(tmp_path: Path) -> None:
    broken = tmp_path / "broken.toml"
    cs.Drive.reference_87().replace(input_power_kw=1.2).to_toml(broken)
    result = run("validate", "--drive", str(broken), "--json")
    assert result.returncode == 1
    failed = [f["fact"] for f in json.loads(result.stdout)["facts"] if f["ok"] is False]
    assert "nominal input torque T_N" in failed


def test_validate_says_what_counts_and_what_deliberate_errors_break() -> None:
    plain = run("validate", "--broken-models")
    assert plain.returncode == 0, plain.stderr
    assert plain.stdout.count("disagree and are explained, 0 disagree unexplained") == 2
    assert "Broken by none of them: fewest active pins, inside" in plain.stdout
    report = json.loads(run("validate", "--json", "--broken-models").stdout)
    assert report["counts"]["evidence"]["explained"] > 0
    counted = report["counted"]
    assert counted == ["evidence", "independent solution", "identity"]
    assert [report["counts"][kind]["fail"] for kind in counted] == [0, 0, 0]
    broken = {row["model"]: sum(row[k] for k in counted) for row in report["broken_models"]}
    assert broken["E halved"] > 0
    assert min(broken.values()) > 0
    assert report["sectors"]["published"] == [None, None, 8, None, None, None, None, None]
    assert report["sectors"]["ours"] == [4, 6, 8, 8, 6, 8, 8, 6]
    assert "broken_models" not in json.loads(run("validate", "--json").stdout)


def test_rows_that_do_not_count_do_not_decide(tmp_path: Path) -> None:
    soft = tmp_path / "soft.toml"
    cs.Drive.reference_87().replace(shaft_1_diameter_mm=40).to_toml(soft)
    shown = run("validate", "--drive", str(soft))
    assert "0 disagree unexplained" in shown.stdout
    assert "2 rows that do not count differ from the print: another drive." in shown.stdout
    assert shown.returncode == 0
    report = run("validate", "--drive", str(soft), "--json")
    assert report.returncode == 0
    content = json.loads(report.stdout)
    assert content["ok"] is True
    assert sum(fact["ok"] is False and not fact["counted"] for fact in content["facts"]) == 2


def test_a_failed_fact_without_a_number_is_still_json(tmp_path: Path) -> None:
    broken = tmp_path / "three-pins.toml"
    drive = cs.Drive.reference_87().replace(output_pin_count=3, input_power_kw=1.2)
    drive.to_toml(broken)
    result = run("validate", "--drive", str(broken), "--json")
    assert result.returncode == 1

    def refuse(constant: str) -> float:
        raise AssertionError(constant)

    json.loads(result.stdout, parse_constant=refuse)


def test_pictures_without_matplotlib_are_refused_before_the_diagnosis(tmp_path: Path) -> None:
    (tmp_path / "matplotlib.py").write_text("raise ImportError('not here')")
    (tmp_path / "loop.csv").write_text("torque_nm,angle_deg\n1,30\n2,33\n")
    done = run(
        "diagnose", "loop.csv", "--drive", "reference-87", "--out", "d", "--png", cwd=tmp_path
    )
    assert done.returncode == 2
    assert "pip install 'cyclosweep[report]'" in done.stderr
    assert not (tmp_path / "d").exists()


def test_simulate_takes_the_least_programme_and_spares_what_it_reads(tmp_path: Path) -> None:
    programme = tmp_path / "programme.csv"
    programme.write_text("torque_nm\n0\n7.2575\n")
    out = tmp_path / "out.csv"
    done = run("simulate", "reference-87", str(programme), "--out", str(out))
    assert done.returncode == 0
    assert done.stdout == f"Written: {out} (2 rows)\n"
    assert "angle_deg" in out.read_text()
    before = programme.read_text()
    refused = run("simulate", "reference-87", str(programme), "--out", str(programme))
    assert_one_line(refused, 2, str(programme))
    assert programme.read_text() == before
    nowhere = tmp_path / "nowhere" / "out.csv"
    assert_one_line(
        run("simulate", "reference-87", str(programme), "--out", str(nowhere)), 2, str(nowhere)
    )


def test_a_quick_diagnosis_writes_the_same_verdict_without_a_report(tmp_path: Path) -> None:
    from cyclosweep_challenge import make_case

    make_case(7, effects=("friction_hysteresis",), d=30, programme="poor", samples=400).write(
        tmp_path
    )
    quick = run("diagnose", "recording.csv", "--out", "quick", "--quick", cwd=tmp_path)
    whole = run("diagnose", "recording.csv", "--out", "whole", cwd=tmp_path)
    assert quick.returncode == whole.returncode == 0, quick.stderr + whole.stderr
    files = {
        name: sorted(p.name for p in (tmp_path / name).iterdir()) for name in ("quick", "whole")
    }
    assert files["quick"] == ["diagnosis.json", "model.json"]
    assert files["whole"] == ["diagnosis.json", "model.json", "report.html"]
    said = [json.loads((tmp_path / name / "diagnosis.json").read_text()) for name in files]
    for key in ("verdict", "mismatch", "explanation_set"):
        assert said[0][key] == said[1][key]
    for part in ("baseline", "repaired"):
        assert said[0][part]["holdout_rmse_deg"] is None, "nothing was held out"
        assert said[1][part]["holdout_rmse_deg"] > 0.0
    assert [effect["name"] for effect in said[0]["effects"]] == ["friction_hysteresis"]
    assert said[0]["effects"][0]["e_value"] is None, "1 would read as no evidence"
    assert said[1]["effects"][0]["e_value"] > 100
    assert "held-out error" in whole.stdout
    assert "held-out error" not in quick.stdout


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["sweep"], "STUDY.toml"),
        (["sweep", "study.toml", "--out", "x", "--rows", "0"], "--rows"),
        (["sweep", "study.toml", "--out", "x", "--engine", "steam"], "steam"),
        (["sweep", "study.toml", "--outt", "x"], "--outt"),
        (["swep"], "swep"),
    ],
)
def test_a_wrong_option_is_one_line(arguments: list[str], word: str) -> None:
    assert_one_line(run(*arguments), 2, word)


@pytest.mark.parametrize(
    ("cells", "option", "words"),
    [
        ("0,1\n2,3\n4,5", [], ("mine.csv: drive: missing", "--drive", "mine.toml")),
        (
            "0,\n2,\n4,",
            ["--drive", "reference-87"],
            ("mine.csv: column angle_deg: missing or without numbers",),
        ),
    ],
)
def test_what_a_recording_lacks_is_one_line(
    tmp_path: Path, cells: str, option: list[str], words: tuple[str, ...]
) -> None:
    (tmp_path / "mine.csv").write_text(f"torque_nm,angle_deg\n{cells}\n")
    found = run("diagnose", "mine.csv", *option, "--out", "out", cwd=tmp_path)
    assert_one_line(found, 2, *words)
    assert not (tmp_path / "out" / "diagnosis.json").exists()


def test_without_a_command_there_is_help() -> None:
    result = run()
    assert result.returncode == 0
    assert "sweep" in result.stdout


def test_other_rows_of_the_same_study_are_refused_by_name(study: Path, tmp_path: Path) -> None:
    out = str(tmp_path / "out")
    assert run("sweep", str(study), "--out", out, "--rows", "20").returncode == 0
    refused = run("sweep", str(study), "--out", out)
    assert_one_line(refused, 2, "0 to 19 of", "0 to 149 asked", "--fresh")


def test_a_challenge_without_its_package_says_what_to_install(tmp_path: Path) -> None:
    code = (
        "import sys; sys.modules['cyclosweep_challenge'] = None\n"
        "from cyclosweep.cli import main\n"
        "sys.argv = ['cyclosweep', 'challenge', '--cases', '1', '--seed', '1', '--out', 'c']\n"
        "main()"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert_one_line(result, 2, "cyclosweep_challenge", "pip install 'cyclosweep[challenge]'")


@pytest.mark.parametrize(
    "arguments",
    [
        ["diagnose", "loop.csv", "--drive", "reference-87"],
        ["challenge", "--cases", "1", "--seed", "1"],
    ],
)
def test_results_do_not_go_into_a_file(tmp_path: Path, arguments: list[str]) -> None:
    (tmp_path / "loop.csv").write_text("torque_nm,angle_deg\n1,30\n2,33\n")
    (tmp_path / "file").write_text("precious")
    result = run(*arguments, "--out", "file", cwd=tmp_path)
    assert_one_line(result, 2, "--out: found file", "expected a folder")
    assert (tmp_path / "file").read_text() == "precious"


def test_a_programme_that_is_a_folder_is_one_line(tmp_path: Path) -> None:
    result = run("simulate", "reference-87", ".", "--out", "out.csv", cwd=tmp_path)
    assert_one_line(result, 2, ".: is a folder, expected a file")


def test_a_study_nested_too_deeply_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "deep.toml"
    path.write_text("x = " + "[" * 3000)
    assert_one_line(run("sweep", str(path), "--out", str(tmp_path / "out")), 2, "too deeply")


def test_a_number_without_end_is_one_short_line(tmp_path: Path) -> None:
    path = tmp_path / "long.toml"
    for axis in (
        "{ values = [1" + "0" * 400 + "] }",
        "{ from = 0, to = 1, steps = 1" + "0" * 400 + "}",
    ):
        path.write_text(f"[axes]\neccentricity_mm = {axis}\n")
        result = run("sweep", str(path), "--out", str(tmp_path / "out"))
        assert_one_line(result, 2, "eccentricity_mm")
        assert len(result.stderr) < 300


def test_loads_in_both_directions(tmp_path: Path) -> None:
    path = tmp_path / "both.toml"
    path.write_text("loads_tn = [1, -2.5]\n" + STUDY)
    out = tmp_path / "out"
    result = run("sweep", str(path), "--out", str(out))
    assert result.returncode == 0, result.stderr
    assert {"twist_1tn_deg", "twist_minus_2p5tn_deg"} < set(
        cs.scan_dataset(out).collect_schema().names()
    )


@pytest.mark.parametrize("width", [40, 60, 75, 80, 120, 300])
def test_no_number_and_no_word_of_a_narrow_table_is_broken_or_lost(width: int) -> None:
    import io

    import polars as pl
    from rich.console import Console

    from cyclosweep.cli.frames import FrameTable

    names = [f"output_pin_circle_radius_{k}" for k in range(9)]
    columns = {"variant": [7, 11], **{name: [3.6245e5, -1.2345e-7 - k] for k, name in
               enumerate(names)}}  # fmt: skip
    text = io.StringIO()
    Console(file=text, width=width).print(FrameTable("numbers", pl.DataFrame(columns)))
    lines = text.getvalue().splitlines()
    assert max(map(len, lines)) <= width
    assert text.getvalue().count("3.6245e+05") == 9
    assert text.getvalue().count("circle_") == 9
    assert text.getvalue().count("numbers") == 1
    blocks = text.getvalue().count("variant")
    assert sum(line.split()[:1] == ["7"] for line in lines) == blocks
    assert (blocks == 1) == (width == 300)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ("diagnose", "loop.csv", "--drive", "reference-87", "--out", "file/sub"),
            "which is a file",
        ),
        (("sweep", "study.toml", "--out", "file/sub"), "which is a file"),
        (
            ("shard", "study.toml", "--index", "0", "--of", "2", "--out", "file/sub"),
            "which is a file",
        ),
        (("sweep", "study.toml", "--out", ""), "found '', expected the name of a folder"),
        (("shock", "reference-87", "event.toml", "--out", ""), "found '', expected the name of"),
        (("evaluate", "designs.csv", "--out", "designs.csv"), "which is read"),
        (("export", "reference-87", "--out", "none/x.dxf"), "a folder that exists"),
        (("torque-twist", "reference-87", "--out", "x.xlsx"), "ending in .csv"),
        (("show", "drive.txt"), "does not end in .toml"),
        (("show", "a" * 300 + ".toml"), "File name too long"),
    ],
)
def test_an_output_that_cannot_be_is_refused_before_anything_is_computed(
    arguments: tuple[str, ...], words: str, tmp_path: Path
) -> None:
    for name in ("file", "drive.txt"):
        (tmp_path / name).write_text("")
    (tmp_path / "designs.csv").write_text("eccentricity_mm\n0.5\n")
    (tmp_path / "study.toml").write_text(STUDY)
    (tmp_path / "event.toml").write_text('kind = "reversal"\n')
    found = run(*arguments, cwd=tmp_path)
    assert (found.returncode, found.stdout) == (2, "")
    assert words in found.stderr
    assert len(found.stderr.strip().splitlines()) == 1
    assert (tmp_path / "designs.csv").read_text() == "eccentricity_mm\n0.5\n"
