"""A drive as Python people use it: hashed, copied, pickled, as JSON, and looked at."""

from __future__ import annotations

import copy
import pickle
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

import cyclosweep as cs

DRIVE = cs.Drive.reference_87()
LONGEST_LINE = 120

some_drives = st.builds(
    lambda **changes: DRIVE.replace(**changes),
    eccentricity_mm=st.floats(0.01, 5.0),
    output_pin_count=st.integers(3, 64),
    criterion=st.sampled_from(["published-map", "inside", "statics"]),
    shaft_2_diameter_mm=st.floats(1.0, 200.0),
    ring_gap_errors_mm=st.none() | st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1)),
    load_inertia_kg_m2=st.none() | st.floats(0.1, 9.0),
    name=st.text(st.characters(exclude_categories=["Cs"]), max_size=8),
)


@given(some_drives)
def test_json_gives_the_same_drive(drive: cs.Drive) -> None:
    assert cs.Drive.from_json(drive.to_json()) == drive


@given(some_drives)
def test_equal_drives_hash_equal_and_survive_pickle_and_copy(drive: cs.Drive) -> None:
    for other in (pickle.loads(pickle.dumps(drive)), copy.copy(drive), copy.deepcopy(drive)):
        assert other == drive
        assert hash(other) == hash(drive)
    assert hash(drive.replace(free_play_deg=drive.free_play_deg + 1)) != hash(drive)


def test_a_drive_is_a_key_whatever_kind_of_number_was_given() -> None:
    found = {DRIVE.replace(free_play_deg=28): "a"}
    assert found[DRIVE.replace(free_play_deg=28.0)] == "a"
    assert len({DRIVE, cs.Drive.reference_87(), DRIVE.replace(eccentricity_mm=0.7)}) == 2


def test_a_pickled_drive_computes_the_same() -> None:
    DRIVE.evaluate()
    assert pickle.loads(pickle.dumps(DRIVE)).evaluate() == DRIVE.evaluate()


def test_replacing_a_segment_leaves_the_others_and_the_drive_itself() -> None:
    before = DRIVE.model_dump()
    other = DRIVE.replace(shaft_2_diameter_mm=61.0, shaft_1_length_mm=90.0)
    assert DRIVE.model_dump() == before
    assert other.shaft[0].length_mm == 90.0
    assert other.shaft[1:] == (cs.Cylinder(diameter_mm=61.0, length_mm=40.1), *DRIVE.shaft[2:])
    assert "shaft_2_diameter_mm" not in other.provenance
    assert "shaft_3_diameter_mm" in other.provenance


@given(some_drives)
def test_a_drive_is_shown_in_one_short_line(drive: cs.Drive) -> None:
    shown = repr(drive)
    assert str(drive) == shown
    assert shown.startswith(f"<Drive {drive.name}: 87:1, 2 discs, {drive.output_pin_count} ")
    assert len(shown) <= LONGEST_LINE


class Balance(HTMLParser):
    """Elements that are open."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += f"{data} "


def test_a_notebook_shows_the_numbers_a_designer_knows_a_drive_by() -> None:
    page = Balance()
    page.feed(DRIVE.replace(name="<b>&")._repr_html_())
    assert page.open == []
    for word in ("Drive <b>&", "87:1", "0.62 mm", "585 N m", "28 deg", "assumed", "published-map"):
        assert word in page.text
    assert "output stiffness" not in page.text


def test_a_drive_of_a_measured_stiffness_says_it() -> None:
    drive = DRIVE.replace(shaft=(), output_stiffness_nm_per_arcmin=140.0, provenance={})
    page = drive._repr_html_()
    assert "140 N m/arcmin" in page
    assert "numbers" not in page


@pytest.mark.parametrize("word", ["#", "rgb", "white", "black"])
def test_html_has_no_colour_of_its_own(word: str) -> None:
    assert word not in DRIVE._repr_html_()


def test_a_drive_does_not_change() -> None:
    with pytest.raises(cs.InputError, match="ratio: a Drive does not change"):
        DRIVE.ratio = 5  # type: ignore[misc]
