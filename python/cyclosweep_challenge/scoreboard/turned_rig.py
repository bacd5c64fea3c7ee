"""A rig that sets the angle and reads the torque: the shaft is turned to and fro through the play.

In the angle the play is where it is, whatever the friction, so that the torque follows at once:
friction along the way, and a spring behind the play. Readings come at equal steps of the angle,
many of them within the play, where friction alone holds the torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep_challenge.scoreboard.made import DRIVE
from cyclosweep_challenge.scoreboard.made_rig import COMPLIANCE_DEG_PER_NM, PLAY_DEG, Friction

Array = NDArray[np.float64]

NO_FRICTION = Friction()


@dataclass(frozen=True)
class TurnedLoops:
    """Loops that the rig turns, and what is at work.

    Attributes
    ----------
    seed : int
        Determines the noise.
    tops_nm : sequence of float
        Elastic torque at the ends of every loop [N m].
    readings : int
        Readings of each loop.
    noise_deg : float
        Standard deviation of a reading of the angle [deg].
    torque_noise_nm : float
        The same of the torque [N m].
    play_deg : float
        Free play each side of the middle [deg].
    friction : Friction
        Along the angle, from rest.
    stiffening : float
        How much stiffer the spring is at the largest end than at zero, growing with the square [-].
    """

    seed: int
    tops_nm: Sequence[float] = (30.0, 30.0, 30.0)
    readings: int = 400
    noise_deg: float = 0.05
    torque_noise_nm: float = 0.0
    play_deg: float = PLAY_DEG
    friction: Friction = NO_FRICTION
    stiffening: float = 0.0


def turned(loops: TurnedLoops) -> Recording:
    """Make the recording of some loops, one after the other without a break."""
    place = np.arange(loops.readings) / loops.readings
    ends = [loops.play_deg + COMPLIANCE_DEG_PER_NM * top for top in loops.tops_nm]
    way = np.concatenate([np.interp(place, (0, 0.25, 0.75, 1), (0, a, -a, 0)) for a in ends])
    twist = np.sign(way) * np.maximum(np.abs(way) - loops.play_deg, 0.0)
    largest = COMPLIANCE_DEG_PER_NM * max(loops.tops_nm)
    elastic = twist / COMPLIANCE_DEG_PER_NM * (1.0 + loops.stiffening * (twist / largest) ** 2)
    state = np.zeros_like(way)
    for k, step in enumerate(np.diff(way), 1):
        state[k] = loops.friction.state(state[k - 1], step)
    limit = loops.friction.constant_nm + loops.friction.share * np.abs(elastic)
    torque = elastic + limit * state
    rng = np.random.default_rng(loops.seed)
    return Recording.from_arrays(
        torque + rng.normal(0.0, 1.0, len(way)) * loops.torque_noise_nm,
        way + rng.normal(0.0, 1.0, len(way)) * loops.noise_deg,
        drive=DRIVE,
    )
