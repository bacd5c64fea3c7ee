"""Objects are one short line as text, a small table in a notebook, and come back from JSON."""

from __future__ import annotations

import copy
import itertools
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cyclosweep as cs
from cyclosweep.notebook import html_table
from cyclosweep.simulation.model import EffectValue
from cyclosweep.sweep.leaders import Leaders
from cyclosweep.sweep.summary import PartSummary, Summary

DRIVE = cs.Drive.reference_87()
SPACE = cs.Space.grid(
    DRIVE,
    eccentricity_mm=cs.linspace(0.3, 0.8, 3),
    output_pin_count=[6, 8, 9],
    criterion=["inside", "statics"],
)
STUDY = cs.Study.of(
    SPACE, limits={"hole_web_mm": (2.0, None)}, objective=cs.Objective("twist_1tn_deg")
)
MODEL = cs.Model(
    2.7,
    28.0,
    drive="reference-87",
    effects=(EffectValue("transmission_error", {"order_1": 1.0}, (0.3, 0.1)),),
)
LONGEST = 200
"""Characters of a representation: two lines of a terminal."""


@pytest.fixture(scope="module")
def found() -> cs.Diagnosis:
    """A diagnosis of a made loop."""
    rng = np.random.default_rng(3)
    ends = (0.4, 20.0, -20.0, 20.0, 0.4)
    torque = np.concatenate([np.linspace(a, b, 200) for a, b in itertools.pairwise(ends)])
    load = cs.Recording.from_arrays(torque, name="loop")
    angle = cs.simulate(cs.Model(2.728, 28.0), load).angle_deg
    assert angle is not None
    bent = angle + 0.01 * torque * abs(torque) + 0.3 * rng.standard_normal(len(torque))
    return cs.diagnose(load.with_angle(bent), DRIVE, full=False)


@pytest.fixture(scope="module")
def summary(tmp_path_factory: pytest.TempPathFactory) -> Summary:
    """Summary of a small sweep."""
    return cs.sink(STUDY, tmp_path_factory.mktemp("study"))


def shown(value: Any) -> str:
    """Check one object's text and HTML, and return both."""
    text, page = repr(value), value._repr_html_()
    assert "\n" not in text
    assert len(text) <= LONGEST
    assert len(page) < 5_000
    return f"{text} {page}"


def test_space_and_study() -> None:
    both = shown(SPACE)
    for word in ("18 variants", "0.3 to 0.8, 3 steps", "6, 8, 9", "inside, statics", "grid"):
        assert word in both
    both = shown(STUDY)
    for word in ("hole_web_mm", "minimise twist_1tn_deg", "1, 2, 3, 4, 4.5 T_N", STUDY.hash[:12]):
        assert word in both


def test_a_space_too_large_for_len_is_shown() -> None:
    many = cs.linspace(0.3, 0.8, 2**31)
    assert "4,611,686,018,427,387,904" in shown(
        cs.Space.grid(DRIVE, eccentricity_mm=many, output_pin_diameter_mm=many)
    )


def test_a_long_axis_is_cut() -> None:
    text = shown(cs.Space.grid(DRIVE, free_play_deg=[float(k) for k in range(10_000)]))
    assert "0, 1, 2, 3, 4, 5, ... (10,000)" in text


def test_summary(summary: Summary) -> None:
    both = shown(summary)
    for word in ("18 variants", "100.0% ok", "minimise twist_1tn_deg"):
        assert word in both


def test_recording_and_model() -> None:
    load = cs.Recording.from_arrays([0.0, 5.0, -2.0], [28.0, 41.7, -30.0], name="loop")
    both = shown(load)
    for word in ("3 samples in 1 run", "-2 to 5 N m at the input", "loop"):
        assert word in both
    assert "programme of" in repr(load.with_angle(None))
    assert "0 samples" in shown(cs.Recording.from_arrays([]))
    both = shown(MODEL)
    for word in ("2.7 deg/(N m)", "28 deg", "transmission_error", "reference-87"):
        assert word in both


def test_diagnosis(found: cs.Diagnosis) -> None:
    both = shown(found)
    for word in (found.verdict, "loop", "noise", found.answer.effects[0].name):
        assert word in both
    for effect in found.answer.effects:
        assert f"{effect.name} {effect.size_deg.estimate:.3g} deg" in both


def test_text_of_others_is_no_markup() -> None:
    assert "<script>" not in html_table("<script>", {"<script>": "<script>"}, "<script>")


@pytest.mark.parametrize("value", [SPACE, STUDY, SPACE[2:5], MODEL], ids=repr)
def test_equal_copies_hash_equal(value: Any) -> None:
    hash(value.drive if value is MODEL else value)
    for other in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
        assert other == value


