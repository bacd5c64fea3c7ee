"""Stages of a search: how large what a structure leaves is, what is accepted, freer laws."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

import cyclosweep.diagnosis.identify.stages.acceptance as acceptance
import cyclosweep.diagnosis.identify_effects as identify_effects
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.class_check import check_laws
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.laws.law_in_class import BOTH_CURVES
from cyclosweep.diagnosis.identify.laws.model_error_terms import (
    LEAST_OF_MISMATCH,
    without_model_error,
)
from cyclosweep.diagnosis.identify.laws.run_offsets_check import offset_count
from cyclosweep.diagnosis.identify.stages.freer_laws import freer_instead_of_others
from cyclosweep.diagnosis.identify.stages.stage import FAINT, visibility
from cyclosweep.diagnosis.identify.stages.staged_search import search_in_stages
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.starting_terms import starting_terms
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist, size_left
from cyclosweep.diagnosis.identify.structures.verdict import Decision
from cyclosweep.simulation.effects import effects, find
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import friction
from tests.support.searches import search_of

CREEP = EffectValue("creep", {"time_constant_s": 20.0}, (2.0,))
WARM = EffectValue("thermal_drift", {"datum": 1.0}, (0.6,))
SHIFTED = EffectValue("transmission_error", {"order_1": 2.0}, (0.15, 0.1))
LOADED = {
    "slip_deg": 1.0,
    "scatter": 0.6,
    "skew": 0.0,
    "slack": 0.0,
    "growth": 0.8,
    "reference_nm": 9.0,
}
BOTH_ORDERS = {"order": 1.0, "order_2": 2.0}
TILTED = EffectValue("dial_eccentricity", BOTH_ORDERS, (1.5, 0.5, 0.4, -0.3))


def structure(search: Search, *terms: Term) -> Candidate:
    """Candidate of terms fitted jointly."""
    found = fit(search.problem, search.noise, terms, search.baseline.fit, rounds=20)
    return search.judged(found, 0.0, 0.0)


def test_gains_add_up_where_the_noise_holds_model_error() -> None:
    searched = search_of(friction(0.5), SHIFTED)
    noise = searched.noise.with_model_error(3.0)
    search = Search(searched.problem, noise, searched.library, 0)
    names = ("friction_hysteresis", "transmission_error")
    first = search.extend(search.baseline, names[0])
    assert first is not None
    both = search.extend(first, names[1])
    assert both is not None
    direct = search.chi2_gain(search.baseline.fit, both.fit)
    assert both.fit.chi2 < 0.5 * both.fit.problem.count, "fits far better than the noise"
    for name in names:
        part = search.extend(search.baseline, name)
        assert part is not None
        steps = [
            search.chi2_gain(search.baseline.fit, part.fit),
            search.chi2_gain(part.fit, both.fit),
        ]
        further = search._further_chi2(part.fit, both.fit)
        assert steps[0] + further == pytest.approx(direct)
        # Counted from step to step, the same fit would gain more by way of another one.
        assert sum(steps) > direct + 10.0


def mismatch(search: Search) -> float:
    return search.baseline.fit.rmse_deg


def term_of(value: EffectValue) -> Term:
    return Term(find(value.name), dict(value.shape))


def test_what_is_left_is_measured_against_the_noise_alone_however_it_was_fitted() -> None:
    # Measured against noise and model error, all that a law misses counted as faint, the last
    # stage judged the law by the noise alone, and it lost its name.
    search = search_of(CREEP)
    flexible = flexible_basis(search.problem, search.library)
    by_noise = search.baseline.fit
    loud = search.noise.with_model_error(20.0)
    by_both = fit(search.problem, loud, (), by_noise)
    left = visibility(by_noise, search.noise, flexible)
    assert left > 3.0 * FAINT
    assert visibility(by_both, search.noise, flexible) == pytest.approx(left, rel=0.01)


@pytest.mark.parametrize(
    ("name", "amplitudes"),
    [("transmission_error", (12.0, -5.0)), ("phase_dependent_compliance", (0.5, -0.3))],
)
def test_a_large_wave_is_fitted_whole_where_rows_count_less_for_model_error(
    name: str, amplitudes: tuple[float, float]
) -> None:
    # The size that a wave usually has outweighed the rows: of 13 deg a half was left, and free
    # offsets of the positions took the place of the law.
    search = search_of(EffectValue(name, {"order_1": 1.0}, amplitudes))
    wave = Term(find(name), {"order_1": 1.0})
    for factor in (1.0, 300.0):
        noise = search.noise.with_model_error(factor)
        found = fit(search.problem, noise, [wave], search.baseline.fit, rounds=20)
        assert found.beta[found.amplitude_places(0)] == pytest.approx(amplitudes, rel=0.03)


def test_a_small_law_of_run_offsets_that_leaves_nothing_is_no_error_of_a_larger_one() -> None:
    # Below a quarter of the drift with temperature, by size alone it was taken for its error.
    search = search_of(WARM, SHIFTED)
    found = structure(search, term_of(WARM), term_of(SHIFTED)).fit
    kept = without_model_error(found, structure(search, term_of(WARM)).fit, mismatch(search))
    assert {term.name for term in kept} == {"thermal_drift", "transmission_error"}


def test_a_small_law_of_run_offsets_as_free_as_the_runs_is_not_accepted() -> None:
    search = search_of(WARM, SHIFTED)
    orders = {"order_1": 1.0, "order_2": 2.0, "order_3": 3.0}
    free = Term(find("transmission_error"), orders)
    drift = Term(find("datum_drift"), {"push": 1.0, "memory": 0.4})
    found = structure(search, term_of(WARM), drift, free).fit
    kept = without_model_error(found, structure(search, term_of(WARM)).fit, mismatch(search))
    assert "transmission_error" not in {term.name for term in kept}


def test_what_was_accepted_and_has_shrunk_to_an_error_of_another_law_goes() -> None:
    search = search_of(CREEP)
    creep = term_of(CREEP)
    shape = {"slip_deg": 2.5, "scatter": 0.6, "skew": 0.0, "slack": 0.0}
    friction = Term(find("friction_hysteresis"), shape, None, 1e-3)
    found = structure(search, friction, creep).fit
    kept = without_model_error(found, structure(search, friction).fit, mismatch(search))
    assert {term.name for term in kept} == {"creep"}


def test_what_has_shrunk_to_a_fraction_of_what_it_was_goes_however_small_the_mismatch() -> None:
    # A stiffening that had stood for kinks was kept as a twentieth of the mismatch, and the kinks
    # then lost their name to it.
    kinks = EffectValue("clearance_takeup", {"first_nm": 9.0, "range_nm": 12.0}, (1.0,))
    search = search_of(kinks, EffectValue("contact_stiffening", {"turn_nm": 3.0}, (0.12,)))
    stiffening, takeup = Term(find("contact_stiffening"), {"turn_nm": 3.0}), term_of(kinks)
    alone, found = structure(search, stiffening).fit, structure(search, stiffening, takeup).fit
    size = float(np.std(recalibrated_twist(found, 0)))
    assert size > LEAST_OF_MISMATCH * mismatch(search)
    assert size < 0.2 * np.std(recalibrated_twist(alone, 0))
    kept = without_model_error(found, alone, mismatch(search))
    assert {term.name for term in kept} == {"clearance_takeup"}


def test_what_is_left_of_an_effect_is_what_nothing_fitted_takes_up() -> None:
    search = search_of(CREEP, SHIFTED)
    creep, shifted = term_of(CREEP), term_of(SHIFTED)
    found = structure(search, creep).fit
    largest = float(np.max(np.abs(recalibrated_twist(structure(search, creep, shifted).fit, 1))))
    assert size_left(found, shifted) == pytest.approx(largest, rel=0.1)
    assert size_left(found, creep) < 1e-6 * largest


def test_of_shapes_that_explain_the_same_the_one_with_fewer_amplitudes_is_fitted() -> None:
    # Where the positions of a recording do not tell waves apart, rounding chose among them.
    parent = search_of(SHIFTED).baseline
    scan = parent.scan
    name = "transmission_error"
    members = scan.groups[name]
    width = [len(scan.library.signatures[k].scale) for k in members]
    observed, ranks = scan.observed.copy(), scan.ranks.copy()
    rounding = 1e-10 * np.argsort(np.argsort(width))
    observed[members], ranks[members] = 200.0 + rounding, 2.0
    tied = replace(scan)
    vars(tied).update(observed=observed, ranks=ranks)
    term, _, _ = next(starting_terms(replace(parent, scan=tied), name))
    assert term.columns(parent.fit.history).shape[1] == min(width) < max(width)


def test_friction_that_is_a_curve_of_the_torque_is_not_named() -> None:
    # A presliding longer than the range makes a loop of no width, which stood for stiffening.
    search = search_of(EffectValue("contact_stiffening", {"turn_nm": 3.0}, (0.6,)))
    shape = LOADED | {"slip_deg": 38.0, "scatter": 0.11, "skew": -0.99}
    found = structure(search, Term(find("load_dependent_friction"), shape, None, 0.2))
    assert found.fit.rmse_deg < 0.7 * search.baseline.fit.rmse_deg
    (check,) = check_laws(found.fit)
    assert not check.holds


def test_friction_whose_loop_shows_is_named() -> None:
    search = search_of(EffectValue("load_dependent_friction", LOADED, (0.1,)))
    found = structure(search, Term(find("load_dependent_friction"), LOADED, None, 0.1))
    (check,) = check_laws(found.fit)
    assert check.holds


def test_a_tilted_dial_is_one_law_and_no_side_load_beside_a_dial() -> None:
    search = search_of(TILTED)
    once = Term(find("dial_eccentricity"), {"order": 1.0})
    loaded = Term(find("load_asymmetry"), {"power": 2.0})
    best = structure(search, once, loaded)
    found = freer_instead_of_others(search, best, search.start)
    assert found is not None
    assert [dict(term.shape) for term in found.fit.terms] == [BOTH_ORDERS]
    assert found.fit.rmse_deg < best.fit.rmse_deg


def test_a_plain_dial_beside_a_side_load_stays_two_effects() -> None:
    value = EffectValue("load_asymmetry", {"power": 0.7}, (0.2,))
    search = search_of(EffectValue("dial_eccentricity", {"order": 1.0}, (1.0, 0.3)), value)
    search.run()
    best = search.best()
    assert best is not None
    assert freer_instead_of_others(search, best, best) is None


def test_offsets_of_runs_are_no_noise_where_no_effect_of_the_library_gives_them() -> None:
    # As noise they were slow, of any size, and hid everything: the answer was that data are short.
    search = search_of()
    problem = search.problem
    known = tuple(each for each in effects() if each.name != "datum_drift")
    basis = flexible_basis(problem, build_library(problem.history, problem.fitted, known))
    run = problem.history.run[problem.fitted]
    for number in range(problem.history.run_count):
        offset = (run == number).astype(np.float64)
        left = offset - basis @ (basis.T @ offset)
        assert np.linalg.norm(left) < 0.05 * np.linalg.norm(offset)


def test_a_dial_beside_which_an_accepted_side_load_grows_is_not_accepted() -> None:
    # The dial takes back of the even curve what the side load has too much.
    search = search_of(EffectValue("load_asymmetry", {"orders": 2.0}, (0.9, -0.07)))
    loaded, dial = (
        Term(find("load_asymmetry"), {"power": 1.0}),
        Term(find("dial_eccentricity"), {"order": 1.0}),
    )
    alone = structure(search, loaded).fit
    both = structure(search, loaded, dial).fit
    assert np.std(recalibrated_twist(both, 0)) > 1.5 * np.std(recalibrated_twist(alone, 0))
    kept = without_model_error(both, alone, mismatch(search))
    assert {term.name for term in kept} == {"load_asymmetry"}


def test_a_dial_that_makes_a_side_load_smaller_is_accepted() -> None:
    value = EffectValue("load_asymmetry", {"power": 1.0}, (0.6,))
    search = search_of(EffectValue("dial_eccentricity", {"order": 1.0}, (-0.7, 0.6)), value)
    loaded, dial = term_of(value), Term(find("dial_eccentricity"), {"order": 1.0})
    alone = structure(search, loaded).fit
    both = structure(search, loaded, dial).fit
    kept = without_model_error(both, alone, mismatch(search))
    assert {term.name for term in kept} == {"load_asymmetry", "dial_eccentricity"}


def test_an_odd_and_an_even_curve_show_more_together_than_either_alone() -> None:
    # A dial was compared with the better one only, and so passed whatever it missed in the other.
    stiff = EffectValue("contact_stiffening", {"turn_nm": 3.0}, (0.6,))
    search = search_of(stiff, EffectValue("load_asymmetry", {"power": 1.0}, (0.3,)))
    classes, known = ClassColumns.of(search.baseline.fit), search.baseline.fit.tangent
    residual = classes.scale * search.baseline.fit.residual
    each = {name: classes.evidence(name, known, residual) for name in sorted(BOTH_CURVES)}
    together = classes.evidence_together(each, known, residual)
    alone = [found.evidence for found in each.values()]
    assert min(alone) > 20.0
    assert together > max(alone) + 0.5 * min(alone)


def test_a_position_that_moves_within_runs_gives_more_offsets_than_runs() -> None:
    history = search_of().problem.history
    assert history.crank_deg is not None
    rows = np.ones(len(history), dtype=bool)
    # Positions on both sides of a whole turn are the same.
    near = 0.02 * (history.sense > 0) - 0.01
    still = history.with_state(crank_deg=90.0 * history.run + near)
    moving = history.with_state(crank_deg=90.0 * history.run + 45.0 * (history.sense > 0))
    steady = history.with_state(crank_deg=np.linspace(0.0, 7_000.0, len(history)))
    assert offset_count(still, rows, "transmission_error") == history.run_count
    assert offset_count(moving, rows, "transmission_error") == 2 * history.run_count
    assert offset_count(moving, history.sense > 0, "transmission_error") == history.run_count
    assert offset_count(steady, rows, "transmission_error") == history.run_count
    assert offset_count(moving, rows, "datum_drift") == history.run_count


def test_the_noise_beside_what_was_accepted_is_that_of_the_next_stage() -> None:
    search = search_of(friction(5.0))
    flexible = flexible_basis(search.problem, search.library)
    accepted: list[tuple[str, ...]] = []

    def renewed(searched: Search, known: FittedStructure) -> Search:
        accepted.append(known.names)
        if len(accepted) > 1:
            return searched
        wider = searched.noise.with_sigma(2.0 * search.noise.sigma_deg)
        return Search(searched.problem, wider, searched.library, searched.seed)

    last = search_in_stages(search, flexible, lambda words: None, None, renewed)
    assert all("friction_hysteresis" in names for names in accepted)
    assert last.noise.spread_deg == pytest.approx(2.0 * search.noise.sigma_deg)


def test_a_structure_that_is_accepted_whole_stands_for_one_that_holds_too_much(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def candidate(score: float, *names: str, recognised: bool = True) -> SimpleNamespace:
        fitted = SimpleNamespace(terms=tuple(SimpleNamespace(name=name) for name in names))
        return SimpleNamespace(
            score=score, names=frozenset(names), fit=fitted, all_recognised=recognised
        )

    start = candidate(0.0, "friction")
    best = candidate(80.0, "friction", "wave", "offsets")
    whole = candidate(75.0, "friction", "offsets")
    others = [
        candidate(79.0, "friction", "bump", recognised=False),
        candidate(78.0, "offsets"),
        candidate(69.0, "friction", "drift"),
    ]
    search = SimpleNamespace(
        start=start,
        explanations=lambda: [best, *others[:2], whole, others[2]],
        suffices=lambda _: True,
    )

    def kept(fitted: SimpleNamespace, *_: object) -> tuple[SimpleNamespace, ...]:
        return tuple(term for term in fitted.terms if term.name != "wave")

    monkeypatch.setattr(acceptance, "without_model_error", kept)
    found = acceptance._accepted_whole(cast("Search", search), cast("Candidate", best), 1.0)
    assert found == [whole]
    search.suffices = lambda each: each is not whole
    assert acceptance._accepted_whole(cast("Search", search), cast("Candidate", best), 1.0) == []


def test_one_of_two_laws_that_cancel_is_accepted_and_not_none() -> None:
    """Two laws of one class whose difference is a curve, of which either alone is most of it."""
    search = search_of(EffectValue("load_asymmetry", {"power": 0.7}, (1.2,)))
    asymmetry, dial = find("load_asymmetry"), find("dial_eccentricity")
    one = structure(search, Term(asymmetry, {"power": 1.0}))
    both = structure(search, Term(asymmetry, {"power": 1.0}), Term(dial, {"order": 1.0}))
    search.visited = {each.names: replace(each, gain=100.0) for each in (one, both)}
    best = search.visited[both.names]

    def found() -> frozenset[str] | None:
        part = acceptance._without_cancelling(search, best, mismatch(search))
        return None if part is None else part.names

    laws = {"cancel": True}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(acceptance, "cancels", lambda *_: laws["cancel"])
        assert found() == one.names
        laws["cancel"] = False
        assert found() is None
        laws["cancel"] = True
        search.visited[one.names] = replace(one, gain=5.0)
        assert found() is None


@pytest.mark.parametrize(("times", "leaves"), [(1.0, False), (5.0, True)])
def test_a_fit_far_above_the_noise_leaves_something_whatever_the_tests_say(
    times: float, leaves: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    search = search_of()
    fitted = SimpleNamespace(rmse_deg=times * search.noise.spread_deg)
    best = cast("Candidate", SimpleNamespace(fit=fitted))
    decision = Decision("IDENTIFIED", best, [(best, 1.0)], unexplained=False)
    monkeypatch.setattr(identify_effects, "decide", lambda *_: decision)
    assert identify_effects._leaves_something(search) == leaves
