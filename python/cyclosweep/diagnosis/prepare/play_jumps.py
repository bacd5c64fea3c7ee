"""Where the play is crossed between two readings, the angle jumps and tells the flank.

A line through the loaded readings tells it of light readings only as well as the line is known.
Friction and curved laws leave it off by as much as a small play is wide.
"""

import numpy as np

from cyclosweep.simulation.effects.history import Flags, Floats, Ints

LEAST_JUMP = 0.5
"""Jump of the angle over half of the play, as the line tells it, from which it may be the play: a
loop of friction makes the line tell too much."""
FASTER = 8.0
"""Jump over the median step under load from which it is no noise: five standard deviations. Larger
steps are usual where friction lets go after a reversal."""
ALONE = 0.5
"""Other steps of the same crossing over the jump up to which the play was crossed in it."""
FEW_STEPS = 20
"""Steps under load below which the usual one is not known."""


def sides_by_jumps(
    torque_nm: Floats,
    angle_deg: Floats,
    side: Floats,
    loaded: Flags,
    run: Ints,
    line: tuple[float, float],
) -> Floats:
    """Move each change of the flank to the step in which the whole play was crossed.

    Parameters
    ----------
    torque_nm, angle_deg : ndarray, shape (n,)
        Torque [N m] and twist [deg] of readings in the order in which they were taken.
    side : ndarray, shape (n,)
        Flank as far as it is known, +1 or -1; right under load.
    loaded : ndarray of bool, shape (n,)
        Readings that are in contact whatever the angle says.
    run : ndarray of int, shape (n,)
        Run of each reading; from one run to the next no step was recorded.
    line : tuple of float
        Compliance [deg/(N m)], and half of the play [deg].

    Returns
    -------
    ndarray, shape (n,)
        The same flanks where the play was crossed in several steps, or in none that stands out.
    """
    compliance, play = line
    jump = np.diff(angle_deg) - compliance * np.diff(torque_nm)
    begins = np.r_[True, run[1:] != run[:-1]]
    usual = np.abs(jump[loaded[1:] & loaded[:-1] & ~begins[1:]])
    if len(usual) < FEW_STEPS:
        return side
    least = max(LEAST_JUMP * play, FASTER * float(np.median(usual)))
    found, stretch = side.copy(), np.cumsum(begins)
    places = np.flatnonzero(loaded)
    crossed = (np.diff(side[places]) != 0) & (np.diff(stretch[places]) == 0)
    for first, last in zip(places[:-1][crossed], places[1:][crossed], strict=True):
        steps = jump[first:last] * side[last]
        largest = int(np.argmax(steps))
        others = np.delete(np.abs(steps), largest)
        if steps[largest] >= least and others.max(initial=0.0) <= ALONE * steps[largest]:
            found[first : first + largest + 1] = side[first]
            found[first + largest + 1 : last] = side[last]
    return found
