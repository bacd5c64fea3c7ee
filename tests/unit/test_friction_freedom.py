"""What is found out about friction after its first fit: how runs began, and what it forgets."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student_t

import cyclosweep as cs
import cyclosweep.diagnosis.identify_effects as identify_effects
from cyclosweep.diagnosis import friction_in_noise
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.friction_first import PARAMETER_CHARGE, from_better_start
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise_estimate import estimate_noise
from cyclosweep.diagnosis.whole_loop.forecast import fit_forecast, starting_model
from cyclosweep.diagnosis.whole_loop.usual_loop import freer_where_it_pays
from cyclosweep.simulation.effects import effects
from cyclosweep.simulation.model import EffectValue
from cyclosweep_challenge.scoreboard.made import Recipe, make
from tests.support.long_recording import friction
from tests.support.searches import search_of as calibrated_search

DRIVE = cs.Drive.reference_87()
SHAPE = {"slip_deg": 4.0, "scatter": 0.6, "skew": 0.5}
FREE_PLAY_DEG = 28.0


def recording(**friction: float) -> cs.Recording:
    """A programme of several runs, the twist by friction of a known law."""
    programme = make(Recipe(4_420))
    value = EffectValue("friction_hysteresis", {**SHAPE, **friction}, (2.0,))
    model = cs.Model(2.5, FREE_PLAY_DEG, 0.0, effects=(value,))
    angle = cs.simulate(model, programme).angle_deg
    assert angle is not None
    noise = np.random.default_rng(5).normal(0.0, 0.05, angle.size)
    return programme.with_angle(angle + noise)


class CapturedError(Exception):
    """The search, as soon as its stages begin."""


@pytest.fixture
def search_of(monkeypatch: pytest.MonkeyPatch) -> Callable[[cs.Recording], Search]:
    """Search of a recording in the state in which its stages begin."""
    kept: list[Search] = []

    def capture(search: Search, *_: object) -> None:
        kept.append(search)
        raise CapturedError

    monkeypatch.setattr(identify_effects, "search_in_stages", capture)

    def run(made: cs.Recording) -> Search:
        with pytest.raises(CapturedError):
            cs.diagnose(made, DRIVE, full=False)
        return kept[-1]

    return run


def test_friction_that_was_taken_for_noise_is_not_looked_for_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun: list[FittedStructure | None] = []

    def capture(
        _: Search, flexible: object, say: object, known: FittedStructure | None, renewed: object
    ) -> None:
        begun.append(known)
        raise CapturedError

    monkeypatch.setattr(identify_effects, "search_in_stages", capture)
    with pytest.raises(CapturedError):
        cs.diagnose(recording(slack=0.0), DRIVE, full=False)
    (known,) = begun
    assert known is not None
    assert known.names == ("friction_hysteresis",)


def friction_term(slack: float) -> Term:
    effect = next(each for each in effects() if each.name == "friction_hysteresis")
    return Term(effect, {**SHAPE, "slack": slack}, None, 2.0)


@pytest.mark.parametrize("slack", [0.0, 1.0])
def test_the_state_in_which_runs_began_is_found_from_either(
    slack: float, search_of: Callable[[cs.Recording], Search]
) -> None:
    search = search_of(recording(slack=slack))
    noise = search.noise
    for begun in (0.0, 1.0):
        terms = (friction_term(begun),)
        first = fit(search.problem, noise, terms, search.baseline.fit, rounds=20)
        best = from_better_start(noise, first, PARAMETER_CHARGE)
        assert best.terms[0].shape["slack"] == slack
        assert (best is first) == (begun == slack)


@pytest.mark.parametrize("forgetting", [0.0, 1.0])
def test_whole_loops_are_fitted_with_friction_that_forgets_only_where_it_does(
    forgetting: float, search_of: Callable[[cs.Recording], Search]
) -> None:
    law = {"forgetting": forgetting} if forgetting else {}
    problem = search_of(recording(slack=0.0, **law)).problem
    term = friction_term(0.0)
    value = EffectValue(term.name, term.shape, (2.0,))
    begun = replace(starting_model(problem), effects=(value,))
    usual = fit_forecast(problem, begun, (term,), zero=False, most=10)
    freed = freer_where_it_pays(problem, usual)
    assert ("forgetting" in freed.terms[0].shape) == bool(forgetting)
    if forgetting:
        assert freed.error_deg < 0.7 * usual.error_deg


@pytest.mark.parametrize(
    ("correlation", "tail", "looked_for"),
    [(0.45, np.inf, True), (0.1, 3.0, True), (0.1, np.inf, False), (0.1, 12.0, False)],
)
def test_friction_is_looked_for_in_noise_that_is_slow_or_has_heavy_tails(
    correlation: float, tail: float, looked_for: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[Search] = []

    def capture(search: Search, _: object) -> None:
        tried.append(search)

    monkeypatch.setattr(friction_in_noise, "friction_first", capture)
    search = calibrated_search(EffectValue("creep", {"time_constant_s": 20.0}, (6.0,)))
    flexible = flexible_basis(search.problem, search.library)
    search.noise = replace(search.noise, best_correlation=correlation, tail=tail, structured=False)
    found = friction_in_noise.without_hidden_friction(search, flexible)
    assert found == (search, flexible, None)
    assert (len(tried) > 0) == looked_for


@pytest.mark.parametrize(
    ("correlation", "tail", "is_model_error"),
    [(0.95, 4.0, True), (0.95, np.inf, False), (0.5, 4.0, False)],
)
def test_slow_noise_with_heavy_tails_beside_friction_is_error_of_the_model(
    *, correlation: float, tail: float, is_model_error: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A drift of 1.1 deg was within noise of 1 deg; rows differ by 0.02 deg."""
    search = calibrated_search(friction(1.0))
    flexible = flexible_basis(search.problem, search.library)
    fitted = fit(search.problem, search.noise, (friction_term(0.0),), search.baseline.fit)
    left = replace(search.noise, best_correlation=correlation, tail=tail)
    search.noise = replace(search.noise, best_correlation=0.96, tail=2.6)
    monkeypatch.setattr(friction_in_noise, "friction_first", lambda *_: fitted)
    monkeypatch.setattr(friction_in_noise, "noise_left", lambda *_, **__: left)
    monkeypatch.setattr(friction_in_noise, "is_likelier", lambda *_: True)
    found, _, known = friction_in_noise.without_hidden_friction(search, flexible)
    assert known is not None
    assert found.noise.structured == is_model_error


