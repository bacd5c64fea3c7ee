"""Compliance right after the load turns back, where friction has not slipped again."""

from itertools import pairwise

import numpy as np

from cyclosweep.recording import Recording
from cyclosweep.recording.structure import REVERSAL_SHARE, spans_of_runs, turning_points
from cyclosweep.simulation.effects.history import Floats

LARGE = 0.5
"""Share of the largest torque from which a reversal counts."""
TURNED, HALF = 0.9, 0.5
"""Shares of the torque at the reversal between which the slope is read: below the rounding of the
peak, above what friction of a quarter of the torque would let slip again."""
FEWEST = 2
"""Readings through which a slope is laid; where fewer lie above `HALF`, the next below it, down to
zero torque, are taken as well."""
LEAST_STEP = 0.1
"""Share of the torque at the reversal that these readings span at least."""


def compliance_after_reversals(recording: Recording) -> float | None:
    """Read the compliance from the unloading right after reversals under load.

    Friction that slid up to the reversal holds there: the slope is that of what is elastic, and
    smaller where friction holds a part of it. It is never larger than the compliance, however far
    friction slides elsewhere.

    Parameters
    ----------
    recording : Recording
        With or without an angle.

    Returns
    -------
    float or None
        Median over the reversals [deg/(N m)]; None where no reversal under load is read finely
        enough.
    """
    torque, angle, run = recording.torque_nm, recording.angle_deg, recording.run
    if angle is None or not len(torque):
        return None
    least = LARGE * float(np.abs(torque).max())
    threshold = REVERSAL_SHARE * float(np.ptp(torque))
    slopes = []
    for start, stop in spans_of_runs(run):
        turns = (start + turning_points(torque[start:stop], threshold)).tolist()
        for turn, end in pairwise([*turns, stop - 1]):
            if abs(torque[turn]) >= least:
                rows = slice(turn, end + 1)
                slopes.append(_slope(torque[rows] / torque[turn], angle[rows] / torque[turn]))
    read = [slope for slope in slopes if slope is not None]
    return float(np.median(read)) if read else None


def _slope(load: Floats, angle: Floats) -> float | None:
    """Slope of one unloading; None where it has too few readings.

    Parameters
    ----------
    load, angle : ndarray, shape (n,)
        Torque and angle from a reversal to the next, over the torque there [-, deg/(N m)].

    Returns
    -------
    float or None
        In deg/(N m).
    """
    under = load > 0.0
    stop = len(load) if under.all() else int(np.argmin(under))
    first = int(np.flatnonzero(load[:stop] >= TURNED)[-1]) + 1
    below = np.flatnonzero(load[first:stop] < HALF)
    last = first + max(int(below[0]) if len(below) else stop - first, FEWEST)
    load, angle = load[first : min(last, stop)], angle[first : min(last, stop)]
    if len(load) < FEWEST or float(np.ptp(load)) < LEAST_STEP:
        return None
    return float(np.polyfit(load, angle, 1)[0])
