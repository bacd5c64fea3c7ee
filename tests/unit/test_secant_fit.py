"""Least squares with updated slopes: minima, bounds, and fewer residuals than by differences."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from cyclosweep.diagnosis.identify.fitting.secant_fit import LARGEST_STEP, minimise
from cyclosweep.simulation.effects.history import Floats

TIMES = np.linspace(0.0, 3.0, 60)
TRUE = np.array([2.0, 1.3, 0.4, 0.7])
ANYWHERE = (np.full(4, -10.0), np.full(4, 10.0))
UNITS = np.ones(4)


class Decay:
    """Residual of a decay that swings, which counts how often it is asked for."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self, values: Floats) -> Floats:
        self.asked += 1
        return self.curve(values) - self.curve(TRUE)

    @staticmethod
    def curve(values: Floats) -> Floats:
        size, rate, swing, offset = values
        return np.asarray(size * np.exp(-rate * TIMES) * np.cos(swing * TIMES) + offset)


def test_minima_are_found_with_fewer_residuals_than_by_differences() -> None:
    ours, theirs = Decay(), Decay()
    for start in ((1.0, 1.0, 0.6, 0.0), (3.0, 0.4, 0.2, 1.5), (1.5, 2.0, 0.9, 1.0)):
        found, _, _ = minimise(ours, np.array(start), ANYWHERE, UNITS, 60)
        assert np.abs(np.abs(found) - TRUE).max() < 0.02
        least_squares(theirs, np.array(start), bounds=ANYWHERE, ftol=1e-5, xtol=1e-5)
    assert ours.asked < 0.8 * theirs.asked


def test_a_minimum_beyond_a_bound_ends_at_the_bound_with_the_others_at_their_best() -> None:
    upper = np.array([10.0, 1.0, 10.0, 10.0])
    found, _, _ = minimise(Decay(), np.array([1.0, 0.5, 0.6, 0.0]), (-upper, upper), UNITS, 60)
    best = least_squares(Decay(), np.array([1.0, 0.5, 0.6, 0.0]), bounds=(-upper, upper))
    assert found[1] == 1.0
    ours, theirs = (float(np.sum(Decay()(x) ** 2)) for x in (found, best.x))
    assert ours <= 1.001 * theirs


def test_a_parameter_without_effect_does_not_stop_the_others() -> None:
    def residual(values: Floats) -> Floats:
        return np.array([values[0] - 3.0, 1e-9 * values[1], values[0] ** 2 - 9.0])

    bounds = (np.full(2, -5.0), np.full(2, 5.0))
    found, _, _ = minimise(residual, np.array([0.5, 0.0]), bounds, np.ones(2), 40)
    assert found[0] == pytest.approx(3.0, abs=1e-3)


def test_a_step_is_never_larger_than_slopes_are_worth() -> None:
    asked: list[float] = []

    def residual(values: Floats) -> Floats:
        asked.append(float(values[0]))
        return np.array([np.arctan(values[0] - 20.0), 0.1])

    minimise(residual, np.array([0.0]), (np.array([-1e3]), np.array([1e3])), np.ones(1), 1)
    assert max(asked) <= LARGEST_STEP


def test_known_slopes_are_not_measured_again() -> None:
    first = Decay()
    found, slopes, _ = minimise(first, np.array([1.0, 1.0, 0.6, 0.0]), ANYWHERE, UNITS, 60)
    fresh, known = Decay(), Decay()
    near = found + 0.05
    minimise(fresh, near, ANYWHERE, UNITS, 1)
    minimise(known, near, ANYWHERE, UNITS, 1, slopes)
    assert known.asked == fresh.asked - len(TRUE)


def test_slopes_measured_at_the_end_serve_a_residual_that_hardly_differs() -> None:
    """A refinement repeats itself with a residual that has moved a little."""

    class Moved(Decay):
        def __call__(self, values: Floats) -> Floats:
            return super().__call__(values) + 1e-5 * TIMES

    near = TRUE + 1e-4
    noisy = np.random.default_rng(3).standard_normal(len(TIMES))
    found, slopes, fresh = minimise(
        lambda values: Decay()(values) + 0.02 * noisy, near, ANYWHERE, UNITS, 60
    )
    assert fresh
    trusting, measuring = Moved(), Moved()
    one, _, _ = minimise(trusting, found, ANYWHERE, UNITS, 60, slopes, fresh=True)
    other, _, _ = minimise(measuring, found, ANYWHERE, UNITS, 60, slopes)
    assert trusting.asked < measuring.asked
    assert one == pytest.approx(other, abs=1e-3)


def test_slopes_of_a_search_that_ran_out_of_steps_are_not_called_fresh() -> None:
    """Taken for measured ones, they ended a friction at a hundred times its misfit."""
    _, _, fresh = minimise(Decay(), np.array([1.0, 1.0, 0.6, 0.0]), ANYWHERE, UNITS, 3)
    assert not fresh
