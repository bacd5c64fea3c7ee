"""A repair by effects that only stand in is said wherever figures of the repaired model stand."""

from dataclasses import replace

import pytest

from cyclosweep.report import ReportData
from cyclosweep.report.html import page
from cyclosweep.report.sentences import headline
from cyclosweep.report.tables import held_out_table, loop_table, parameter_table
from cyclosweep.result import Remainder
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
