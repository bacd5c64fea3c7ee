"""The validation of another drive than the built-in one: no note that is true of that one alone."""

from __future__ import annotations

import pytest

import cyclosweep as cs

OF_THE_BUILT_IN = (
    "the dimensions were chosen",
    "the clocking was chosen",
    "lower the mean by about 1 %",
)


def notes(drive: cs.Drive) -> dict[str, str]:
    table = cs.validate(drive)
    return dict(zip(table["fact"], table["note"], strict=True))


def test_the_built_in_drive_has_its_notes(reference: cs.Drive) -> None:
    said = "; ".join(notes(reference.replace(input_inertia_kg_m2=0.003)).values())
    assert all(note in said for note in OF_THE_BUILT_IN)


@pytest.mark.parametrize(
    ("change", "gone"),
    [
        ({"shaft_1_diameter_mm": 40.0}, "the dimensions were chosen"),
        ({"disc_count": 3}, "lower the mean by about 1 %"),
        ({"hole_clocking_deg": 0.0}, "the clocking was chosen"),
        ({"criterion": "inside"}, "the dimensions were chosen"),
    ],
)
def test_a_drive_with_other_inputs_does_not_have_the_note(
    reference: cs.Drive, change: dict[str, float], gone: str
) -> None:
    said = notes(reference.replace(**change))
    assert not [fact for fact, note in said.items() if gone in note]


def test_a_note_stays_where_the_inputs_concerned_are_the_built_in_drive_s(
    reference: cs.Drive,
) -> None:
    said = "; ".join(notes(reference.replace(shaft_1_diameter_mm=40.0)).values())
    assert "the clocking was chosen" in said
    assert "lower the mean by about 1 %" in said


def test_only_the_criterion_that_feeds_the_twist_is_said_to(reference: cs.Drive) -> None:
    said = notes(reference.replace(criterion="inside"))
    feeding = {fact for fact, note in said.items() if "feeds the twist" in note}
    assert feeding
    assert all(fact.endswith(", inside") for fact in feeding)


def test_the_published_line_is_worked_out_from_published_numbers_alone(
    reference: cs.Drive,
) -> None:
    slow = cs.validate(reference.replace(input_speed_rpm=1000.0))
    own = cs.validate(reference)
    for table in (slow, own):
        lines = table.filter(table["fact"].str.contains("of the published line"))
        assert lines.height == 6
        assert lines["ok"].all()
