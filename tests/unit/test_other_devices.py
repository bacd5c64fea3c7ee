"""What loops of devices that are no cycloidal drives showed to be wrong in answers.

One direction of load, few readings whose mismatch is as slow as the whole recording, and sentences
that said different things of the same recording.
"""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from cyclosweep.design.nominal_line import NominalLine
from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.effects_found import explanations
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.identify.structures.verdict import Decision
from cyclosweep.diagnosis.identify_effects import (
    FEWEST_PIECES,
    instead_of_slow_noise,
    is_within_slow_noise,
)
from cyclosweep.diagnosis.prepare.flank_lines import find_flanks
from cyclosweep.diagnosis.remainder import no_larger_than_left, of_the_size_left
from cyclosweep.report.summary import summary_of
from cyclosweep.result import (
    Answer,
    Explained,
    Finding,
    FoundEffect,
    Mismatch,
    Remainder,
    Repair,
    Size,
)
from cyclosweep.result.statement import statement_of
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Flags
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import Floats
from tests.support.searches import search_of
from tests.unit.test_statement import CALIBRATED

LOAD = np.r_[np.linspace(0.7, 40.0, 60), np.linspace(40.0, 0.7, 60)]


def sides(torque: Floats, angle: Floats, play: float) -> tuple[Floats, Flags]:
    line = NominalLine(play, 2.7)
    return find_flanks(torque, angle, line).at(torque, angle)


@pytest.mark.parametrize("play", [0.02, 1.0, 3.0])
def test_a_curved_law_in_one_direction_stands_against_one_flank(play: float) -> None:
    # Softer at small loads: there the angle lies far beyond the other end of a small play.
    angle = play + 2.7 * LOAD - 12.0 * np.exp(-LOAD / 4.0)
    side, contact = sides(LOAD, angle, play)
    assert np.all(side == 1.0)
    assert np.all(contact)


@pytest.mark.parametrize("share", [0.8, 1.0, 1.1, 1.4])
def test_a_shaft_that_was_turned_through_its_play_stands_against_the_other_flank(
    share: float,
) -> None:
    light, play = np.full(20, 0.05), 28.0 * share
    torque = np.r_[light, LOAD]
    angle = np.r_[-play + 2.7 * light, play + 2.7 * LOAD]
    side, _ = sides(torque, angle, 28.0)
    np.testing.assert_array_equal(side, np.r_[np.full(20, -1.0), np.ones(len(LOAD))])


@pytest.mark.parametrize(("share", "shown"), [(0.05, False), (0.3, True)])
def test_a_side_load_asks_for_load_in_both_directions(share: float, shown: bool) -> None:
    history = search_of().problem.history
    torque = np.where(history.applied_nm < 0.0, share * history.applied_nm, history.applied_nm)
    reason = find("load_asymmetry").untestable(replace(history, applied_nm=torque))
    assert (reason is None) == shown


def test_what_moves_as_slowly_as_the_recording_and_is_large_is_error_of_the_model() -> None:
    search = search_of(EffectValue("creep", {"time_constant_s": 20.0}, (6.0,)))
    flexible = flexible_basis(search.problem, search.library)
    rows = len(search.noise.gap)
    one_run = np.where(np.arange(rows) > 0, 1.0, 0.0)
    slow = 1.0 - 1.0 / rows
    search.noise = replace(search.noise, best_correlation=slow, gap=one_run, structured=False)
    slow_noise = search.noise
    assert slow_noise.independent_pieces < FEWEST_PIECES
    assert instead_of_slow_noise(search, flexible) is not None
    # Other runs have noise of their own, noise of many pieces is known, and without a mismatch
    # nothing speaks against slow noise.
    for changed in (
        replace(slow_noise, gap=0.0 * one_run),
        replace(slow_noise, best_correlation=0.9),
    ):
        search.noise = changed
        assert instead_of_slow_noise(search, flexible) is None
    nothing = search_of()
    nothing.noise = replace(nothing.noise, best_correlation=slow, gap=one_run)
    flexible = flexible_basis(nothing.problem, nothing.library)
    assert instead_of_slow_noise(nothing, flexible) is None


