"""Torque and angle read from each other's column: what shows it."""

from math import log

import numpy as np

from cyclosweep.recording import Recording

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


def are_exchanged(recording: Recording, compliance: float, nominal: float) -> bool:
    """Whether compliance and readings look as if torque and angle were exchanged.

    Parameters
    ----------
    recording : Recording
        What was measured, with an angle.
    compliance : float
        As it was found, above zero [deg/(N m)].
    nominal : float
        By the drive's file, above zero [deg/(N m)].

    Returns
    -------
    bool
    """
    torque, angle = np.abs(recording.torque_nm), np.abs(np.asarray(recording.angle_deg))
    biased = torque.min() > FAR_FROM_ZERO * torque.max()
    unloaded = angle.min() < NEAR_ZERO * angle.max()
    return bool(biased and unloaded and abs(log(compliance * nominal)) < NEAR)
