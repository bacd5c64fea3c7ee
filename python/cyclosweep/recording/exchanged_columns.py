"""Torque and angle read from each other's column: what shows it."""

from math import log

import numpy as np

from cyclosweep.recording.nominal import slope_of
from cyclosweep.recording.samples import Floats

__all__ = ["EXCHANGED", "are_exchanged"]

FAR_FROM_ZERO, NEAR_ZERO = 0.2, 0.05
"""Least size over the largest, from which the torque never comes near zero, and up to which the
angle does: a torque is unloaded in nearly every test, and an angle stands wherever its zero is."""
NEAR = log(1.5)
"""How far the compliance may be from what the exchange makes of it, as a logarithm: effects that
the drive has are exchanged, too."""
EXCHANGED = (
    "torque and angle were read from each other's column (the torque never comes near zero, the "
    "angle does)"
)


def are_exchanged(torque_nm: Floats, angle_deg: Floats, nominal: float) -> bool:
    """Whether compliance and readings look as if torque and angle were exchanged.

    The compliance is that of straight lines, whose jump at zero torque may be negative, as a play
    becomes by the exchange.

    Parameters
    ----------
    torque_nm : ndarray of float, shape (n,)
        What was read as the torque [N m].
    angle_deg : ndarray of float, shape (n,)
        What was read as the angle [deg].
    nominal : float
        Compliance by the drive's file, above zero [deg/(N m)].

    Returns
    -------
    bool
    """
    compliance = slope_of(torque_nm, angle_deg)
    if compliance is None:
        return False
    known = np.isfinite(torque_nm) & np.isfinite(angle_deg)
    torque, angle = np.abs(torque_nm[known]), np.abs(angle_deg[known])
    biased = torque.min() > FAR_FROM_ZERO * torque.max()
    unloaded = angle.min() < NEAR_ZERO * angle.max()
    return bool(biased and unloaded and abs(log(compliance * nominal)) < NEAR)
