"""Cases of the second generator are what was asked for, and keep their answer to themselves."""

import json
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep_challenge.campaign.item import Foreign, Item
from cyclosweep_challenge.campaign.making import make_item
from cyclosweep_challenge.scoring.outcome import HeldOut, make_outcome
from cyclosweep_challenge.second_generator.case import Case, make_numbered, show_one
from cyclosweep_challenge.second_generator.command import write_set
from cyclosweep_challenge.second_generator.drive import (
    REFERENCE_COMPLIANCE_DEG_PER_NM,
    REFERENCE_RATED_NM,
)
from cyclosweep_challenge.second_generator.laws.catalogue import LAWS
from cyclosweep_challenge.second_generator.laws.law import Law
from cyclosweep_challenge.second_generator.laws.table import law_table, stranger_table
from cyclosweep_challenge.second_generator.recipes import SINGLE_D, TIERS

DOCS = Path(__file__).parents[3] / "docs" / "second-generator.md"
ROWS = 600


@pytest.mark.parametrize("tier", TIERS)
@pytest.mark.parametrize("number", [1, 2])
def test_a_case_follows_from_its_numbers_alone(tier: str, number: int) -> None:
    one, again = (make_numbered(tier, number, 5, ROWS) for _ in range(2))
    assert one.recording.equals(again.recording)
    assert one.program.equals(again.program)
    assert one.truth == again.truth
    assert not one.recording.equals(make_numbered(tier, number, 6, ROWS).recording)


@pytest.mark.parametrize("law", LAWS, ids=lambda w: f"{w.effect}-{w.name}")
def test_visibility_is_as_asked(law: Law) -> None:
    """Computed again from with and without, by ordinary least squares in white noise."""
    _, _, _, signature, free = show_one(law, 20.0, (8, 1), ROWS)
    left = signature - free @ np.linalg.lstsq(free, signature, rcond=None)[0]
    assert np.linalg.norm(left) / 0.2 == pytest.approx(20.0, rel=0.02)


def test_visibility_of_single_effects() -> None:
    asked = set()
    for number in range(9):
        cause = make_numbered("single", number, 2, ROWS).truth["causes"][0]
        nearest = min(SINGLE_D, key=lambda d: abs(d - cause["d"]))
        assert cause["d"] == pytest.approx(nearest, rel=0.02)
        asked.add(nearest)
    assert asked == set(SINGLE_D)


def loud(number: int) -> Case:
    return make_numbered("C8", number, 3, ROWS)


def test_loud_cases_are_loud_and_their_friction_is_of_real_size() -> None:
    families, counts = set(), set()
    for number in (0, 1, 2, 3, 4, 7):
        truth = loud(number).truth
        first = truth["causes"][0]
        assert 99.0 < first["d_alone"] < 3030.0
        assert all(c["d_alone"] > 14.8 for c in truth["causes"])
        if truth["friction_family"]:
            assert 0.005 <= first["amplitude"] <= 0.25
        families.add(truth["friction_family"])
        counts.add(len(truth["effects"]))
    assert families == {"library", "other", ""}
    assert counts == {1, 2, 3, 4}


def test_the_true_law_forecasts_the_unseen_programme() -> None:
    for number in range(4):
        truth = loud(number).truth
        if not any(c["unpredictable"] for c in truth["causes"]):
            assert truth["held_out_removed_by_truth"] > 0.9


def test_noise_is_as_correlated_as_stated() -> None:
    for number in range(6):
        case = make_numbered("nothing", number, 4)
        noise = case.truth["noise"]
        error = case.recording["angle_deg"].to_numpy() - case.clean_deg
        # Few independent values are left at a correlation of 0.99.
        assert error.std() == pytest.approx(case.truth["noise_rms_deg"], rel=0.3)
        if noise["resolution_deg"] == 0.0:
            found = np.corrcoef(error[1:], error[:-1])[0, 1]
            assert found == pytest.approx(noise["autocorrelation"], abs=0.06)


