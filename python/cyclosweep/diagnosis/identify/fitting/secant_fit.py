"""Least squares whose slopes are updated from step to step instead of being measured at each.

The secant version of the Levenberg-Marquardt method (Madsen, Nielsen and Tingleff, Methods for
Non-Linear Least Squares Problems, 2004, section 3.5) within bounds. Each residual here costs a path
of the shaft, and slopes by differences cost one a parameter: SciPy's solver, which measures them in
every iteration, needs three to four times as many.
"""

from collections.abc import Callable

import numpy as np

from cyclosweep.simulation.effects.history import Flags, Floats

DIFFERENCE = 1e-3
"""Step by which slopes are measured, over the usual change of a parameter."""
LEAST_GAIN = 1e-5
"""Share of the sum of squares below which a step is not worth taking."""
LEAST_STEP = 1e-5
"""The same for the step itself, over the usual change of a parameter."""
LARGEST_STEP = 3.0
"""Largest step of a parameter that stays within its bounds, in usual changes: further off the
slopes say nothing."""
FIRST_DAMPING, MOST_DAMPING = 1e-3, 1e6
"""Damping of the first step over the curvature, and from which no step is left to try."""


def minimise(
    residual: Callable[[Floats], Floats],
    start: Floats,
    bounds: tuple[Floats, Floats],
    scale: Floats,
    most: int,
    slopes: Floats | None = None,
    *,
    fresh: bool = False,
) -> tuple[Floats, Floats, bool]:
    """Minimise a sum of squares from a start.

    Parameters
    ----------
    residual : callable
        From parameters to residuals, shape (n,).
    start : ndarray, shape (p,)
        Parameters, within the bounds.
    bounds : pair of ndarray, shape (p,)
        Lower and upper bounds.
    scale : ndarray, shape (p,)
        Usual change of each parameter.
    most : int
        Most steps that are tried.
    slopes : ndarray, shape (n, p), optional
        Slopes near the start, by usual changes; measured where they are not given.
    fresh : bool
        Whether these slopes were measured at the start, if for a residual that differed a little.

    Returns
    -------
    values : ndarray, shape (p,)
        The best parameters.
    slopes : ndarray, shape (n, p)
        Slopes there, by usual changes.
    fresh : bool
        Whether these slopes were measured there.
    """
    values, left = start, residual(start)
    damping, measurable, settled = FIRST_DAMPING, not fresh, False
    if slopes is None:
        slopes, fresh = _measured(residual, values, left, bounds, scale), True
    since_measured = 0 if fresh else most
    for _ in range(most):
        step, damping = _bounded_step(slopes, left, values, bounds, scale, damping)
        moved = np.clip(values + scale * step, *bounds)
        change = slopes @ step
        promised = -float(change @ (2.0 * left + change))
        gain = 0.0
        if promised > LEAST_GAIN * float(left @ left) and np.abs(step).max() >= LEAST_STEP:
            there = residual(moved)
            slopes = slopes + np.outer(there - left - change, step) / float(step @ step)
            gain = float(left @ left) - float(there @ there)
        elif fresh or not measurable:
            settled = True
            break
        if gain > 0.0:
            values, left, fresh = moved, there, False
            since_measured += 1
            damping *= 0.2 if gain > 0.5 * promised else 1.0
        elif fresh or not measurable:
            damping = 10.0 * max(damping, FIRST_DAMPING)
            if damping > MOST_DAMPING:
                break
        else:
            slopes = _measured(residual, values, left, bounds, scale)
            fresh, measurable, since_measured = True, False, 0
    return values, slopes, settled and since_measured <= 1


def _measured(
    residual: Callable[[Floats], Floats],
    values: Floats,
    left: Floats,
    bounds: tuple[Floats, Floats],
    scale: Floats,
) -> Floats:
    """Slopes of a residual by usual changes of the parameters, by differences.

    Parameters
    ----------
    residual : callable
        From parameters to residuals, shape (n,).
    values : ndarray, shape (p,)
        Parameters.
    left : ndarray, shape (n,)
        Residual there.
    bounds : pair of ndarray, shape (p,)
    scale : ndarray, shape (p,)
        Usual change of each parameter.

    Returns
    -------
    ndarray, shape (n, p)
    """
    slopes = np.empty((len(left), len(values)))
    for k, size in enumerate(scale):
        ahead = values.copy()
        ahead[k] += DIFFERENCE * size
        if ahead[k] > bounds[1][k]:
            ahead[k] = max(values[k] - DIFFERENCE * size, bounds[0][k])
        slopes[:, k] = (residual(ahead) - left) * (size / (ahead[k] - values[k]))
    return slopes


def _bounded_step(
    slopes: Floats,
    left: Floats,
    values: Floats,
    bounds: tuple[Floats, Floats],
    scale: Floats,
    damping: float,
) -> tuple[Floats, float]:
    """Damped step of no more than a few usual changes that stays within the bounds.

    Parameters that the step would take out of their bounds are moved to them, and the others find
    their step once more.

    Parameters
    ----------
    slopes : ndarray, shape (n, p)
        By usual changes.
    left : ndarray, shape (n,)
        Residual.
    values : ndarray, shape (p,)
        Parameters.
    bounds : pair of ndarray, shape (p,)
    scale : ndarray, shape (p,)
        Usual change of each parameter.
    damping : float
        Over the curvature along each parameter; raised until the step is small enough and promises
        to gain.

    Returns
    -------
    step : ndarray, shape (p,)
        In usual changes.
    damping : float
        With which it was found.
    """
    lowest, highest = ((bound - values) / scale for bound in bounds)
    curvature, gradient = slopes.T @ slopes, slopes.T @ left
    while True:
        step, free = np.zeros(len(values)), np.ones(len(values), dtype=bool)
        for _ in range(len(values)):
            step[free] = _damped(curvature, gradient + curvature @ (step * ~free), free, damping)
            out = free & ((step < lowest) | (step > highest))
            if not np.any(out):
                break
            step[out] = np.clip(step, lowest, highest)[out]
            free &= ~out
        step = np.clip(step, lowest, highest)
        small = np.abs(step[free]).max(initial=0.0) <= LARGEST_STEP
        falls = float(step @ (2.0 * gradient + curvature @ step)) <= 0.0
        if (small and falls) or damping > MOST_DAMPING:
            return step, damping
        damping *= 10.0


def _damped(curvature: Floats, gradient: Floats, free: Flags, damping: float) -> Floats:
    """Step of the parameters that are free to move, shape (free,), in usual changes.

    Parameters
    ----------
    curvature : ndarray, shape (p, p)
    gradient : ndarray, shape (p,)
        Of half the sum of squares.
    free : ndarray of bool, shape (p,)
    damping : float
        Over the curvature along each parameter.

    Returns
    -------
    ndarray
    """
    part = curvature[np.ix_(free, free)]
    along = np.diag(part)
    held = damping * np.maximum(along, 1e-6 * float(along.max(initial=0.0)) + 1e-300)
    try:
        return np.asarray(np.linalg.solve(part + np.diag(held), -gradient[free]))
    except np.linalg.LinAlgError:
        # Two parameters that do the same, undamped: the shortest of the steps.
        return np.asarray(np.linalg.lstsq(part + np.diag(held), -gradient[free], rcond=None)[0])