def test_other_spaces_and_studies_are_not_equal() -> None:
    assert SPACE[:5] != SPACE[:6]
    assert cs.Space.grid(DRIVE, eccentricity_mm=[0.3]) != SPACE
    assert cs.Study.of(SPACE) != STUDY
    assert {SPACE: 1}[
        cs.Space.grid(DRIVE, **{axis.name: _values(axis) for axis in SPACE.axes})
    ] == 1


def _values(axis: Any) -> Any:
    if axis.name == "criterion":
        return ["inside", "statics"]
    return cs.linspace(0.3, 0.8, 3) if axis.form == "linspace" else list(axis.numbers)


def test_a_used_study_pickles() -> None:
    cs.sweep(STUDY)
    other = pickle.loads(pickle.dumps(STUDY))
    assert other.hash == STUDY.hash
    assert cs.sweep(other).equals(cs.sweep(STUDY))


def test_a_recording_pickles_with_its_samples_read_only() -> None:
    load = cs.Recording.from_arrays([0.0, 5.0, -2.0], [28.0, 41.7, -30.0], time_s=[0, 1, 2])
    assert load.structure is not None
    for other in (pickle.loads(pickle.dumps(load)), copy.copy(load), copy.deepcopy(load)):
        assert other.to_frame().equals(load.to_frame())
        assert other.faults == load.faults
        assert not other.torque_nm.flags.writeable


def test_a_diagnosis_pickles(found: cs.Diagnosis) -> None:
    for other in (pickle.loads(pickle.dumps(found)), copy.copy(found), copy.deepcopy(found)):
        assert other.to_json() == found.to_json()
        assert other.model == found.model


def test_a_diagnosis_comes_back_from_its_json(found: cs.Diagnosis, tmp_path: Path) -> None:
    text = found.to_json()
    for source in (text, json.loads(text)):
        assert cs.Diagnosis.from_json(source).to_json() == text
    found.write(tmp_path, report=False)
    other = cs.Diagnosis.from_json(tmp_path / "diagnosis.json", recording=found.recording)
    assert other.to_json() == text
    assert other.model == found.model
    assert repr(other) == repr(found)
    other.report(tmp_path / "report.html")


def test_a_diagnosis_without_its_recording_has_no_report(
    found: cs.Diagnosis, tmp_path: Path
) -> None:
    other = cs.Diagnosis.from_json(found.to_json())
    with pytest.raises(cs.InputError, match="report: no recording"):
        other.report(tmp_path / "report.html")


def test_a_summary_comes_back_from_its_json(summary: Summary) -> None:
    content = summary.to_json()
    for source in (content, json.dumps(content)):
        assert Summary.from_json(source) == summary


names = st.sampled_from(["ok", "twist_1tn_deg", "a name"])
finite = st.floats(allow_nan=False, allow_infinity=False)
ranges = st.dictionaries(names, st.tuples(finite, finite))
best = st.lists(st.dictionaries(names, finite | st.integers() | names), max_size=3)


@given(
    st.integers(0, 2**63), st.dictionaries(names, st.integers(0)), ranges, best, st.none() | names
)
def test_every_summary_comes_back(
    rows: int, status: dict[str, int], ranges: Any, best: Any, objective: str | None
) -> None:
    whole = Summary(rows, status, ranges, best, objective)
    assert Summary.from_json(json.dumps(whole.to_json())) == whole
    part = PartSummary(0, rows, status, ranges, [Leaders("twist_1tn_deg", best)])
    assert PartSummary.from_json(json.loads(json.dumps(part.to_json()))) == part


@given(
    st.floats(1e-6, 1e6),
    st.floats(0.0, 1e6),
    st.sampled_from(["input", "output"]),
    st.text(max_size=5),
    st.lists(finite, min_size=2, max_size=2),
)
def test_every_model_comes_back(
    compliance: float, play: float, side: Any, drive: str, amplitudes: list[float]
) -> None:
    effect = EffectValue("transmission_error", {"order_1": 2.0}, tuple(amplitudes))
    model = cs.Model(compliance, play, side=side, drive=drive, effects=(effect,), notes=(drive,))
    assert cs.Model.from_json(model.to_json()) == model
    assert cs.Model.from_json(json.loads(model.to_json())) == model


@pytest.mark.parametrize("source", ["{", "[1]", "{}", "nowhere.json", 5, None, {"verdict": 3}])
@pytest.mark.parametrize("kind", [cs.Drive, cs.Model, cs.Diagnosis, Summary])
def test_what_is_no_such_json_is_one_line(kind: Any, source: Any) -> None:
    with pytest.raises(cs.InputError) as caught:
        kind.from_json(source)
    assert "\n" not in str(caught.value)