@pytest.mark.parametrize(
    ("correlation", "left_share", "gain", "believed"),
    [
        (0.96, 0.2, 30.0, True),
        (0.96, 0.2, 10.0, False),
        (0.96, 0.4, 30.0, False),
        (0.96, 0.4, 200.0, True),
        (0.6, 0.2, 30.0, False),
    ],
)
def test_friction_in_place_of_a_drift_is_believed_where_it_leaves_little(
    *,
    correlation: float,
    left_share: float,
    gain: float,
    believed: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = calibrated_search(friction(1.0))
    flexible = flexible_basis(search.problem, search.library)
    fitted = fit(search.problem, search.noise, (friction_term(0.0),), search.baseline.fit)
    search.noise = replace(search.noise, best_correlation=correlation, tail=np.inf)
    sigma = search.noise.sigma_deg * np.exp(-gain / len(search.noise.gap))
    smaller = replace(search.noise, sigma_deg=sigma)
    error = property(lambda each: left_share if each.terms else 1.0)
    monkeypatch.setattr(friction_in_noise, "friction_first", lambda *_: fitted)
    monkeypatch.setattr(friction_in_noise, "noise_left", lambda *_, **__: smaller)
    monkeypatch.setattr(FittedStructure, "rmse_deg", error)
    found, _, known = friction_in_noise.without_hidden_friction(search, flexible)
    assert (known is not None) == believed
    assert (found.noise is smaller) == believed


@pytest.mark.parametrize("freedom", [2.6, 3.2, 4.0, 7.0])
def test_the_likelihood_of_noise_is_that_of_its_rows(freedom: float) -> None:
    # By the standard deviation alone, which belongs to the tails, rows of lighter tails are far
    # likelier.
    rows = 3_000
    left = 0.05 * student_t(freedom).rvs(rows, random_state=7)
    basis = np.ones((rows, 1)) / np.sqrt(rows)
    gap, weight = np.zeros(rows), np.ones(rows)
    noise = estimate_noise(left, basis, gap, 0.0, weight)
    scale = noise.sigma_deg * np.sqrt((noise.tail - 2.0) / noise.tail)
    exact = float(student_t(noise.tail, scale=scale).logpdf(left - left.mean()).sum())
    constant = 0.5 * rows * (np.log(2.0 * np.pi) + 1.0)
    assert friction_in_noise.log_likelihood(noise) - constant == pytest.approx(exact, abs=6.0)
