"""Angles known only modulo a period, as a geared encoder gives them, put together again."""

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording.faults import Fault
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.signals import unwrap
from cyclosweep.recording.structure import DEAD_ZONE_SHARE

__all__ = ["modulo_fault", "unwrap_with_torque"]

AGAINST_TORQUE_SHARE = 0.05
"""Where the torque changes sign, the twist follows it through the play. A step the other way beyond
this share of the period is no noise: the shaft went the longer way round."""


def unwrap_with_torque(
    angle_deg: Floats, torque_nm: Floats, run: NDArray[np.generic], period: float
) -> tuple[Floats, int, int]:
    """Undo wraps; through the play the shaft is taken to have turned the way the torque went.

    Between two readings the shorter way round is right as long as the shaft turns by less than
    half a period. Through the play it turns by all of it at once, which may be more; where the
    torque changes sign the way is known, and steps up to 95 % of a period are put together.

    Parameters
    ----------
    angle_deg : ndarray of float, shape (n,)
        Angle as read [deg], in file order.
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].
    run : ndarray, shape (n,)
        Trial each sample belongs to.
    period : float
        What the angle is known up to a multiple of [deg].

    Returns
    -------
    angle_deg : ndarray of float, shape (n,)
        Unwrapped [deg].
    wraps : int
        Number of wraps undone.
    by_torque : int
        How many of them the torque decided.

    Examples
    --------
    A play of 56 deg read by an encoder that repeats every 60 deg:

    >>> torque = np.array([2.0, 1.0, -1.0, -2.0])
    >>> unwrap_with_torque(np.array([32.0, 30.0, 34.0, 32.0]), torque, np.ones(4), 60.0)
    (array([ 32.,  30., -26., -28.]), 1, 1)
    """
    unwrapped, wraps = unwrap(angle_deg, period)
    known = np.flatnonzero(np.isfinite(angle_deg) & np.isfinite(torque_nm))
    if len(known) < 3:
        return unwrapped, wraps, 0
    step, change = np.diff(unwrapped[known]), np.diff(torque_nm[known])
    crossing = _crossings(torque_nm[known], run[known])
    sense = np.sign(np.sum((step * np.sign(change))[~crossing]))
    against = -step * np.sign(change) * sense
    turned = crossing & (against > AGAINST_TORQUE_SHARE * period)
    if not turned.any():
        return unwrapped, wraps, 0
    more = np.zeros(len(angle_deg))
    more[known[1:]] = np.where(turned, sense * np.sign(change) * period, 0.0)
    # A wrap that the shorter way made may be the one that is taken back.
    before = np.rint((step - np.diff(angle_deg[known])) / period)
    after = before + np.rint(more[known[1:]] / period)
    count = int(np.count_nonzero(after))
    return unwrapped + np.cumsum(more), count, int(np.count_nonzero(turned))


def modulo_fault(
    angle_deg: Floats,
    torque_nm: Floats,
    run: NDArray[np.generic],
    modulo_deg: float,
    play_deg: float | None = None,
) -> Fault | None:
    """Say where an angle known modulo a period cannot be put together with certainty.

    Parameters
    ----------
    angle_deg : ndarray of float, shape (n,)
        Angle, unwrapped [deg].
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].
    run : ndarray, shape (n,)
        Trial each sample belongs to.
    modulo_deg : float
        The period [deg].
    play_deg : float, optional
        Whole free play of the drive file at the measured shaft [deg], from one flank to the other.

    Returns
    -------
    Fault or None
        A remark, which forces no verdict; None where no step between two readings comes near
        half the period and the drive's play does neither, or is read in several steps.
    """
    if len(angle_deg) < 2:
        return None
    step = np.abs(np.diff(angle_deg))
    crossing = _crossings(torque_nm, run)
    within = np.diff(run) == 0
    largest = float(step[within].max(initial=0.0))
    outside = np.abs(torque_nm) > DEAD_ZONE_SHARE * np.abs(torque_nm).max()
    unread = int(np.count_nonzero(crossing & outside[1:] & outside[:-1]))
    by_play = play_deg is not None and unread > 0 and play_deg > 0.5 * modulo_deg
    if largest <= 0.4 * modulo_deg and not by_play:
        return None
    if by_play:
        found = (
            f"the free play of the drive file is {play_deg:.3g} deg and {unread} times it is "
            "passed between two readings"
        )
    else:
        found = f"between two readings it moves by up to {largest:.3g} deg"
    reason = (
        f"The angle is known modulo {modulo_deg:g} deg only, and {found}: a whole modulo more or "
        "less would read the same, and with it free play and offset. Read more often where the "
        "torque changes sign, or take an encoder that repeats less often."
    )
    return Fault("modulo_too_small", None, reason)


def _crossings(torque_nm: Floats, run: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Steps of one run over which the torque changes sign.

    Parameters
    ----------
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].
    run : ndarray, shape (n,)
        Trial each sample belongs to.

    Returns
    -------
    ndarray of bool, shape (n - 1,)
    """
    return np.asarray((torque_nm[1:] * torque_nm[:-1] < 0) & (run[1:] == run[:-1]))
