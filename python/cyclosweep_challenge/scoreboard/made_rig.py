"""A small rig of the scoreboard's own: a spring with play against friction, reading by reading.

Its friction moves with the angle by laws from the literature that are not the library's elements:
an elastic-plastic block (Jenkins), Dahl's and Bouc and Wen's; they are solved with the torque
balance at every reading.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

COMPLIANCE_DEG_PER_NM = 19.8 / 7.2575
"""Nominal compliance of the 87:1 drive at its input [deg/(N m)]."""
PLAY_DEG = 28.0
"""Its nominal free play on each side [deg]."""
TOP_NM = 31.0
"""Largest torque of every programme [N m]."""
LEAST_NM = 0.4
"""Torque below which no reading is taken [N m]."""
LOW_NM = 0.5
"""Lowest torque at which a programme turns, so that every turning point is read [N m]."""
HALVINGS = 48
"""Steps of the bisection; they leave less than a millionth of a degree."""
REACH_DEG = 400.0
"""Angles between which the balance is looked for [deg]."""

Law = Literal["jenkins", "dahl", "bouc-wen"]


@dataclass(frozen=True)
class Course:
    """Load programme: one value a reading, a reading a second.

    Attributes
    ----------
    torque_nm, time_s, crank_deg, temperature_c : array
        Torque [N m], clock [s], position of the mesh [deg], temperature [degC].
    run : array of int
        Trial; friction and play start afresh in each.
    """

    torque_nm: Array
    time_s: Array
    crank_deg: Array
    temperature_c: Array
    run: NDArray[np.int64]

    @property
    def starts(self) -> NDArray[np.bool_]:
        """First reading of every run."""
        return np.asarray(np.r_[True, np.diff(self.run) != 0], dtype=np.bool_)

    def take(self, keep: NDArray[np.bool_]) -> Course:
        """Return some of the readings."""
        return Course(
            self.torque_nm[keep],
            self.time_s[keep],
            self.crank_deg[keep],
            self.temperature_c[keep],
            self.run[keep],
        )


def _ramps(points: Sequence[float], rate_nm_per_s: float) -> list[float]:
    """Straight ramps through some torques at one rate [N m]."""
    out = [points[0]]
    for start, end in itertools.pairwise(points):
        count = max(int(abs(end - start) / rate_nm_per_s), 2)
        out += np.linspace(start, end, count + 1)[1:].tolist()
    return out


def rich_course(rng: np.random.Generator, runs: int = 10) -> Course:
    """Draw loops of several sizes and rates, each with a dwell and a nested loop.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of sizes, rates, positions and temperatures.
    runs : int
        Number of runs.
    """
    places = rng.uniform(0.0, 360.0, 5)
    torque: list[float] = []
    time: list[float] = []
    run: list[int] = []
    crank: list[float] = []
    clock = 0.0
    for number in range(runs):
        top = TOP_NM * (1.0 if number < 2 else float(rng.choice([0.4, 0.6, 0.8, 1.0])))
        rate = float(rng.choice([0.5, 0.9, 2.0]))
        path = _ramps([LOW_NM, top, -top, 0.55 * top, LOW_NM, 0.8 * top], rate)
        path += [0.8 * top] * 40
        path += _ramps([0.8 * top, 0.3 * top, 0.8 * top, LOW_NM], rate)[1:]
        torque += path
        time += (clock + np.arange(len(path))).tolist()
        run += [number + 1] * len(path)
        crank += [float(places[number % 5])] * len(path)
        clock += len(path) + float(rng.uniform(150.0, 300.0))
    at = np.array(time)
    warm = 20.0 + 8.0 * (1.0 - np.exp(-at / 2000.0))
    warm = warm + 1.5 * np.sin(at / 500.0 + float(rng.uniform(0.0, 6.3)))
    return Course(np.array(torque), at, np.array(crank), warm, np.array(run, dtype=np.int64))


@dataclass(frozen=True)
class Friction:
    """Friction that moves with the angle.

    Attributes
    ----------
    law : str
        How it builds up after a reversal.
    presliding_deg : float
        Angle over which it builds up [deg].
    constant_nm : float
        Limit that does not depend on the load [N m].
    share : float
        Limit over the transmitted torque [-].
    """

    law: Law = "dahl"
    presliding_deg: float = 2.0
    constant_nm: float = 0.0
    share: float = 0.0

    def state(self, before: float, move_deg: float) -> float:
        """Friction over its limit after a move [-], from -1 to 1."""
        step = move_deg / self.presliding_deg
        if self.law == "jenkins":
            return min(1.0, max(-1.0, before + step))
        if self.law == "dahl":
            side = 1.0 if step >= 0.0 else -1.0
            return side + (before - side) * math.exp(-abs(step))
        return _bouc_wen(before, step)


def _bouc_wen(before: float, step: float) -> float:
    """Bouc and Wen's law of exponent two with equal weights: straight on the way back to zero."""
    if step < 0.0:
        return -_bouc_wen(-before, -step)
    if before < 0.0:
        if before + step <= 0.0:
            return before + step
        before, step = 0.0, before + step
    return math.tanh(step + math.atanh(min(before, 1.0 - 1e-12)))