def test_noise_far_larger_than_what_is_left_is_none_where_it_is_as_slow_as_the_recording() -> None:
    """A steel damper was given a creep, and a noise of three times what that left."""
    search = search_of(EffectValue("creep", {"time_constant_s": 20.0}, (6.0,)))
    search.run()
    found = search.best()
    assert found is not None
    left, rows = found.fit.rmse_deg, len(search.noise.gap)
    one_run = np.where(np.arange(rows) > 0, 1.0, 0.0)
    slow = replace(
        search.noise, best_correlation=1.0 - 1.0 / rows, gap=one_run, sigma_deg=3.0 * left
    )
    search.noise = slow
    assert is_within_slow_noise(search)
    for changed in (
        replace(slow, sigma_deg=left),
        replace(slow, best_correlation=0.9),
        replace(slow, gap=0.0 * one_run),
    ):
        search.noise = changed
        assert not is_within_slow_noise(search)
    nothing = search_of()
    nothing.run()
    nothing.noise = slow
    assert not is_within_slow_noise(nothing)


def test_what_is_left_is_no_larger_than_the_largest_residual() -> None:
    fitted = search_of(EffectValue("creep", {"time_constant_s": 20.0}, (2.0,))).baseline.fit
    left = (fitted.problem.angle_deg - fitted.mean_deg)[fitted.problem.fitted]
    largest = float(np.abs(left).max())
    huge = Remainder(shape="slow drift", place="over the recording", size_deg=9.0 * largest)
    assert no_larger_than_left(huge, fitted).size_deg == largest
    small = replace(huge, size_deg=0.5 * largest)
    assert no_larger_than_left(small, fitted) == small
    assert of_the_size_left(small, fitted) == small
    hardly = replace(huge, size_deg=1e-3 * largest)
    assert of_the_size_left(hardly, fitted).shape == "misfit of the model"
    misfit = of_the_size_left(hardly, fitted)
    assert misfit.size_deg == pytest.approx(float(np.sqrt(np.mean(left**2))))
    assert misfit.measure == "root mean square"


def test_the_calibrated_model_explains_nothing_where_something_is_left() -> None:
    baseline = search_of().baseline
    for unexplained, listed in ((True, 0), (False, 1)):
        decision = Decision("UNKNOWN_PHYSICS", None, [(baseline, 1.0)], unexplained)
        concluded = cast("Conclusion", SimpleNamespace(decision=decision))
        assert len(explanations(concluded)) == listed


FRICTION = FoundEffect(name="friction_hysteresis", size_deg=Size(estimate=3.0, ci95=(2.8, 3.2)))
UNKNOWN = Answer(
    verdict="UNKNOWN_PHYSICS",
    mismatch=Mismatch(p_value=0.001),
    effects=(FRICTION,),
    explained=Explained(share=0.5, ci95=(0.4, 0.6)),
    repaired=Repair(parameters=CALIBRATED, rmse_deg=0.2),
    unknown=Remainder(shape="loop of constant width", place="all along", size_deg=1.5),
)


def test_a_compliance_that_friction_hides_is_not_compared_with_nominal() -> None:
    assert "against nominal" in statement_of(UNKNOWN)
    hidden = Finding(topic="play", text="Not reported, as friction hides it: it takes 73 %.")
    text = statement_of(replace(UNKNOWN, findings=(hidden,)))
    assert "against nominal" not in text
    assert "friction hides compliance and play" in text


def test_the_summary_names_what_stands_in_for_what_is_left() -> None:
    assert "no listed effect explains" in summary_of(UNKNOWN)
    repaired = replace(UNKNOWN.repaired, stand_ins=("overload_softening",))
    text = summary_of(replace(UNKNOWN, repaired=repaired))
    assert "no listed effect explains" not in text
    assert "behaves like overload softening" in text


def test_a_structure_that_was_found_twice_is_one_explanation() -> None:
    def candidate(*names: str) -> SimpleNamespace:
        terms = tuple(SimpleNamespace(name=name, effect=object()) for name in names)
        return SimpleNamespace(fit=SimpleNamespace(terms=terms), recognised=(True,) * len(terms))

    found = ((candidate("a"), 0.4), (candidate("b"), 0.35), (candidate("b"), 0.25))
    decision = SimpleNamespace(unexplained=False, explanations=found)
    listed = explanations(cast(Conclusion, SimpleNamespace(decision=decision)))
    assert [each.effects for each in listed] == [("b",), ("a",)]
    assert [each.probability for each in listed] == pytest.approx([0.6, 0.4])
