"""Recordings of the second generator in which an effect of the library passed for another cause.

They are of the record of seed 2900000, in which each of them had a false name.
"""

import json
from pathlib import Path

import pytest

import cyclosweep as cs
from cyclosweep_challenge.campaign.making import make_item
from cyclosweep_challenge.campaign.parts import parts

SEED = 2_900_000


def diagnosed(
    folder: Path, part: str, number: int, seed: int = SEED
) -> tuple[cs.Diagnosis, set[str]]:
    """Diagnosis of a recording of the record, the true cause left out where the answer says so.

    With the names of the effects at work.
    """
    (made,) = [each for each in parts(1.0) if each.name == part]
    case = make_item(made.plan(seed, number + 1, 3_000)[number])
    case.write(folder)
    without = [case.truth["removed"]] if case.truth.get("removed") else []
    recording = cs.Recording.read(folder / "recording.csv")
    return cs.diagnose(recording, full=False, without=without), set(case.truth["effects"])


def names(found: cs.Diagnosis) -> set[str]:
    """Names of the effects that a diagnosis finds."""
    return {effect["name"] for effect in found.effects}


@pytest.mark.parametrize(
    ("part", "number", "cause"),
    [
        # A dial that errs by a cosine alone; friction that opens with the load; scattered
        # clearances that close from no load on; five kinks.
        ("deleted", 6, "load_asymmetry"),
        ("deleted", 13, "friction_hysteresis"),
        ("deleted", 3, "contact_stiffening"),
        ("deleted", 29, "contact_stiffening"),
    ],
)
def test_a_cause_that_is_taken_out_has_no_false_name(
    part: str, number: int, cause: str, tmp_path: Path
) -> None:
    found, true = diagnosed(tmp_path, part, number)
    assert true == {cause}
    assert found.verdict == "UNKNOWN_PHYSICS"
    assert names(found) == set()
    # The model predicts better all the same.
    content = json.loads(found.to_json())
    assert content["repaired"]["rmse_deg"] < 0.95 * content["baseline"]["rmse_deg"]


def test_a_hum_is_no_transmission_error(tmp_path: Path) -> None:
    """A wave along a travel that nobody recorded explained four fifths of a second axis."""
    found, _ = diagnosed(tmp_path, "strangers", 3)
    assert found.verdict == "UNKNOWN_PHYSICS"
    assert names(found) == set()


def test_a_side_load_beside_friction_is_no_dial(tmp_path: Path) -> None:
    found, true = diagnosed(tmp_path, "foreign-loud", 34)
    assert (
        names(found)
        == true
        == {*("friction_hysteresis", "phase_dependent_compliance", "load_asymmetry")}
    )
    assert found.verdict == "IDENTIFIED"


def test_a_tilted_dial_is_no_side_load_with_a_softening(tmp_path: Path) -> None:
    """The two together were found first, and the dial was never tried with its tilt."""
    found, true = diagnosed(tmp_path, "foreign", 19, seed=7_700_000)
    assert names(found) == true == {"dial_eccentricity"}
    assert found.verdict == "IDENTIFIED"


def test_a_dial_beside_friction_is_no_stiffening_with_a_side_load(tmp_path: Path) -> None:
    """The dial fitted anew ended in a worse optimum than the one that had been accepted."""
    found, true = diagnosed(tmp_path, "loud", 25, seed=7_700_000)
    assert names(found) < true
    assert {"friction_hysteresis", "dial_eccentricity", "datum_drift"} <= names(found)


def test_a_drift_by_temperature_beside_one_from_run_to_run_is_named(tmp_path: Path) -> None:
    """Both together have far fewer amplitudes than there are runs, and leave nothing."""
    found, true = diagnosed(tmp_path, "loud", 42, seed=7_700_000)
    assert names(found) == true == {"load_dependent_friction", "datum_drift", "thermal_drift"}