@dataclass(frozen=True)
class Balance:
    """What the solved drive does at every reading.

    Attributes
    ----------
    angle_deg : array
        Twist of spring and play [deg].
    elastic_nm : array
        Torque that twists the spring [N m].
    on_flank : array of bool
        Readings at which the shaft stands on the flank that its torque pulls to.
    """

    angle_deg: Array
    elastic_nm: Array
    on_flank: NDArray[np.bool_]


def balance(
    course: Course,
    friction: Friction,
    *,
    compliance: Array | float = COMPLIANCE_DEG_PER_NM,
    play_deg: float = PLAY_DEG,
) -> Balance:
    """Solve spring, play and friction for the applied torque, reading by reading.

    Parameters
    ----------
    course : Course
        Load programme.
    friction : Friction
        Friction between shaft and housing.
    compliance : array or float
        Compliance at every reading [deg/(N m)].
    play_deg : float
        Free play on each side [deg].
    """
    slope = np.broadcast_to(np.asarray(compliance, dtype=float), course.torque_nm.shape)
    angle = np.empty(course.torque_nm.size)
    if friction.constant_nm == 0.0 and friction.share == 0.0:
        side = np.where(course.torque_nm < 0.0, -1.0, 1.0)
        angle = side * play_deg + slope * course.torque_nm
    else:
        place, state = 0.0, 0.0
        for k, start in enumerate(course.starts.tolist()):
            if start:
                place, state = play_deg, 0.0
            spring = _spring(float(slope[k]), play_deg)
            place, state = _step(friction, spring, float(course.torque_nm[k]), place, state)
            angle[k] = place
    elastic = np.sign(angle) * np.maximum(np.abs(angle) - play_deg, 0.0) / slope
    flank = (angle * course.torque_nm > 0.0) & (np.abs(angle) >= play_deg)
    return Balance(angle, elastic, flank)


def _spring(slope: float, play_deg: float) -> Callable[[float], float]:
    """Torque of a spring with play at an angle [N m]."""

    def torque(angle: float) -> float:
        return math.copysign(max(abs(angle) - play_deg, 0.0) / slope, angle)

    return torque


def _step(
    friction: Friction,
    spring: Callable[[float], float],
    torque: float,
    place: float,
    state: float,
) -> tuple[float, float]:
    """Angle at which spring and friction balance a torque, and the friction's state there."""
    low, high = -REACH_DEG, REACH_DEG
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        pull = spring(middle)
        limit = friction.constant_nm + friction.share * abs(pull)
        if pull + limit * friction.state(state, middle - place) < torque:
            low = middle
        else:
            high = middle
    found = 0.5 * (low + high)
    return found, friction.state(state, found - place)
