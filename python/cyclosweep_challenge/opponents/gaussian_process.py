"""A Gaussian process on the residual: looks for a smooth function of the state in it."""

from __future__ import annotations

import warnings

import numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from cyclosweep_challenge.opponents.view import RecordingView, Reply

POINTS = 300


def gaussian_process(view: RecordingView) -> Reply:
    """Gain in log marginal likelihood over white noise, on averages of neighbouring readings.

    Inputs are torque, direction, run, time in the recording, position and temperature, each of
    unit spread. Readings are averaged in ``POINTS`` blocks, which keeps more of the recording
    than picking as many of them would.
    """
    inputs = np.column_stack(
        [
            view.torque_nm,
            view.direction * np.std(view.torque_nm),
            view.run,
            view.time_s,
            np.cos(np.deg2rad(view.crank_deg)),
            np.sin(np.deg2rad(view.crank_deg)),
            view.temperature_c,
        ]
    )
    spread = inputs.std(axis=0)
    inputs = inputs[:, spread > 1e-9] / spread[spread > 1e-9]
    blocks = np.array_split(np.arange(view.residual.size), POINTS)
    x = np.array([inputs[b].mean(axis=0) for b in blocks])
    y = np.array([view.residual[b].mean() for b in blocks])
    y = (y - y.mean()) / y.std()
    start = ConstantKernel(0.3, (1e-4, 1e2)) * RBF(np.ones(x.shape[1]), (0.05, 1e3))
    kernel = start + WhiteKernel(0.7, (1e-3, 1e1))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        process = GaussianProcessRegressor(kernel, random_state=0).fit(x, y)
    white = -0.5 * y.size * (np.log(2.0 * np.pi) + 1.0)
    gain = float(process.log_marginal_likelihood_value_ - white)
    # At its defaults the richer kernel is believed if it beats white noise by its parameters.
    return Reply(gain, gain > len(kernel.theta) - 1, None)
