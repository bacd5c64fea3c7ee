"""The validation can fail: every deliberate error breaks counted rows, the package itself none."""

from __future__ import annotations

import importlib.util
import math
from dataclasses import replace
from pathlib import Path

import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.design.drive import Criterion
from cyclosweep.reference.broken_models import BROKEN_MODELS, broken_model
from cyclosweep.reference.facts import COUNTED, Fact
from cyclosweep.reference.rows import broken_rows, broken_table, tally
from cyclosweep.reference.sources import KUMAR, PUBLISHED
from cyclosweep.reference.validation import summary, untouched

ROOT = Path(__file__).parents[2]
ERRORS = [model.name for model in BROKEN_MODELS]
REQUIRED = {
    "E halved",
    "e halved",
    "a pin less",
    "k = 1.25",
    "i^2 forgotten",
    "eta dropped",
    "a step left out",
    "shear left out",
    "metres for millimetres",
}
EXPLAINED = {
    "Krol et al. 2019, design 1: inner force": (348.87, 387.5),
    "unit case: ring force": (10.04, 10.2467),
    "unit case: output force": (20.26, 20.7239),
    "unit case: ring pressure": (118.56, 119.441),
    "unit case: output pressure": (89.21, 90.2207),
    "29:1: force on a ring roller": (213.3, 217.588),
    "Wang et al. 2016, optimised: volume of a disc": (93067.0, 97304.05),
    "Wang et al. 2016, as built: volume of a disc": (93229.0, 97472.32),
    "Eq. (6): extra length of a shoulder / d at D/d = 1.25": (0.0453, 0.061),
    "Eq. (6): extra length of a shoulder / d at D/d = 2": (0.1257, 0.1094),
    "Eq. (6): extra length of a shoulder / d at D/d = 3": (0.1493, 0.1204),
    "Eq. (5): 50 mm shaft with its standard keyway, 14 x 5.5 mm / without": (1.131, 2.10),
    "mean active pins of 8, inside": (6.75, 7.9653),
    "fewest active pins, inside": (4, 6),
    "mean active pins of 8, statics": (6.75, 8),
    "fewest active pins, statics": (4, 8),
    "start of hole H1's active zone without clocking": (66, 67.123),
    "McIver: nine pins pulsate less than eight (1 = yes), published-map": (1, 0),
    "McIver: nine pins pulsate less than eight (1 = yes), statics": (1, 0),
}


@pytest.fixture(scope="module")
def intact() -> pl.DataFrame:
    return cs.validate()


@pytest.fixture(scope="module")
def rows() -> pl.DataFrame:
    return broken_rows()


def test_only_evidence_independent_solutions_and_identities_count(intact: pl.DataFrame) -> None:
    assert set(intact.filter("counted")["kind"]) == set(COUNTED)
    assert set(intact.filter(~pl.col("counted"))["kind"]).isdisjoint(COUNTED)
    assert intact.filter("counted")["ok"].null_count() == 0


def test_evidence_names_a_publication_and_nothing_else_passes_for_one(
    intact: pl.DataFrame,
) -> None:
    evidence = intact.filter(kind="evidence")
    assert set(evidence["source"]) == set(PUBLISHED)
    others = intact.filter(kind="independent solution")
    assert set(others["source"]).isdisjoint({*PUBLISHED, ""})
    plain = "published nowhere|not named|not noted as printed"
    assert others["source"].str.contains(plain).all()
    assert (evidence.height, others.height) == (55, 50)


@pytest.mark.parametrize(
    ("named", "rows"),
    [("87:1, .* N m: ", 11), ("^Eq. .6.: extra length|^Eq. .5.: 50 mm", 5), ("^sine limit", 4),
     ("^unit case", 8), ("^29:1.*(roller|across)", 4), ("^cycloidgen", 3), ("^oil engine", 2),
     ("radius of curvature", 2), ("^five inertias", 11)],
)  # fmt: skip
def test_numbers_that_cannot_be_looked_up_are_no_evidence(
    intact: pl.DataFrame, named: str, rows: int
) -> None:
    found = intact.filter(pl.col("fact").str.contains(named) & pl.col("counted"))
    found = found.filter(~pl.col("fact").str.contains(": stiffness / 4 k R"))
    assert found["kind"].to_list() == ["independent solution"] * rows


def test_evidence_and_independent_solutions_need_a_source() -> None:
    for kind in ("evidence", "independent solution"):
        with pytest.raises(ValueError, match=f"{kind} needs a source"):
            Fact("g", "f", 1.0, 1.0, "1", "derived", kind, 0.1)


