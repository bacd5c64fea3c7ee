"""Calibration with a Gaussian-process discrepancy, after Kennedy and O'Hagan.

The angle is datum, play and compliance, each free, plus a smooth discrepancy of torque, direction
and load history, plus noise; all are fitted together by the marginal likelihood [1]_.

References
----------
.. [1] M. C. Kennedy and A. O'Hagan, "Bayesian calibration of computer models," Journal of the Royal
   Statistical Society B, vol. 63, no. 3, pp. 425-464, 2001, doi: 10.1111/1467-9868.00294.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Kernel, WhiteKernel

from cyclosweep_challenge.opponents.view import RecordingView, Reply

Array = NDArray[np.float64]

POINTS = 250
"""Averages of neighbouring readings that are fitted; the effort rises with its cube."""
WIDE = 1e4
"""Prior variance of the calibration's parameters over that of the residual: next to flat."""
BASELINE = 3
"""First columns of the inputs: one, direction of the play, torque."""


class Linear(Kernel):  # type: ignore[misc]
    """Covariance of a straight line in the first columns with wide priors; nothing to be fitted."""

    def __init__(self) -> None:
        """Take no parameters, which scikit-learn asks to be said."""

    def __call__(self, X: Array, Y: Array | None = None, eval_gradient: bool = False) -> Any:
        """Covariance of rows, shape (n, m)."""
        other = X if Y is None else Y
        value = WIDE * X[:, :BASELINE] @ other[:, :BASELINE].T
        return (value, np.zeros((*value.shape, 0))) if eval_gradient else value

    def diag(self, X: Array) -> Array:
        """Variance of every row."""
        return np.asarray(WIDE * np.sum(X[:, :BASELINE] ** 2, axis=1))

    def is_stationary(self) -> bool:
        """Return that the covariance depends on place."""
        return False


def kennedy_ohagan(view: RecordingView) -> Reply:
    """Gain in log marginal likelihood of the discrepancy over calibration and noise alone.

    Inputs of the discrepancy are torque, direction, torque at the last reversal and the last run's
    last turning point, each of unit spread; length scales are fitted.
    """
    torque = view.torque_nm
    reversal = _last_reversal(view)
    state = np.column_stack([torque, view.direction, reversal, view.last_extreme])
    spread = state.std(axis=0)
    state = state[:, spread > 1e-9] / spread[spread > 1e-9]
    line = np.column_stack([np.ones_like(torque), np.sign(torque), torque / np.abs(torque).max()])
    inputs = np.column_stack([line, state])
    blocks = np.array_split(np.arange(torque.size), min(POINTS, torque.size))
    x = np.array([inputs[b].mean(axis=0) for b in blocks])
    y = np.array([view.residual[b].mean() for b in blocks])
    y = y / max(float(y.std()), 1e-12)
    # The baseline's columns get no length scale of their own: so long that they do not count.
    scales = np.r_[np.full(BASELINE, 1e6), np.ones(state.shape[1])]
    bounds = np.array([(1e6, 1.0001e6)] * BASELINE + [(0.05, 1e3)] * state.shape[1])
    discrepancy = ConstantKernel(0.3, (1e-4, 1e2)) * RBF(scales, bounds)
    noise = WhiteKernel(0.7, (1e-4, 1e1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        alone = GaussianProcessRegressor(Linear() + noise, random_state=0).fit(x, y)
        both = GaussianProcessRegressor(Linear() + discrepancy + noise, random_state=0).fit(x, y)
    gain = float(both.log_marginal_likelihood_value_ - alone.log_marginal_likelihood_value_)
    return Reply(gain, gain > 1 + state.shape[1], None)


def _last_reversal(view: RecordingView) -> Array:
    """Torque at the last reversal within the run, zero before the first [N m]."""
    out = np.zeros_like(view.torque_nm)
    held = 0.0
    for k in range(1, out.size):
        if view.run[k] != view.run[k - 1]:
            held = 0.0
        elif view.direction[k] != view.direction[k - 1]:
            held = float(view.torque_nm[k - 1])
        out[k] = held
    return out
