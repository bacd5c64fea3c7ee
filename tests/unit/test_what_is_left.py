"""What is left without a name: one measure that is named, and places before and after a repair."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.misfit import at_its_place
from cyclosweep.report import ReportData
from cyclosweep.report.sentences import regions, unknown
from cyclosweep.report.summary import summary_of
from cyclosweep.result import (
    Answer,
    Baseline,
    Bound,
    CalibratedParameter,
    Explained,
    FoundEffect,
    Mismatch,
    Region,
    Remainder,
    Repair,
    Size,
)
from cyclosweep.result.contradictions import contradictions
from cyclosweep.result.statement import statement_of

PARAMETERS = {
    "compliance_scale": CalibratedParameter(nominal=1.0, estimate=1.0),
    "free_play_deg": CalibratedParameter(nominal=0.1, estimate=0.1, unit="deg"),
    "datum_deg": CalibratedParameter(nominal=0.0, estimate=0.0, unit="deg"),
}
FRICTION = FoundEffect(name="friction_hysteresis", size_deg=Size(estimate=3.0, ci95=(2.8, 3.2)))
MISFIT = Remainder(
    shape="misfit of the model", place="all along", size_deg=0.344, measure="root mean square"
)
BEFORE = Region(run=(1, 1), readings=(193, 200), mean_residual_deg=-1.1, share_of_excess=0.42)
AFTER = replace(BEFORE, repaired=True)
ANSWER = Answer(
    verdict="UNKNOWN_PHYSICS",
    mismatch=Mismatch(p_value=0.001, regions=(BEFORE,)),
    effects=(FRICTION,),
    explained=Explained(share=0.7, ci95=(0.5, 0.9)),
    baseline=Baseline(parameters=PARAMETERS, rmse_deg=0.624),
    repaired=Repair(parameters=PARAMETERS, rmse_deg=0.344),
    unknown=MISFIT,
)


def data(answer: Answer) -> ReportData:
    recording = cs.Recording.from_arrays(np.array([0.0, 1.0]), np.array([0.0, 0.1]))
    return ReportData(recording=recording, result=answer)


def test_a_misfit_has_the_measure_of_the_fit_error_wherever_it_is_said() -> None:
    """A misfit of 0.65 deg, a quantile, stood beside a fit error of 0.344 deg, without a name."""
    assert "a misfit of the model of 0.344 deg rms" in summary_of(ANSWER)
    assert "a misfit of the model of 0.344 deg rms" in statement_of(ANSWER)
    assert "Misfit of the model of 0.344 deg (20.6 arcmin) rms" in unknown(data(ANSWER))
    mostly = replace(ANSWER, verdict="MOSTLY_EXPLAINED")
    assert "a misfit of the model of 0.344 deg rms" in statement_of(mostly)


def test_a_shape_is_said_to_be_of_up_to_its_largest_twist() -> None:
    loop = Remainder(shape="hysteresis", place="all along", size_deg=0.2, measure="largest twist")
    found = replace(ANSWER, unknown=loop)
    for text in (summary_of(found), statement_of(found), unknown(data(found))):
        assert "oop between loading and unloading of up to 0.2 deg" in text


def test_what_is_left_is_never_more_than_what_the_calibrated_model_misses() -> None:
    assert contradictions(ANSWER) == ()
    larger = replace(ANSWER, unknown=replace(MISFIT, size_deg=0.65))
    (said,) = contradictions(larger)
    assert "more than the calibrated model misses" in said


@pytest.mark.parametrize(("region", "when"), [(BEFORE, "before"), (AFTER, "after")])
def test_a_place_says_whether_it_is_from_before_the_repair(region: Region, when: str) -> None:
    answer = replace(ANSWER, mismatch=Mismatch(regions=(region,)))
    (line,) = regions(data(answer))
    assert f"mean residual −1.1 deg (−66 arcmin) {when} the repair, 42 %" in line
    before = "Before the repair the model missed most at run 1, readings 193 to 200."
    assert (before in statement_of(answer)) is (when == "before")
    assert ("It shows most at" in statement_of(answer)) is (when == "after")


def test_a_misfit_in_one_place_is_not_all_along() -> None:
    place = "42 % of its mean square in run 1, readings 193 to 200"
    assert at_its_place(MISFIT, (AFTER,)).place == place
    assert at_its_place(MISFIT, (BEFORE,)) == MISFIT, "where the calibrated model was off"
    assert at_its_place(MISFIT, (replace(AFTER, share_of_excess=0.2),)) == MISFIT
    assert at_its_place(MISFIT, ()) == MISFIT
    loop = replace(MISFIT, shape="hysteresis")
    assert at_its_place(loop, (AFTER,)) == loop


def test_the_misfit_of_a_recording_is_its_fit_error() -> None:
    """No shape tells what a drive leaves that shakes and breaks in its last readings."""
    rng = np.random.default_rng(5)
    one = 20.0 * np.r_[0:1:60j, 1:-1:120j, -1:0:60j]
    torque = np.tile(one, 3)
    twist = 0.09 * torque + 0.3 * np.tanh(3 * np.gradient(torque)) + 0.01 * rng.normal(size=720)
    twist[-25:] -= 0.1 * np.arange(25)
    twist += 0.2 * np.sin(np.arange(720) / 7.0) ** 3
    recording = cs.Recording.from_arrays(torque, twist, side="output", history="continuous")
    drive = cs.Drive.reference_87().model_copy(update={"output_stiffness_nm_per_arcmin": 0.2})
    answer = cs.diagnose(recording, drive, full=False).answer
    assert answer.unknown is not None
    assert answer.unknown.measure == "root mean square"
    assert answer.unknown.size_deg == pytest.approx(answer.repaired.rmse_deg)
    assert contradictions(answer) == ()


@pytest.mark.parametrize("chance", [None, 0.4, 0.035])
def test_a_difference_that_chance_seldom_makes_is_not_said_to_be_none(chance: float | None) -> None:
    answer = Answer(
        verdict="INSUFFICIENT_DATA",
        mismatch=Mismatch(p_value=chance),
        tolerance_deg=0.05,
        undecided=(Bound(name="load_asymmetry", upper95_deg=0.08),),
        baseline=Baseline(parameters=PARAMETERS),
        repaired=Repair(parameters=PARAMETERS),
    )
    rare = chance is not None and chance < 0.05
    for text in (summary_of(answer), statement_of(answer)):
        assert ("No difference was found, but" in text) is not rare
        assert ("chance makes in 3.5 % of such recordings, but" in text) is rare
