"""The answer of a diagnosis for every verdict: all keys, the published schema, the files."""

import dataclasses
import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.result import Answer, answer_of
from cyclosweep.result.statement import statement_of
from tests.support.bench_rig import record
from tests.support.published_schema import check_content

ONLY_WHERE_THEY_APPLY = {"unknown", "drift", "change", "thinning", "play_and_stiffness"}
KEYS = {entry.name for entry in dataclasses.fields(Answer)} - ONLY_WHERE_THEY_APPLY


def straight(factor: float = 1.0, readings: int = 60, largest: float = 18.0) -> cs.Recording:
    """A loaded flank of the reference drive, read in some unit."""
    torque = np.linspace(0.5, largest, readings)
    return cs.Recording.from_arrays(torque, factor * (28 + 2.73 * torque), name="straight")


CASES: dict[str, tuple[cs.Recording, dict[str, Any], str]] = {
    "identified": (record(21, ("overload_softening",), d=25, kind="medium"), {}, "IDENTIFIED"),
    "ambiguous": (record(2, ("friction_hysteresis",), d=8, kind="poor"), {}, "AMBIGUOUS"),
    "unknown": (record(31, ("slip_event",), d=25, kind="medium"), {}, "UNKNOWN_PHYSICS"),
    "nothing missing": (record(11, kind="poor"), {}, "NOTHING_MISSING"),
    "not asked in full": (record(11, kind="poor"), {"full": False}, "NOTHING_MISSING"),
    "too noisy": (record(11, kind="poor"), {"tolerance_deg": 1e-3}, "INSUFFICIENT_DATA"),
    "too few": (straight(readings=5), {}, "INSUFFICIENT_DATA"),
    "wrong unit": (straight(factor=1000.0), {}, "DATA_FAULT"),
    "time runs back": (
        cs.Recording.from_arrays(np.arange(50.0), np.arange(50.0), time_s=np.arange(50.0)[::-1]),
        {},
        "DATA_FAULT",
    ),
}

REFUSED = ("too few", "wrong unit", "time runs back")


@cache
def found(case: str) -> cs.Diagnosis:
    recording, options, _ = CASES[case]
    return cs.diagnose(recording, cs.Drive.reference_87(), **options)


@pytest.mark.parametrize("case", CASES)
def test_every_verdict_keeps_the_schema_and_has_every_key(case: str) -> None:
    content = json.loads(found(case).to_json())
    assert content["verdict"] == CASES[case][2]
    check_content(content)
    assert set(content) - ONLY_WHERE_THEY_APPLY == KEYS
    assert ("unknown" in content) is (content["verdict"] == "UNKNOWN_PHYSICS")
    assert content["stationary"] is (None if case in REFUSED else True)


@pytest.mark.parametrize("case", ["identified", "ambiguous", "unknown", "nothing missing"])
def test_the_statement_follows_from_the_file_alone(case: str) -> None:
    answer = answer_of(json.loads(found(case).to_json()))
    assert statement_of(answer) == found(case).statement


@pytest.mark.parametrize("case", REFUSED)
def test_a_refusal_says_why_and_gives_no_model(case: str) -> None:
    refusal = found(case)
    assert refusal.model is None
    assert refusal.before_deg is refusal.after_deg is None
    assert refusal.content["undecided"] == refusal.content["findings"] == []
    assert refusal.content["stationary"] is None
    assert refusal.content["mismatch"]["evidence"] is None
    assert refusal.content["self_check"]["false_alarm"] is None
    program = refusal.content["next_experiment"]["program"]
    assert {
        "too few": "repeat the recording with more readings",
        "wrong unit": "correct unit, side or drive in the settings (the TOML file) or the drive",
        "time runs back": "look first at the column and unit of the time",
    }[case] in program
    # A wrong setting is no reason to go back to the rig.
    assert ("nothing has to be recorded anew" in program) is (case == "wrong unit")
    assert refusal.answer.do_now.lower().rstrip(".") == program.lower()
    assert refusal.statement.startswith(refusal.recording.name)


def test_what_was_not_asked_for_is_empty() -> None:
    content = found("not asked in full").content
    assert content["self_check"] == content["next_experiment"] == {}
    assert content["repaired"]["blocks"] == []
    assert found("nothing missing").content["self_check"]["twins"] > 0


def test_public_tables_are_plain_lists_and_dictionaries() -> None:
    identified = found("identified")
    (effect,) = identified.effects
    assert effect["name"] == "overload_softening"
    assert effect["size_deg"]["ci95"][0] < effect["size_deg"]["estimate"]
    p_value = identified.mismatch["regions"][0]["p_value"]
    assert p_value is not None
    assert p_value <= 0.05
    assert identified.content == json.loads(identified.to_json())


def test_every_effect_of_the_library_fared_somehow() -> None:
    for case in ("identified", "nothing missing"):
        rows = found(case).hypotheses
        names = [row.name for row in rows]
        assert len(set(names)) == len(names)
        accepted = {row.name for row in rows if row.outcome == "accepted"}
        assert accepted == {effect["name"] for effect in found(case).effects}
        ruled_out = {row.name for row in rows if row.outcome == "ruled out"}
        assert ruled_out == {row["name"] for row in found(case).content["ruled_out"]}


def test_errors_on_data_not_used_weigh_up_to_those_of_the_whole() -> None:
    identified = found("identified")
    rows = identified.held_out
    assert [row.block for row in rows] == [
        b["block"] for b in identified.content["repaired"]["blocks"]
    ]
    samples = np.array([row.samples for row in rows])
    errors = np.array([row.rmse_after_deg for row in rows])
    whole = np.sqrt(np.average(errors**2, weights=samples))
    assert whole == pytest.approx(identified.content["repaired"]["holdout_rmse_deg"])


def test_the_folder_holds_the_whole_answer_and_nothing_half_written(tmp_path: Path) -> None:
    folder = found("identified").write(tmp_path / "out")
    assert {path.name for path in folder.iterdir()} == {
        "diagnosis.json", "model.json", "report.html",
    }  # fmt: skip
    content = json.loads((folder / "diagnosis.json").read_text("utf-8"))
    assert content == found("identified").content
    assert (folder / content["model"]).is_file()


def test_an_interrupted_write_leaves_the_answer_that_was_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found("too few").write(tmp_path)
    before = {path.name: path.read_text("utf-8") for path in tmp_path.iterdir()}
    whole = Path.write_text

    def half(path: Path, data: str, encoding: str | None = None) -> int:
        whole(path, data[: len(data) // 2], encoding=encoding)
        raise OSError("no space left on the disk")

    monkeypatch.setattr(Path, "write_text", half)
    with pytest.raises(OSError, match="no space"):
        found("identified").write(tmp_path)
    assert {path.name: path.read_text("utf-8") for path in tmp_path.iterdir()} == before


def test_a_model_of_a_recording_that_was_turned_round_says_so(tmp_path: Path) -> None:
    recording = straight()
    for sign in (1.0, -1.0):
        table = recording.to_frame().with_columns(pl.col("angle_deg") * sign)
        table.select("torque_nm", "angle_deg").write_csv(tmp_path / "loop.csv")
        read = cs.Recording.read(tmp_path / "loop.csv")
        model = cs.diagnose(read, cs.Drive.reference_87(), full=False).model
        assert model is not None
        assert any("the other sign" in note for note in model.notes) == (sign < 0)
