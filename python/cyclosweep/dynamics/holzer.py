"""Holzer's table: angles and torques along a train that is shaken at one frequency."""

from __future__ import annotations

import math

import polars as pl

from cyclosweep.dynamics.train import Train

__all__ = ["holzer_table"]


def holzer_table(train: Train, omega_rad_per_s: float) -> pl.DataFrame:
    """Angles of the nodes and torques behind them when the first node swings by one radian.

    Parameters
    ----------
    train : Train
        A train without play; with play its springs count as beyond it.
    omega_rad_per_s : float
        Angular frequency [rad/s].

    Returns
    -------
    polars.DataFrame
        ``node``, ``angle_rad`` and ``torque_nm``: sum of the inertia torques up to and with the
        node [N m], all referred to the first shaft. At a natural frequency of a free train the
        last torque is zero.

    References
    ----------
    W. T. Thomson, *Theory of Vibration with Applications*, section on Holzer's method.

    Examples
    --------
    >>> table = holzer_table(Train([5.0, 11.0, 22.0], [1e5, 2e5]), 20.0)
    >>> [round(angle, 4) for angle in table["angle_rad"]]
    [1.0, 0.98, 0.9484]
    """
    inertias = [j / r**2 for j, r in zip(train.inertias_kg_m2, train.node_ratios, strict=True)]
    stiffnesses = train.stiffnesses_at() / train.spring_ratios**2
    square = omega_rad_per_s * omega_rad_per_s
    angle, torque = 1.0, 0.0
    rows = []
    for k, inertia in enumerate(inertias):
        torque += inertia * square * angle
        rows.append((train.names[k], angle, torque))
        angle -= torque / float(stiffnesses[k]) if k < len(stiffnesses) else math.nan
    return pl.DataFrame(rows, schema=["node", "angle_rad", "torque_nm"], orient="row")
