"""Long recordings get the verdict and the sizes that every tenth row of the same file gives."""

from typing import Any

import pytest

import cyclosweep as cs
from tests.support.long_recording import (
    COMPLIANCE,
    driven_through_friction,
    friction,
    long_recording,
    warming,
)

LONG = 100_000


def diagnosed(recording: cs.Recording) -> dict[str, Any]:
    return cs.diagnose(recording, cs.Drive.reference_87(), full=False).content


def both(recording: cs.Recording) -> tuple[dict[str, Any], dict[str, Any]]:
    """Content of the diagnosis of a recording, and of that of every tenth row of it."""
    return diagnosed(recording), diagnosed(recording.take(slice(None, None, 10)))


def sizes(content: dict[str, Any]) -> dict[str, float]:
    return {effect["name"]: effect["size_deg"]["estimate"] for effect in content["effects"]}


@pytest.fixture(scope="module")
def two_effects() -> tuple[dict[str, Any], dict[str, Any]]:
    return both(long_recording(LONG, [friction(), warming()]))


def test_two_effects_are_named_in_all_rows_and_in_every_tenth(
    two_effects: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    whole, tenth = two_effects
    for content in (whole, tenth):
        assert content["verdict"] == "IDENTIFIED"
        assert set(sizes(content)) == {"friction_hysteresis", "thermal_drift"}
    for name, size in sizes(whole).items():
        assert size == pytest.approx(sizes(tenth)[name], rel=0.05)
    assert whole["repaired"]["rmse_deg"] == pytest.approx(whole["noise"]["sigma_deg"], rel=0.05)


def test_rows_and_noise_of_a_sample_are_said(
    two_effects: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    thinning = two_effects[0]["thinning"]
    assert thinning["samples"] == pytest.approx(LONG, rel=0.01)
    assert 3_000 < thinning["rows"] < 7_000
    assert thinning["averaged"] > 5
    assert thinning["sample_sigma_deg"] == pytest.approx(0.05, rel=0.03)
    assert abs(thinning["sample_autocorrelation"]) < 0.1
    assert f"thinned to {thinning['rows']:,} rows" in two_effects[0]["statement"]


def test_averages_show_an_effect_that_every_tenth_row_cannot() -> None:
    whole, tenth = both(long_recording(LONG, [warming(0.0006)]))
    assert (whole["verdict"], set(sizes(whole))) == ("IDENTIFIED", {"thermal_drift"})
    assert tenth["verdict"] == "NOTHING_MISSING"


def test_nothing_is_missing_in_all_rows_and_in_every_tenth() -> None:
    for content in both(long_recording(LONG)):
        assert content["verdict"] == "NOTHING_MISSING"
        assert content["repaired"]["parameters"]["free_play_deg"]["estimate"] == pytest.approx(
            28.0, abs=0.01
        )


def test_friction_of_two_hundred_thousand_rows_is_named_alone() -> None:
    # Averaged over reversals: mostly explained, or with a creep or further effects named beside it.
    content = diagnosed(long_recording(200_000, [friction()]))
    assert content["verdict"] == "IDENTIFIED"
    assert set(sizes(content)) == {"friction_hysteresis"}
    found = content["effects"][0]["parameters"]["friction_torque_nm"]["estimate"]
    assert found == pytest.approx(0.15 / COMPLIANCE, rel=0.05)


def test_friction_that_moves_the_crossings_is_named_alone() -> None:
    # With rows that mixed both flanks, or that count where the shaft stood before the first load:
    # mostly explained, with a load asymmetry named beside it.
    whole, tenth = both(driven_through_friction(300_000, 0.3, 0.3, loops=10))
    for content in (whole, tenth):
        assert content["verdict"] == "IDENTIFIED"
        assert set(sizes(content)) == {"friction_hysteresis"}
        assert content["repaired"]["rmse_deg"] == pytest.approx(
            content["noise"]["sigma_deg"], rel=0.05
        )
    found, few = sizes(whole)["friction_hysteresis"], sizes(tenth)["friction_hysteresis"]
    assert found == pytest.approx(few, rel=0.05)
