"""Order of a staircase: whether its steps come at equal distances along the travel, and at which.

A torque that pulsates with the poles of a motor or the teeth of a mesh is rich in harmonics and
differs with the direction and the side of the load, so that no single wave explains much of it.
Its spectrum tells it all the same: the torque at equal angle has peaks at one order and at its
multiples. Steps that come at random places, however well they repeat, have none.
"""

from collections.abc import Sequence

import numpy as np

from cyclosweep.diagnosis.identify.fitting.repetition import StepOrder
from cyclosweep.diagnosis.whole_loop.step_spectrum import (
    HARMONICS,
    Leg,
    enough,
    legs_in,
    length_deg,
    orders_in,
    step_spectrum,
)
from cyclosweep.simulation.effects.history import Floats, Ints

ALIKE = 0.7
"""Length of the sum of the waves of a side over the sum of their lengths from which its crest is
stated."""
CERTAIN = 0.05
"""Share of random staircases of at least as clear an order up to which the order is stated."""


def step_order(torque_nm: Floats, angle_deg: Floats, run: Ints, seed: int = 0) -> StepOrder | None:
    """Look for the order of a staircase.

    All rows are read, also those that are neither fitted nor scored: the steps are in them, too.

    Parameters
    ----------
    torque_nm, angle_deg : ndarray, shape (n,)
        Torque [N m] and angle [deg] in the order of the recording.
    run : ndarray of int, shape (n,)
        Run of each row.
    seed : int
        Seed of the random staircases.

    Returns
    -------
    StepOrder or None
        None where legs are too few or too short, or where random staircases show as clear an order.
    """
    legs = list(legs_in(torque_nm, angle_deg, run))
    if not enough(legs):
        return None
    length = length_deg(legs)
    spectrum = step_spectrum(legs, orders_in(length), np.random.default_rng(seed))
    if spectrum.chance > CERTAIN:
        return None
    order = float(spectrum.cycles_per_deg[spectrum.clearest])
    return StepOrder(order, apart(length, order), spectrum.chance, _crests(legs, order))


def apart(length: float, order: float) -> float:
    """Share of an order by which another one must differ to be told from it.

    Parameters
    ----------
    length : float
        Length of a leg.
    order : float
        Cycles in the unit of the length.

    Returns
    -------
    float
    """
    return 1.0 / (HARMONICS * length * order)


def _crests(legs: Sequence[Leg], order: float) -> dict[int, float]:
    """Angle at which the torque is largest, by the side of the load, where its legs agree.

    Parameters
    ----------
    legs : sequence of Leg
    order : float
        Cycles a degree.

    Returns
    -------
    dict of int to float
        In deg, the first one at or above zero.
    """
    found = {}
    for side in sorted({leg.side for leg in legs}):
        waves = np.array([
            np.mean(leg.torque_nm * np.exp(-2j * np.pi * order * leg.angle_deg))
            for leg in legs
            if leg.side == side
        ])  # fmt: skip
        if np.abs(waves.sum()) > ALIKE * np.abs(waves).sum():
            turn = float(-np.angle(waves.sum()) / (2 * np.pi))
            found[side] = (turn % 1.0) / order
    return found
