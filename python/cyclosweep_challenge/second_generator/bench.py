"""The bench: noise-free angle of a specimen with its causes under a load programme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.drive import Specimen
from cyclosweep_challenge.second_generator.laws.balance import solve
from cyclosweep_challenge.second_generator.laws.catalogue import MAKERS, reach, resistance
from cyclosweep_challenge.second_generator.laws.law import Cause, State
from cyclosweep_challenge.second_generator.path import SMALLEST, Path

Array = NDArray[np.float64]

DIAL = "dial_eccentricity"
"""Effect of the sensor, applied after the drive's own."""


@dataclass(frozen=True)
class Answer:
    """Noise-free angle and state of the drive; each array has shape (N,).

    Attributes
    ----------
    angle_deg : array
        Angle [deg].
    twist : array
        Elastic torque in rated torques [-].
    side : array
        Side of the play: -1, 0 (within the play: no reading) or 1.
    """

    angle_deg: Array
    twist: Array
    side: Array


class Bench:
    """A specimen, a programme and causes; what does not change between questions is kept.

    Parameters
    ----------
    specimen : Specimen
        The drive.
    path : Path
        Load programme.
    top : float
        Largest torque of the recording's programme [rated torques].
    """

    def __init__(self, specimen: Specimen, path: Path, top: float) -> None:
        self.specimen = specimen
        self.path = path
        self.top = top
        self._solved: dict[tuple[tuple[str, str, float], ...], tuple[Array, Array]] = {}

    def elastic(self, causes: Sequence[Cause]) -> tuple[Array, Array]:
        """Elastic torque [rated torques] and side of the play under the causes' friction."""
        balance = [c for c in causes if c.law.adds is None and c.size > 0.0]
        key = tuple((c.law.effect, c.law.name, c.size) for c in balance)
        if key not in self._solved:
            finest = min((reach(c.shape) for c in balance), default=1.0)
            resistances = [resistance(c, self.top) for c in balance]
            self._solved[key] = solve(self.path, resistances, finest)
        return self._solved[key]

    def measure(self, causes: Sequence[Cause], side: Array | None = None) -> Answer:
        """Noise-free angle under the causes.

        Parameters
        ----------
        causes : sequence of Cause
            What is at work, each effect at most once.
        side : array, shape (N,), optional
            Side of the play, where that is not to follow from the causes: friction may hold the
            flanks together beyond zero torque, and what it adds is not a travel through the play.
        """
        twist, own_side = self.elastic(causes)
        side = own_side if side is None else side
        drive = self.specimen
        line = drive.datum_deg + side * drive.play_deg + drive.twist_deg * twist
        state = State(self.path, twist, side, line, drive.twist_deg, drive.mesh_per_deg)
        total = line.copy()
        for cause in causes:
            if cause.law.adds is not None and cause.law.effect != DIAL:
                total += cause.size * cause.law.adds(state, cause.shape)
        seen = State(self.path, twist, side, total, drive.twist_deg, drive.mesh_per_deg)
        for cause in causes:
            if cause.law.adds is not None and cause.law.effect == DIAL:
                total = total + cause.size * cause.law.adds(seen, cause.shape)
        if side is own_side:
            # Within the play the shaft hangs where the small torque and its bearings leave it.
            part = np.clip(self.path.load / SMALLEST, -1.0, 1.0)
            total = np.where(side == 0.0, drive.datum_deg + drive.play_deg * part, total)
        return Answer(total, twist, side)


def in_balance(cause: Cause) -> bool:
    """Whether a cause acts on the torque balance: friction or drag."""
    return (cause.law.effect, cause.law.name) in MAKERS
