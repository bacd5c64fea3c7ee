"""Sweeps of a load history between two reversals, and which of them pass the same states."""

import itertools
from dataclasses import dataclass

import numpy as np

from cyclosweep.recording.structure import REVERSAL_SHARE, turning_points
from cyclosweep.simulation.effects.history import History

SAME_ENDS = 0.04
"""Share of the range of torque within which the ends of two equal sweeps agree."""
SAME_RATE = 1.5
"""Factor within which the rates of two equal sweeps agree, where there is a clock."""
LEAST_LOAD = 0.3
"""Share of the largest torque that a sweep has to reach on a side to show a slope there."""
FEWEST_ROWS = 3
"""Rows of a sweep from which a slope is taken."""


@dataclass(frozen=True)
class Sweep:
    """Rows between two reversals on one side of zero torque.

    Attributes
    ----------
    rows : ndarray of int
        Rows, in order.
    state : tuple of int
        Side, direction, whether it is the first of its run, and position of the mesh.
    start_nm, end_nm : float
        Torques of the reversals before and after [N m].
    rate : float
        Rate of the torque [N m/s]; zero without a clock.
    limit_nm : float
        Largest load on this side [N m].
    """

    rows: np.ndarray
    state: tuple[float, ...]
    start_nm: float
    end_nm: float
    rate: float
    limit_nm: float

    def equals(self, other: "Sweep", room_nm: float) -> bool:
        """Whether another sweep passes the same states.

        Parameters
        ----------
        other : Sweep
            The other one.
        room_nm : float
            Torque within which the ends agree [N m].

        Returns
        -------
        bool
        """
        if self.state != other.state:
            return False
        if abs(self.start_nm - other.start_nm) > room_nm:
            return False
        if abs(self.end_nm - other.end_nm) > room_nm:
            return False
        slow, fast = sorted((self.rate, other.rate))
        return fast <= SAME_RATE * slow


def equal_sweeps(history: History) -> list[list[Sweep]]:
    """Group the sweeps of a load history by the states that they pass; single ones are left out.

    Parameters
    ----------
    history : History
        Load history of the prepared rows.

    Returns
    -------
    list of list of Sweep
        Each in the order recorded.
    """
    room = SAME_ENDS * float(np.ptp(history.applied_nm))
    groups: list[list[Sweep]] = []
    for sweep in _sweeps(history):
        for group in groups:
            if group[0].equals(sweep, room):
                group.append(sweep)
                break
        else:
            groups.append([sweep])
    return [group for group in groups if len(group) > 1]


def _sweeps(history: History) -> list[Sweep]:
    """Sweeps between reversals, each side of zero torque apart, in the order recorded."""
    torque = history.applied_nm
    threshold = REVERSAL_SHARE * float(np.ptp(torque))
    found = []
    for number in np.unique(history.run):
        rows = np.flatnonzero(history.run == number)
        ends = [0, *turning_points(torque[rows], threshold).tolist(), len(rows) - 1]
        for first, last in itertools.pairwise(ends):
            part = rows[first : last + 1]
            if len(part) < FEWEST_ROWS:
                continue
            start, end = float(torque[part[0]]), float(torque[part[-1]])
            direction = 1.0 if end > start else -1.0
            rate = 0.0
            if history.time_s is not None:
                lapse = float(history.time_s[part[-1]] - history.time_s[part[0]])
                rate = abs(end - start) / lapse if lapse > 0 else 0.0
            crank = 0.0 if history.crank_deg is None else float(history.crank_deg[part[0]])
            for side in (1.0, -1.0):
                limit = max(side * start, side * end)
                if limit >= LEAST_LOAD * history.largest_torque_nm:
                    state = (side, direction, float(first == 0), crank)
                    found.append(Sweep(part, state, start, end, rate, limit))
    return found
