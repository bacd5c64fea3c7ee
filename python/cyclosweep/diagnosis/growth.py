"""Whether the loops grow outward at equal torque from cycle to cycle, as no steady friction does.

A friction that remembers reversals, whatever its law, lags: at equal rising torque the angle is the
lower, the deeper the reversal before. Where cycles of equal or growing range reach *further* at
equal torque, on both sides, the drive itself has become softer. A datum that moves shifts one side
outward and the other inward, which cancels.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cyclosweep.recording.structure import REVERSAL_SHARE, turning_points
from cyclosweep.simulation.effects.history import Floats, History

SAME_REVERSAL = 0.04
"""Share of the range of torque by which the reversal before may be less deep than a cycle ago."""
LEAST_PEAK = 0.3
"""Share of the largest torque that both peaks of a cycle have to reach: smaller ones show noise."""
COMPARED_AT = 0.9
"""Torque at which two cycles are compared, as a share of the smaller peak."""
FEWEST_CYCLES = 8
"""Cycles compared with the one before, from which growth is told from scatter."""
GROWTH_LEVEL = 0.002
"""Probability by chance of as much change that is accepted: one false alarm in 500 steady
drives."""
LEAST_GROWTH = 0.03
"""Change over the recording that matters: below it a stiffness still holds to two digits."""


@dataclass(frozen=True)
class Growth:
    """Growth of the twist at equal torque over all cycles.

    Attributes
    ----------
    logarithm, std_error : float
        Logarithm of late over early twist, and its standard error.
    p_value : float
        Probability of as much by chance, by the signed ranks of the growth from cycle to cycle.
    cycles : int
        Number of cycles that were compared with the one before.
    """

    logarithm: float
    std_error: float
    p_value: float
    cycles: int

    @property
    def is_change(self) -> bool:
        """Whether the drive became softer, beyond scatter and by as much as matters."""
        return self.p_value <= GROWTH_LEVEL and self.logarithm >= LEAST_GROWTH


@dataclass(frozen=True)
class _Rise:
    """Rows from one reversal to the next, mirrored so that the torque rises to a positive peak."""

    start_nm: float
    peak_nm: float
    torque_nm: Floats
    angle_deg: Floats

    def angle_at(self, torque_nm: float) -> float:
        """Angle where a torque is first passed [deg]."""
        return float(np.interp(torque_nm, np.maximum.accumulate(self.torque_nm), self.angle_deg))


def growth(history: History, angle_deg: Floats) -> Growth | None:
    """Growth of the loops from cycle to cycle; None where there are too few cycles.

    Parameters
    ----------
    history : History
        Load history of the prepared rows.
    angle_deg : ndarray, shape (n,)
        Twist [deg].

    Returns
    -------
    Growth or None
    """
    from scipy.stats import wilcoxon

    steps: list[tuple[float, float]] = []
    for number in np.unique(history.run):
        rows = np.flatnonzero(history.run == number)
        steps += _steps(history.applied_nm, angle_deg, rows)
    if len(steps) < FEWEST_CYCLES:
        return None
    grown, relative = np.array(steps).T
    if not np.any(grown):
        return None
    return Growth(
        logarithm=float(relative.sum()),
        std_error=float(np.std(relative, ddof=1) * np.sqrt(len(relative))),
        p_value=float(wilcoxon(grown, alternative="greater").pvalue),
        cycles=len(grown),
    )


def _steps(torque: Floats, angle: Floats, rows: np.ndarray) -> list[tuple[float, float]]:
    """Growth of each cycle of a run over the one before, in deg and as a share of the twist.

    Parameters
    ----------
    torque, angle : ndarray, shape (n,)
        Torque [N m] and twist [deg].
    rows : ndarray of int
        Rows of the run.

    Returns
    -------
    list of (float, float)
    """
    room = SAME_REVERSAL * float(np.ptp(torque))
    sides = [_rises(side, torque, angle, rows) for side in (1.0, -1.0)]
    found = []
    for (up, next_up), (down, next_down) in zip(
        pairwise(sides[0]), pairwise(sides[1]), strict=False
    ):
        grown = width = 0.0
        for early, late in ((up, next_up), (down, next_down)):
            if late.start_nm > early.start_nm + room:
                break
            at = COMPARED_AT * min(early.peak_nm, late.peak_nm)
            grown += late.angle_at(at) - early.angle_at(at)
            width += early.angle_at(at)
        else:
            if width > 0 and width + grown > 0:
                found.append((grown, float(np.log1p(grown / width))))
    return found


def _rises(side: float, torque: Floats, angle: Floats, rows: np.ndarray) -> list[_Rise]:
    """Rises to a large peak on one side, in order.

    Parameters
    ----------
    side : float
        +1 or -1.
    torque, angle : ndarray, shape (n,)
        Torque [N m] and twist [deg].
    rows : ndarray of int
        Rows of the run.

    Returns
    -------
    list of _Rise
    """
    least = LEAST_PEAK * float(np.abs(torque).max(initial=0.0))
    turns = turning_points(torque[rows], REVERSAL_SHARE * float(np.ptp(torque)))
    found = []
    for first, last in pairwise([0, *turns.tolist(), len(rows) - 1]):
        part = rows[first : last + 1]
        start, peak = side * float(torque[part[0]]), side * float(torque[part[-1]])
        if peak > start and peak >= least:
            found.append(_Rise(start, peak, side * torque[part], side * angle[part]))
    return found
