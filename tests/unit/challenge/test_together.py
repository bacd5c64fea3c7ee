"""Contests of the same code, taken together."""

from typing import Any

import pytest

from cyclosweep_challenge.record.together import behind_table, figures_over_all, over_all
from cyclosweep_challenge.scoring.intervals import Estimate, together


def contest(
    seed: int, code: str, low: float, high: float, programme: str = "poor"
) -> dict[str, Any]:
    there = {"value": (low + high) / 2, "low": low, "high": high, "count": 500}
    who = {"who": "bic_subset", "programme": programme, "noise": "white"}
    own = {"own": {"tuned_ahead": there, "ahead": {**there, "value": -0.5, "low": -0.6}}}
    return {
        "record": {"seed": seed, "diagnosis": code, "rig": "one rig"},
        "opponents": [who | own, {**who, "who": "the diagnosis, tuned alike"} | own],
    }


def test_the_more_precise_counts_more_and_together_they_are_more_precise() -> None:
    wide, narrow = Estimate(0.0, -0.2, 0.2, 30), Estimate(0.1, 0.0, 0.2, 50)
    found = together([wide, narrow])
    assert found.value == pytest.approx(0.08)
    assert found.high - found.low == pytest.approx(2 * 0.1 * 0.8**0.5)
    # Something certain, as where no draw differs, decides alone.
    assert together([wide, Estimate(0.3, 0.3, 0.3, 9)]).value == pytest.approx(0.3)


def test_none_alone_but_all_show_that_an_opponent_is_behind() -> None:
    one, other = contest(10, "a", -0.01, 0.07), contest(20, "a", -0.01, 0.07)
    [figure] = figures_over_all(one, [other])
    assert figure["name"].endswith("poor, all records")
    assert figure["estimate"]["value"] == 1.0
    # Shown, not judged: which record decides is settled beforehand.
    assert figure["met"] is None
    assert figure["met_required"] is None
    far = contest(20, "a", -0.05, 0.03)
    [figure] = figures_over_all(one, [far])
    assert figure["estimate"]["value"] == 0.0
    [figure] = figures_over_all(one, [far, other, contest(30, "a", 0.01, 0.09)])
    assert figure["estimate"]["value"] == 1.0
    words = behind_table(one, {"proof": other})
    assert "| white | poor | bic_subset | 0.03 [-0.01, 0.07] | -0.5 [-0.6, 0.07] |" in words
    assert "| both at 1 %, in [proof](proof.md) |" in words


def test_records_of_other_code_or_other_recordings_are_not_put_together() -> None:
    one = contest(10, "a", 0.1, 0.2)
    other, rich = contest(20, "b", 0.1, 0.2), contest(20, "a", 0.1, 0.2, programme="rich")
    assert over_all(one, [other]) == {}
    assert figures_over_all(one, [other]) == []
    assert over_all(one, [rich]) == {}
    # The same record twice is no second one.
    assert over_all(one, [one]) == {}
    # Each comparison is taken from the records that have it.
    assert over_all(one, [rich, other, contest(30, "a", 0.1, 0.2)]).keys() == {
        ("white", "poor", "bic_subset")
    }
    assert behind_table(one, {}).endswith("| – |")
    # An opponent that met no case stays in the table.
    one["opponents"][0]["own"]["tuned_ahead"]["count"] = 0
    assert "| white | poor | bic_subset | – |" in behind_table(one, {})
