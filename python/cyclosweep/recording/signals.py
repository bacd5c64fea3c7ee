"""Properties read off torque and angle signals: wraps, sign, resolution, clock ticks."""

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording.samples import Floats

REGULAR = 0.95
"""Share of readings that go on by the same step from which an angle advances regularly,"""
REPEATED = 0.25
"""without those at which the torque goes less than this share of what it does between others."""

EXACT = 1e-3
"""Distance of readings from the marks of a dial, in its steps, up to which they lie on them."""
AS_PRINTED, MANY_LEVELS = 0.02, 12
"""The same of an encoder whose readings were rounded again as they were printed, and from how many
different readings this is no accident."""


def unwrap(values: Floats, period: float) -> tuple[Floats, int]:
    """Undo wraps: steps beyond half a period are taken as the shorter way round.

    Parameters
    ----------
    values : ndarray of float, shape (n,)
        Signal in file order; non-finite samples are passed over.
    period : float
        Where it wraps [unit of the signal].

    Returns
    -------
    unwrapped : ndarray of float, shape (n,)
    count : int
        Number of wraps undone.

    Examples
    --------
    >>> unwrap(np.array([350.0, 5.0, 355.0]), 360.0)
    (array([350., 365., 355.]), 2)
    """
    finite = np.isfinite(values)
    known = values[finite]
    turns = np.rint(np.diff(known, prepend=known[:1]) / period)
    unwrapped = values.copy()
    unwrapped[finite] = known - period * np.cumsum(turns)
    return unwrapped, int(np.count_nonzero(turns))


def wraps_at_360(angle_deg: Floats, torque_nm: Floats) -> bool:
    """Whether a dial of one turn jumps from one of its ends to the other.

    All readings must lie within one turn, some step must exceed half of it, and the unwrapped
    angle must follow the torque no worse: a soft drive that is loaded the other way between two
    readings also makes a long step, but a true one.

    Parameters
    ----------
    angle_deg : ndarray of float, shape (n,)
        Angle as read [deg].
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].

    Returns
    -------
    bool
    """
    if len(angle_deg) < 2:
        return False
    low, high = float(angle_deg.min()), float(angle_deg.max())
    one_turn = (low >= 0 and high <= 360) or (low >= -180 and high <= 180)
    if not one_turn or np.abs(np.diff(angle_deg)).max() <= 180:
        return False
    unwrapped, _ = unwrap(angle_deg, 360.0)
    return not _relation(torque_nm, unwrapped) < _relation(torque_nm, angle_deg)


def _relation(a: Floats, b: Floats) -> float:
    """Magnitude of the correlation of two signals.

    Parameters
    ----------
    a, b : ndarray of float, shape (n,)
        The signals, in any unit.

    Returns
    -------
    float
        From 0 to 1; NaN where one of them is constant.
    """
    return abs(float(np.corrcoef(a, b)[0, 1]))


def sign_is_reversed(torque_nm: Floats, angle_deg: Floats, run: NDArray[np.generic]) -> bool:
    """Whether the angle falls where the torque rises, pooled within runs.

    A correlation below -0.5 decides; noise and friction loops leave it far above zero.

    Parameters
    ----------
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].
    angle_deg : ndarray of float, shape (n,)
        Angle [deg].
    run : ndarray, shape (n,)
        Trial each sample belongs to.

    Returns
    -------
    bool
    """
    if len(torque_nm) < 3:
        return False
    label = np.unique(run, return_inverse=True)[1]
    count = np.bincount(label)
    torque = torque_nm - (np.bincount(label, torque_nm) / count)[label]
    angle = angle_deg - (np.bincount(label, angle_deg) / count)[label]
    spread = np.sqrt(np.mean(torque**2) * np.mean(angle**2))
    return bool(spread > 0 and np.mean(torque * angle) < -0.5 * spread)


