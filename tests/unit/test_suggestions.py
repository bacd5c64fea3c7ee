"""A misspelt name is answered with the one that was meant, wherever names are given."""

from __future__ import annotations

import pytest

from cyclosweep.errors import did_you_mean


@pytest.mark.parametrize(
    ("found", "meant"),
    [
        ("eccentricty_mm", "eccentricity_mm"),
        ("Eccentricity-MM", "eccentricity_mm"),
        ("frequency", "natural_frequency_hz"),
        ("output pin count", "output_pin_count"),
    ],
)
def test_the_closest_name_is_suggested(found: str, meant: str) -> None:
    known = ["ratio", "eccentricity_mm", "natural_frequency_hz", "output_pin_count"]
    assert did_you_mean(found, known) == f", did you mean {meant}?"


@pytest.mark.parametrize("found", ["", "xyz", "min", 7, None])
def test_nothing_is_suggested_for_what_is_far_from_every_name(found: object) -> None:
    assert did_you_mean(found, ["eccentricity_mm", "disc_minimum_mm"]) == ""


def test_no_known_names_give_no_suggestion() -> None:
    assert did_you_mean("ratio", []) == ""
