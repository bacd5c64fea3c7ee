"""Another law of its class takes the place of one that fits and may not be named."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.conclude import with_other_law
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.class_check import check_laws
from cyclosweep.diagnosis.identify.laws.naming import names_that_hold
from cyclosweep.diagnosis.identify.laws.travel_check import without_waves_of_a_curve
from cyclosweep.diagnosis.identify.stages.law_that_holds import with_law_that_holds
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import Decision
from cyclosweep.diagnosis.whole_loop.run_comparison import are_replicates
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import present
from tests.support.long_recording import long_recording
from tests.support.searches import search_of, search_of_recording

SIDE_LOAD = EffectValue("load_asymmetry", {"power": 2.0}, (0.05,))
DIAL = Term(find("dial_eccentricity"), {"order": 1.0})
WAVE = {"travel_ratio": 1.0, "travel_order_1": 8.0}


def structure(search: Search, *terms: Term) -> Candidate:
    """Structure of terms, fitted jointly."""
    return search.judged(fit(search.problem, search.noise, terms, search.baseline.fit), 0.0, 0.0)


def without_position(*effects: EffectValue) -> cs.Recording:
    """Recording of which the position of the mesh is not known."""
    return replace(long_recording(3_000, effects), crank_deg=None)


def test_a_side_load_takes_the_place_of_an_even_dial() -> None:
    search = search_of(SIDE_LOAD)
    dial = structure(search, DIAL)
    naming = names_that_hold(search, dial, dial)
    assert [check.name for check in naming.withdrawn] == ["dial_eccentricity"]
    found = with_law_that_holds(search, dial, naming)
    assert found is not None
    assert found.names == {"load_asymmetry"} == set(found.part.fit.names)


@pytest.mark.parametrize(
    ("dial_share", "side_share", "verdict"),
    [(0.6, 0.3, "IDENTIFIED"), (0.3, 0.6, "IDENTIFIED"), (0.4, 0.3, "AMBIGUOUS")],
)
def test_the_law_that_fits_better_stays_possible(
    dial_share: float, side_share: float, verdict: str
) -> None:
    search = search_of(SIDE_LOAD)
    dial = structure(search, DIAL)
    side = structure(search, Term(find("load_asymmetry"), {"power": 2.0}))
    listed = [(dial, dial_share), (side, side_share)]
    decision = Decision("UNKNOWN_PHYSICS", dial, listed, unexplained=True)
    found = with_other_law(search, decision, dial, names_that_hold(search, dial, dial))
    assert found is not None
    decided, naming = found
    assert decided.verdict == verdict
    assert not decided.unexplained
    assert decided.best is naming.part
    larger, smaller = max(dial_share, side_share), min(dial_share, side_share)
    assert decided.explanations == [(naming.part, larger), (dial, smaller)]


def test_no_law_takes_the_place_of_one_that_fits_far_better() -> None:
    """An oblique dial is neither a side load nor a softening."""
    search = search_of(EffectValue("dial_eccentricity", {"order": 1.0}, (1.5, 1.0)))
    dial = structure(search, DIAL)
    naming = names_that_hold(search, dial, dial)
    (check,) = naming.checks
    withdrawn = replace(naming, part=search.baseline, checks=(replace(check, holds=False),))
    assert with_law_that_holds(search, dial, withdrawn) is None


@pytest.mark.parametrize(("leaves_much", "named"), [(True, False), (False, True)])
def test_a_wave_of_an_unknown_position_is_named_where_little_is_left(
    *, leaves_much: bool, named: bool
) -> None:
    """A hum and the ripple of a motor were called a transmission error that explained half."""
    wave = EffectValue("transmission_error", WAVE, (0.3, 0.2))
    bump = EffectValue("overload_softening", {"onset_nm": 8.0, "power": 1.0}, (3.0,))
    search = search_of_recording(without_position(wave, *([bump] if leaves_much else [])))
    found = structure(search, Term(find("transmission_error"), WAVE)).fit
    (check,) = check_laws(found)
    seen = replace(check, behaviour="odd curve of the torque", holds=True)
    (judged,) = without_waves_of_a_curve(search.baseline.fit, found, [seen])
    assert judged.holds == named


def test_an_effect_that_changes_its_sign_under_other_noise_is_left_out() -> None:
    """A search began from a softening of less than nothing, and the result named it."""
    shape = {"onset_nm": 10.0, "power": 1.0}
    term = Term(find("overload_softening"), shape)
    soft = search_of(EffectValue("overload_softening", shape, (0.2,)))
    accepted = structure(soft, term).fit
    stiff = search_of(EffectValue("overload_softening", shape, (-0.2,)))
    again = Search(stiff.problem, stiff.noise, stiff.library, 0, accepted)
    assert again.start.fit.terms == ()
    same = Search(soft.problem, soft.noise, soft.library, 0, accepted)
    assert same.start.names == {"overload_softening"}


def test_runs_at_other_positions_are_no_replicates() -> None:
    """A model of one position missed another one by 276 degrees, which was called a drift."""
    history = search_of_recording(long_recording(3_000)).problem.history
    first, at_the_same, smaller, elsewhere = (history.run == k for k in (0, 4, 1, 6))
    assert are_replicates(history, first, at_the_same)
    assert not are_replicates(history, first, smaller)
    assert not are_replicates(history, first, elsewhere)
    assert are_replicates(history.with_state(crank_deg=None), first, elsewhere)
    # A position that was measured is never the same to the last digit.
    crank = present(history.crank_deg) + np.where(at_the_same, 0.3, 0.0) - 45.1
    assert are_replicates(history.with_state(crank_deg=crank % 360.0), first, at_the_same)