def test_the_readme_says_what_the_validation_counts(intact: pl.DataFrame) -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    counts = tally(intact)
    for kind, line in (
        ("evidence", "numbers that named publications print"),
        ("independent solution", "independent solutions, in no named publication"),
    ):
        found = counts[kind]
        said = (
            f"| {line} | {found['agree']} of {sum(found.values())} agree; "
            f"{found['explained']} disagree and are explained |"
        )
        assert said in readme
        both = f"{found['agree']} agree, {found['explained']} disagree and are explained"
        assert both in summary(counts)


def test_what_is_typed_in_or_reconstructed_does_not_count(intact: pl.DataFrame) -> None:
    kinds = dict(zip(intact["fact"], intact["kind"], strict=True))
    assert kinds["ratio i"] == kinds["free play at the input"] == "input"
    assert kinds["twist at 2.5 T_N, 75 to 80 deg"] == "input"
    assert kinds["C_OS of the published line, eta 0.84375, from"] == "input"
    assert kinds["eta_OP"] == kinds["start of hole H1's active zone"] == "reconstruction"
    assert kinds["nominal input torque T_N"] == "evidence"


def test_the_sector_values_that_are_printed_nowhere_are_marked_as_ours(
    intact: pl.DataFrame,
) -> None:
    sectors = intact.filter(pl.col("fact").str.contains(r"^active pins near \d+ deg$"))
    assert sectors["published"].to_list() == [None, None, 8, None, None, None, None, None]
    assert sectors["computed"].to_list() == [4, 6, 8, 8, 6, 8, 8, 6]
    assert set(sectors.filter(pl.col("published").is_null())["mark"]) == {"ours"}
    assert not sectors["counted"].any()


def test_what_disagrees_is_named_with_both_numbers_and_explained(intact: pl.DataFrame) -> None:
    wrong = intact.filter(pl.col("counted") & ~pl.col("ok"))
    assert (wrong["explanation"].str.len_chars() > 40).all()
    found = {r["fact"]: (r["published"], r["computed"]) for r in wrong.iter_rows(named=True)}
    assert found.keys() == EXPLAINED.keys()
    for fact, numbers in EXPLAINED.items():
        assert found[fact] == pytest.approx(numbers, rel=1e-3)
    assert intact.filter("ok")["explanation"].unique().to_list() == [""]
    assert all(kind["fail"] == 0 for kind in tally(intact).values())


def test_every_error_the_project_asks_for_is_there() -> None:
    assert set(ERRORS) >= REQUIRED
    assert len(set(ERRORS)) == len(ERRORS)


@pytest.mark.parametrize("error", ERRORS)
def test_no_error_breaks_nothing(rows: pl.DataFrame, error: str) -> None:
    assert rows[error].sum() > 0


@pytest.mark.parametrize(
    ("error", "fact"),
    [
        ("E halved", "Eqs. (8)-(10): deflection of the pin / by Hutchinson's shear coefficient"),
        ("e halved", "unit case, 18 ring pins: short-width coefficient K1"),
        ("a pin less", "unit case, 6 output pins, 1 N m on one disc: inner force"),
        ("k = 1.25", "Eq. (5): coefficient k read back from a keyway"),
        ("i^2 forgotten", "Eq. (12): C*_OS / (C_OS i^2)"),
        ("eta dropped", "Eq. (13): (theta' - gamma) / (eta C*_OS T_N)"),
        ("a step left out", "Eq. (4): whole shaft / its segments and shoulders one by one"),
        (
            "shear left out",
            "Eqs. (8)-(10): deflection of the pin / by Hutchinson's shear coefficient",
        ),
        (
            "metres for millimetres",
            "29:1, two discs, 4 output pins on 68 mm: force on an output roller",
        ),
        ("rated torque on one pin", "Eqs. (8)-(10): C_OP / C_OP of a drive rated at a hundredth"),
        ("shares by sine alone", "statics: share of two discs of eight pins"),
        ("crank in degrees", "twist a ring pitch further, holes turned along / twist"),
        (
            "tare left in",
            "twist under the mirrored torque at the mirrored crank / - twist",
        ),
        ("tare left in", "twist of a drive twice as stiff under twice the torque / twist"),
        ("pin root left out", "work of every part / torque times twist"),
        ("e halved", "ring force across the eccentricity / (T / (e N))"),
        ("E halved", "87:1, no clearance, 585 N m: twist"),
        ("shares by sine alone", "statics: C_OS / (C_OS^t + 2 C_OP / N_OP)"),
    ],
)
def test_an_error_breaks_the_row_that_is_about_it(
    rows: pl.DataFrame, error: str, fact: str
) -> None:
    assert rows.filter(pl.col("fact") == fact)[error].item()