@pytest.mark.parametrize(("tier", "d"), [("nothing", 0.0), ("single", 20.0)])
def test_noise_of_the_torque_is_as_large_as_stated(tier: str, d: float) -> None:
    """The angle is that of the true torque; the torque that is read differs from it."""
    quiet, noisy = (
        make_item(Item("any", 4, Foreign(tier, 0.0, d, rich=True, torque_noise=ratio), 4, 3, 3000))
        for ratio in (0.0, 3.0)
    )
    noise = noisy.truth["noise"]
    assert noise["torque_noise_deg"] == pytest.approx(3.0 * noise["sigma_deg"])
    if tier == "nothing":
        assert isinstance(noisy, Case)
        difference = (noisy.recording["torque_nm"] - quiet.recording["torque_nm"]).to_numpy()
        expected = noise["torque_noise_deg"] / noisy.specimen.compliance_deg_per_nm
        assert np.std(difference) == pytest.approx(expected, rel=0.1)
        assert noisy.recording["angle_deg"].equals(quiet.recording["angle_deg"])
    for cause in noisy.truth["causes"]:
        assert cause["d"] == pytest.approx(d, rel=0.02)
        assert abs(cause["oracle_z"] - d) < 4.0


def test_a_test_that_knows_the_signature_sees_it_as_visible_as_stated() -> None:
    for number in range(6):
        for cause in make_numbered("single", number, 9, ROWS).truth["causes"]:
            assert abs(cause["oracle_z"] - cause["d"]) < 4.0


def test_answers_can_be_scored_as_those_of_the_first_generator() -> None:
    diagnosis = {"verdict": "IDENTIFIED", "effects": [{"name": "creep", "size_deg": {}}]}
    for tier in TIERS:
        truth = {"key": "case-000", **make_numbered(tier, 1, 1, ROWS).truth}
        outcome = make_outcome(truth, diagnosis, HeldOut())
        assert outcome.tier == tier
        assert outcome.effects == tuple(truth["effects"])


def test_few_readings_by_hand() -> None:
    for number in range(6):
        case = make_numbered("C9", number, 1)
        assert 12 <= len(case.recording) <= 60
        assert "time_s" not in case.recording.columns
        angle = case.recording["angle_deg"].to_numpy()
        assert np.allclose(angle / 0.5, np.round(angle / 0.5))


def test_strangers_and_deleted_effects_are_named_in_the_answer() -> None:
    for number in range(4):
        assert len(make_numbered("stranger", number, 1, ROWS).truth["aliens"]) == 1
        truth = make_numbered("deleted", number, 1, ROWS).truth
        assert truth["effects"] == [truth["removed"]]


def test_few_and_many_rows() -> None:
    assert 12 <= len(make_numbered("single", 0, 1, 20).recording) <= 20
    assert 19_000 < len(make_numbered("single", 3, 1, 20_000).recording) <= 20_000


def test_folder_is_read_by_the_package_and_holds_no_answer(tmp_path: Path) -> None:
    write_set("C8", 3, 2, tmp_path, ROWS)
    truth = json.loads((tmp_path / "truth.json").read_text())
    assert list(truth) == ["case-000", "case-001", "case-002"]
    allowed = {"recording.csv", "recording.toml", "program.csv", "program.toml", "drive.toml"}
    for key, answer in truth.items():
        assert {f.name for f in (tmp_path / key).iterdir()} <= allowed
        recording = cs.Recording.read(tmp_path / key / "recording.csv")
        assert not recording.faults
        rows = pl.read_csv(tmp_path / key / "recording.csv")
        assert len(rows) == answer["readings"]
        clean = pl.read_csv(tmp_path / "truth" / f"{key}-recording.csv")["clean_deg"]
        assert np.std((rows["angle_deg"] - clean).to_numpy()) == pytest.approx(
            answer["noise_rms_deg"], rel=0.1
        )
        assert len(pl.read_csv(tmp_path / key / "program.csv")) == len(
            pl.read_csv(tmp_path / "truth" / f"{key}-program.csv")
        )


def test_reference_drive_is_that_of_the_package() -> None:
    twist = cs.Drive.reference_87().evaluate()["twist_1tn_deg"]
    assert isinstance(twist, float)
    compliance = (twist - 28.0) / REFERENCE_RATED_NM
    assert compliance == pytest.approx(REFERENCE_COMPLIANCE_DEG_PER_NM, rel=1e-6)
    assert pytest.approx(7.2575, rel=1e-4) == REFERENCE_RATED_NM


def test_docs_list_every_law() -> None:
    text = DOCS.read_text()
    assert law_table() in text
    assert stranger_table() in text