def angle_lattice(angle_deg: Floats, torque_nm: Floats, run: Floats | None = None) -> float:
    """Step of the angle reading [deg] where all values are multiples of one; else 0.

    Steps below a thousandth of the range, as the printing of decimals makes them, do not matter
    and count as continuous. Steps that no common dial or encoder has count where the reading
    does not advance regularly: a gear or a change of units gives any step.

    Parameters
    ----------
    angle_deg : ndarray of float, shape (n,)
        Angle as read [deg], in file order.
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].
    run : ndarray of float, shape (n,), optional
        Trial each sample belongs to; by default all are one run.

    Returns
    -------
    float
    """
    levels = np.unique(angle_deg)
    if len(levels) < 3 or len(levels) > 1000:
        return 0.0
    least = float(np.diff(levels).min())
    if least < 1e-3 * float(levels[-1] - levels[0]):
        return 0.0
    places = _places(levels, least)
    step, first = np.polyfit(places, levels, 1)
    left = np.abs(levels - first - step * places).max()
    if left > (AS_PRINTED if len(levels) >= MANY_LEVELS else EXACT) * step:
        return 0.0
    step = float(f"{step:.6g}")
    if _is_graduation(step):
        return step
    within = np.ones(len(angle_deg) - 1, bool) if run is None else np.diff(run) == 0
    moves = np.abs(np.diff(angle_deg))[within] / step, np.abs(np.diff(torque_nm))[within]
    return 0.0 if _advances_regularly(*moves) else step


def _places(levels: Floats, least: float) -> Floats:
    """Number of steps from the lowest level to each, shape (n,).

    The smallest distance is known as well as it was printed, and over the whole range the error
    adds up: the step is taken as the mean of more and more distances, the short ones first.

    Parameters
    ----------
    levels : ndarray of float, shape (n,)
        Different readings in ascending order [deg].
    least : float
        Smallest distance between two of them [deg].

    Returns
    -------
    ndarray
    """
    distance = np.diff(levels)
    count = np.ones(len(distance))
    step = least
    for reach in (1.5, 4.5, 20.5, np.inf):
        near = distance < reach * step
        count = np.maximum(np.rint(distance / step), 1.0)
        step = float(distance[near].sum() / count[near].sum())
    return np.asarray(np.r_[0.0, np.cumsum(count)])


def _is_graduation(step_deg: float) -> bool:
    """Whether common dials and encoders have such steps: 1, 2, 2.5, 5 times 10^n, or 360/2^n."""
    mantissa = step_deg / 10.0 ** np.floor(np.log10(step_deg) + 1e-9)
    power = np.log2(360.0 / step_deg)
    dial = bool(np.isclose(mantissa, [1.0, 2.0, 2.5, 5.0], rtol=1e-4).any())
    return dial or bool(abs(power - np.rint(power)) < 1e-4)


def _advances_regularly(steps: Floats, torque_nm: Floats) -> bool:
    """Whether the angle goes by the same number of steps between most readings.

    So it does where it is prescribed, read once or several times, or where even steps of torque
    meet a straight line.

    Parameters
    ----------
    steps : ndarray of float, shape (m,)
        How far the angle goes from reading to reading, in steps of the reading.
    torque_nm : ndarray of float, shape (m,)
        How far the torque goes [N m].

    Returns
    -------
    bool
    """
    whole = np.rint(steps).astype(np.int64)
    if not whole.any():
        return True
    loaded = torque_nm > REPEATED * np.median(torque_nm[whole > 0])
    whole = whole[(whole > 0) | loaded]
    return bool(np.bincount(whole[whole > 0]).max() >= REGULAR * len(whole))


def merge_same_time(
    columns: dict[str, Floats | None], time_s: Floats, run: Floats
) -> tuple[dict[str, Floats | None], int]:
    """Average neighbouring samples of one run that share a clock tick, in file order.

    Parameters
    ----------
    columns : dict of str to ndarray of float, shape (n,), or None
        What is averaged.
    time_s : ndarray of float, shape (n,)
        Clock [s].
    run : ndarray of float, shape (n,)
        Trial each sample belongs to.

    Returns
    -------
    merged : dict of str to ndarray of float, shape (m,), or None
        The columns, shorter.
    largest : int
        Most samples that became one.
    """
    if not len(time_s):
        return columns, 0
    starts = np.flatnonzero(np.r_[True, (np.diff(time_s) != 0) | (np.diff(run) != 0)])
    counts = np.diff(np.r_[starts, len(time_s)])
    merged = {
        name: None if values is None else np.add.reduceat(values, starts) / counts
        for name, values in columns.items()
    }
    return merged, int(counts.max())
