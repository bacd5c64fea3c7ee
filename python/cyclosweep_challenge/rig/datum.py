"""The hereditary datum: where the dial's zero settles after what the last run did."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM
from cyclosweep_challenge.rig.programme import Programme

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Datum:
    """A zero that a run leaves displaced towards its extreme.

    Attributes
    ----------
    retention : float
        Share of the displacement that outlives another run [-].
    last_weight : float
        Weight of the last turning point against the largest extreme of the run [-].
    exponent : float
        Power of the extreme torque in the displacement [-].
    """

    retention: float
    last_weight: float
    exponent: float

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Datum:
        """Draw one specimen's memory."""
        return cls(
            retention=float(rng.uniform(0.0, 0.6)),
            last_weight=float(rng.uniform(0.3, 1.0)),
            exponent=float(rng.uniform(0.6, 1.2)),
        )

    def offset(self, programme: Programme, shift_deg: float) -> Array:
        """Datum of every sample [deg]; ``shift_deg`` is left by an extreme of rated torque."""
        offset = np.zeros(len(programme))
        state = 0.0
        for number in dict.fromkeys(programme.run.tolist()):
            within = np.flatnonzero(programme.run == number)
            offset[within] = state
            state = self.retention * state + shift_deg * self._extreme(programme.torque_nm[within])
        return offset

    def _extreme(self, torque_nm: Array) -> float:
        """Signed, powered extreme of one run in units of rated torque [-]."""
        path = np.concatenate(([0.0], torque_nm, [0.0]))
        step = np.diff(path)
        moving = np.flatnonzero(step != 0.0)
        turns = moving[1:][np.sign(step[moving[1:]]) != np.sign(step[moving[:-1]])]
        if turns.size == 0:
            return 0.0
        last = path[turns[-1]]
        largest = path[np.argmax(np.abs(path))]
        blend = (self.last_weight * last + (1.0 - self.last_weight) * largest) / (
            RATED_INPUT_TORQUE_NM
        )
        return float(np.sign(blend) * np.abs(blend) ** self.exponent)