def test_every_counted_row_can_fail(intact: pl.DataFrame, rows: pl.DataFrame) -> None:
    """Rows that no listed error breaks are known by name; each disagrees by a whole number."""
    assert untouched(rows) == [
        "fewest active pins, inside",
        "McIver: nine pins pulsate less than eight (1 = yes), published-map",
        "McIver: nine pins pulsate less than eight (1 = yes), statics",
    ]
    assert rows.height == intact["counted"].sum()


@pytest.mark.parametrize(
    ("error", "fact", "computed"),
    [
        ("E halved", "Eq. (6): extra length of a shoulder / d at D/d = 2", 3.40625),
        ("E halved", "Eq. (5): 50 mm shaft with its standard keyway, 14 x 5.5 mm / without", 4.2),
        ("a pin less", "Krol et al. 2019, design 1: inner force", 436.0108),
        ("e halved", "mean active pins of 8, inside", 7.98266),
    ],
)
def test_an_explanation_does_not_excuse_another_number(
    intact: pl.DataFrame, error: str, fact: str, computed: float
) -> None:
    broken = cs.validate(broken=error)
    row = broken.row(by_predicate=pl.col("fact") == fact, named=True)
    assert row["computed"] == pytest.approx(computed, rel=1e-4)
    assert row["explanation"] == ""
    assert intact.filter(pl.col("fact") == fact)["explanation"].item() != ""
    assert tally(broken)[row["kind"]]["fail"] > 0


def test_the_table_of_errors_counts_what_the_rows_say(rows: pl.DataFrame) -> None:
    for row in broken_table(rows).iter_rows(named=True):
        assert sum(row[kind] for kind in COUNTED) == rows[row["model"]].sum()


def test_a_counted_row_needs_a_number_and_a_tolerance() -> None:
    with pytest.raises(ValueError, match="needs a number"):
        Fact("g", "f", None, 1.0, "1", "derived", "evidence", 0.1)
    with pytest.raises(ValueError, match="needs a number"):
        Fact("g", "f", 1.0, 1.0, "1", "derived", "identity")


def test_an_explanation_needs_the_number_that_it_explains() -> None:
    with pytest.raises(ValueError, match="needs the number"):
        Fact("g", "f", 1.0, 2.0, "1", "derived", "evidence", 0.1, "", "why")
    fact = Fact("g", "f", 1.0, 2.0, "1", "derived", "evidence", 0.1, "", "why", 2.0, KUMAR)
    assert fact.is_explained
    assert not replace(fact, computed=3.0).is_explained
    assert not replace(fact, computed=1.0).is_explained


def test_an_unknown_error_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"'E doubled': no such model, expected one of E halved"):
        cs.validate(broken="E doubled")


def test_the_page_on_the_validation_is_up_to_date() -> None:
    spec = importlib.util.spec_from_file_location("generate", ROOT / "docs" / "generate.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert (ROOT / "docs" / "validation.md").read_text("utf-8") == module.validation()


@pytest.mark.parametrize("criterion", ["published-map", "statics"])
@pytest.mark.parametrize("error", ERRORS)
def test_results_of_a_broken_model_still_follow_from_each_other(
    error: str, criterion: Criterion
) -> None:
    """An error is one error: what follows from the number it is in moves with it."""
    drive = cs.Drive.reference_87().replace(criterion=criterion)
    moved = broken_model(error).evaluate(drive)
    if math.isnan(moved["output_compliance_rad_per_nm"]):
        return
    reflected = moved["reflected_compliance_rad_per_nm"]
    found = {
        "i^2 forgotten": reflected / moved["output_compliance_rad_per_nm"] / drive.ratio**2,
        "stiffness not reflected": moved["reflected_stiffness_nm_per_rad"] * reflected,
        "degrees for arc minutes": moved["output_stiffness_nm_per_arcmin"]
        * moved["output_compliance_rad_per_nm"] * 10800 / math.pi,
        "2 pi forgotten": (math.tau * moved["natural_frequency_hz"]) ** 2 * 0.002 * reflected,
    }  # fmt: skip
    for about, value in found.items():
        assert (value == pytest.approx(1.0, rel=1e-9)) == (about != error), about
    if criterion == "statics":
        by_statics = moved["output_compliance_statics_rad_per_nm"]
        assert moved["output_compliance_rad_per_nm"] == pytest.approx(by_statics, rel=1e-12)
