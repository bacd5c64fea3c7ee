"""A repair by effects that only stand in is said wherever figures of the repaired model stand."""

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from cyclosweep.report import ReportData
from cyclosweep.report.html import page
from cyclosweep.report.sentences import explanations, explanations_heading, headline, unknown
from cyclosweep.report.summary import summary_of
from cyclosweep.report.tables import held_out_table, loop_table, parameter_table
from cyclosweep.report.terminal import print_summary
from cyclosweep.result import Bound, Explanation, Remainder
from tests.unit.made_up_report import make


@pytest.fixture(scope="module")
def whole() -> ReportData:
    return make()


@pytest.fixture(scope="module")
def stood_in(whole: ReportData) -> ReportData:
    """The same with nothing named, and viscous drag as a stand-in."""
    told = whole.result
    repair = replace(
        told.repaired, rmse_deg=0.2, holdout_rmse_deg=0.25, stand_ins=("viscous_drag",)
    )
    result = replace(
        told,
        verdict="UNKNOWN_PHYSICS",
        effects=(),
        unknown=Remainder(shape="loop that opens with the rate", size_deg=0.16),
        baseline=replace(told.baseline, rmse_deg=0.4, holdout_rmse_deg=0.5),
        repaired=repair,
        explanation_set=(Explanation(effects=("viscous_drag",), probability=1.0),),
        undecided=(Bound(name="viscous_drag", upper95_deg=0.5),),
    )
    return replace(whole, result=result)


def test_captions_and_titles_show_the_repair(stood_in: ReportData) -> None:
    text = page(stood_in)
    assert "no repair" not in text
    assert "nothing was repaired" not in text
    assert "After: the same with viscous drag as a stand-in." in text
    assert "with viscous drag as a stand-in, removes 75 % of the mismatch on data not used" in text


def test_figures_beside_the_verdict_are_before_and_after(stood_in: ReportData) -> None:
    rows = headline(stood_in)
    assert [value for value, _, _ in rows][:2] == ["0.5 → 0.25 deg", "0.4 → 0.2 deg"]
    assert rows[0][2] == "before → after, viscous drag as a stand-in"


@pytest.mark.parametrize("table", [loop_table, parameter_table, held_out_table])
def test_tables_say_what_after_is(table: object, stood_in: ReportData, whole: ReportData) -> None:
    assert callable(table)
    assert "After: with viscous drag as a stand-in" in table(stood_in).note
    assert "stand-in" not in table(whole).note


def test_a_law_that_does_not_hold_is_no_explanation_that_fits(
    stood_in: ReportData, whole: ReportData
) -> None:
    assert explanations_heading(stood_in) == "Explanations that fit best of those compared"
    (only,) = explanations(stood_in)
    assert only.startswith("viscous drag (a stand-in, whose law was not found to hold): prob")
    text = summary_of(stood_in.result)
    assert "no listed effect explains within the noise: a loop that opens with the rate" in text
    assert text.endswith("like viscous drag, whose law was not found to hold.")
    assert "No listed effect explains it within the noise." in unknown(stood_in)
    assert explanations_heading(whole) == "Explanations that fit"
    assert not any("stand-in" in line for line in explanations(whole))


def test_nothing_is_beside_what_is_named_where_nothing_is(stood_in: ReportData) -> None:
    stream = StringIO()
    print_summary(stood_in, Console(file=stream, width=120))
    said = stream.getvalue()
    assert "Possible at most (95 % upper bound)" in said
    assert "Beside what is named" not in said


def test_what_is_left_of_a_named_law_is_what_that_law_misses(whole: ReportData) -> None:
    rest = Remainder(shape="overload_softening", place="all along", size_deg=0.048)
    result = replace(whole.result, verdict="MOSTLY_EXPLAINED", unknown=rest)
    left = "What is left, 0.048 deg, is what the law of overload softening misses."
    assert summary_of(replace(result, summary="")).endswith(left)
    said = unknown(replace(whole, result=result))
    assert said.startswith("What the law of overload softening misses, 0.048 deg")
    assert "No listed effect" not in said
