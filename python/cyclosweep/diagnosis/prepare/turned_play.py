"""Play through which the shaft was turned, as on a rig that sets the angle and reads the torque.

On such a rig many readings lie within the play. Friction holds their torque off zero, so that they
look like readings under load, and no torque tells at which angle the shaft stands. Within the play
the shaft turns and the torque does not follow, between the same two angles in both directions.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cyclosweep.recording.robust import sigma_by_second_differences
from cyclosweep.simulation.effects.history import Flags, Floats

REACHES = (1, 2, 4, 8, 16, 32, 64)
"""Readings ahead and behind over which the torque is compared with the angle; the nearest that is
clear of the noise counts."""
CLEAR_OF_NOISE = 6.0
"""Turn over the noise of a reading from which it is."""
FOLLOWS = 0.2
"""Twist by the torque over the turn of the shaft from which the torque follows the angle."""
MOST_BETWEEN = 2
"""Readings between two within the play that may look as if they were not."""
FEWEST = 3
"""Readings within the play, of each crossing."""
AGREE = 0.25
"""Largest distance of the ends of both directions over the play."""
STEADY = 2.0
"""Largest step of the angle within the play over that under load. Where the torque is set, the
shaft falls through the play."""


@dataclass(frozen=True, slots=True)
class TurnedPlay:
    """Play whose ends were seen in the angle.

    Attributes
    ----------
    low_deg, high_deg : float
        Its ends [deg].
    margin_deg : float
        How far beyond them a reading may still lie within the play [deg].
    """

    low_deg: float
    high_deg: float
    margin_deg: float

    @property
    def datum_deg(self) -> float:
        """Middle of the play [deg]."""
        return 0.5 * (self.low_deg + self.high_deg)

    @property
    def free_play_deg(self) -> float:
        """Half of its width [deg]."""
        return 0.5 * (self.high_deg - self.low_deg)

    def side(self, angle: Floats) -> Floats:
        """Flank on whose side of the middle angles, shape (n,) [deg], lie: +1 or -1."""
        return np.where(angle >= self.datum_deg, 1.0, -1.0)

    def holds(self, angle: Floats) -> Flags:
        """Whether angles, shape (n,) [deg], lie within the play or hardly beyond it."""
        beyond = np.abs(angle - self.datum_deg) - self.free_play_deg
        return np.asarray(beyond < self.margin_deg)


def turned_play(twist: Floats, angle: Floats, loaded: Floats) -> TurnedPlay | None:
    """Find a play through which the shaft was turned in both directions.

    Parameters
    ----------
    twist : ndarray, shape (n,)
        Twist of the drive by the torque, in the order of the recording [deg].
    angle : ndarray, shape (n,)
        Measured angle [deg].
    loaded : ndarray, shape (n,)
        +1 or -1 where a flank is in contact for certain, else 0.

    Returns
    -------
    TurnedPlay or None
        None where the play was crossed in few readings, in one direction, or not at all.
    """
    certain = np.flatnonzero(loaded)
    least = _clear_of_noise(twist, angle)
    free = _turns_freely(twist, angle, least) & (loaded == 0)
    ends: dict[float, list[tuple[float, float]]] = {-1.0: [], 1.0: []}
    steps = []
    for first, last in pairwise(certain):
        if last - first <= FEWEST or loaded[first] == loaded[last]:
            continue
        rows = _longest(np.flatnonzero(free[first : last + 1]) + first)
        if len(rows) >= FEWEST:
            inside = angle[rows]
            ends[loaded[last]].append((float(inside.min()), float(inside.max())))
            steps.append(float(np.median(np.abs(np.diff(inside)))))
    if not (ends[1.0] and ends[-1.0]):
        return None
    up, down = (np.median(ends[way], axis=0) for way in (1.0, -1.0))
    low, high = 0.5 * (up + down)
    step = float(np.median(steps))
    under_load = np.abs(np.diff(angle))[(loaded[1:] == loaded[:-1]) & (loaded[1:] != 0)]
    steady = len(under_load) > 0 and step <= STEADY * float(np.median(under_load))
    if not steady or np.max(np.abs(up - down)) > AGREE * (high - low):
        return None
    # A reading between two within the play is two steps from its end at most.
    return TurnedPlay(float(low), float(high), 2.0 * max(step, least))


def _clear_of_noise(twist: Floats, angle: Floats) -> float:
    """Turn of the shaft that is clear of the noise of single readings [deg].

    Parameters
    ----------
    twist, angle : ndarray, shape (n,)
        As of `turned_play` [deg].

    Returns
    -------
    float
    """
    if len(angle) < 3:
        return 0.0
    return CLEAR_OF_NOISE * sigma_by_second_differences(angle - twist)


def _turns_freely(twist: Floats, angle: Floats, least: float) -> Flags:
    """Readings to which and from which the shaft turns without the torque following.

    Parameters
    ----------
    twist, angle : ndarray, shape (n,)
        As of `turned_play` [deg].
    least : float
        Turn that is clear of the noise [deg].

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    known, turning = (np.zeros((2, len(angle)), dtype=bool) for _ in range(2))
    for reach in REACHES:
        if reach >= len(angle):
            break
        turned = np.abs(angle[reach:] - angle[:-reach])
        follows = np.abs(twist[reach:] - twist[:-reach]) >= FOLLOWS * turned
        for way, rows in enumerate((slice(None, -reach), slice(reach, None))):
            new = (turned > least) & ~known[way, rows]
            turning[way, rows] |= new & ~follows
            known[way, rows] |= new
    return np.asarray(turning[0] & turning[1])


def _longest(rows: np.ndarray) -> np.ndarray:
    """Longest stretch of row numbers, shape (n,), with few others in between."""
    if len(rows) == 0:
        return rows
    stretches = np.split(rows, np.flatnonzero(np.diff(rows) > MOST_BETWEEN + 1) + 1)
    return max(stretches, key=len)
