"""Laws by which the datum moves from run to run: what pushes it, what it keeps, what resets it."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np

import cyclosweep._core as _core
from cyclosweep.simulation.effects.base import Shape
from cyclosweep.simulation.effects.history import Flags, Floats, History

Push = Callable[[History, int, int], float]


def _largest(history: History, start: int, stop: int) -> float:
    return float(np.abs(history.applied_nm[start:stop]).max()) / 10.0


def _signed_largest(history: History, start: int, stop: int) -> float:
    part = history.applied_nm[start:stop]
    return float(part[np.argmax(np.abs(part))]) / 10.0


def _balance(history: History, start: int, stop: int) -> float:
    part = history.applied_nm[start:stop]
    return float(part.max() + part.min()) / 10.0


def _last_extreme(history: History, start: int, stop: int) -> float:
    part = history.applied_nm[start:stop]
    turn = np.flatnonzero(np.diff(np.sign(np.diff(part))) != 0) + 1
    far = [float(part[k]) for k in turn if abs(part[k]) > 0.1 * history.largest_torque_nm]
    return (far[-1] if far else _signed_largest(history, start, stop)) / 10.0


def _one(history: History, start: int, stop: int) -> float:
    return 1.0


def _average(history: History, start: int, stop: int) -> float:
    return float(history.applied_nm[start:stop].mean()) / 10.0


def _last_direction(history: History, start: int, stop: int) -> float:
    return float(np.sign(_last_extreme(history, start, stop)))


PUSHES: tuple[Push, ...] = (
    _one,
    _largest,
    _signed_largest,
    _balance,
    _last_extreme,
    _average,
    _last_direction,
)
PUSH_NAMES = (
    "the number of runs",
    "the largest torque of a run",
    "the signed largest torque of a run",
    "the imbalance of a run's extremes",
    "the last turning point of a run",
    "the mean torque of a run",
    "the direction of a run's last excursion",
)
NUMBER, DIRECTION = 0, 6
"""Pushes that are pure numbers, not torques: the count of runs, and a sign."""
MEMORIES = (0.0, 0.4, 0.7, 0.9, 1.0)
"""Parts of a shift kept from run to run that are looked at."""
TURNING_BACK = (-0.5, -0.9)
"""The same for a datum that comes back beyond where it was: it goes to and fro."""
LEAST_PUSH = 0.01
"""Share of the largest torque that a push must reach to be one: balanced loops have a mean torque
of nothing but rounding."""
ALIKE = 1e-6
"""One less the cosine between the pushes of all runs below which two laws are one."""
FULL_LOAD = 0.9
"""Share of the largest torque to which a run has to load both flanks to reset the datum."""


@dataclass(frozen=True, slots=True)
class DatumLaw:
    """What moves the datum from run to run.

    Attributes
    ----------
    push : int
        Index of what moves it, see `PUSH_NAMES`.
    memory : float
        Part of a shift that is kept to the next run; below zero it turns back.
    resets : bool
        Whether a run at full load in both directions wipes what was kept.
    """

    push: int
    memory: float
    resets: bool = False

    @classmethod
    def all_of(cls, shape: Shape) -> list[Self]:
        """The one or two laws of a shape, which add up."""
        resets = bool(shape.get("reset", 0.0))
        memory = float(shape["memory"])
        laws = [cls(int(shape["push"]), memory, resets)]
        if "push_2" in shape:
            laws.append(cls(int(shape["push_2"]), float(shape.get("memory_2", memory)), resets))
        return laws

    def shifts_deg(self, history: History) -> Floats:
        """Shift of the datum in each run for a unit push, shape (runs,) [deg]."""
        push = pushes_of(history, self.push)
        if not self.resets:
            return _core.remembered_datum(push, self.memory)
        wiped = full_runs(history)
        out = np.zeros(len(push))
        for k in range(1, len(push)):
            kept = 0.0 if wiped[k - 1] else self.memory * out[k - 1]
            out[k] = kept + push[k - 1]
        return out

    @property
    def unit(self) -> str:
        """What a unit of the push is."""
        return {NUMBER: "one run", DIRECTION: "its sign"}.get(self.push, "10 N m")

    def __str__(self) -> str:
        kept = f"{100 * abs(self.memory):.0f} % of the shift"
        if self.memory < -0.005:
            follows = f"and turns back by {kept} in the next run"
        elif self.memory > 0.995:
            follows = "and stays there"
        else:
            follows = f"and keeps {kept} to the next run"
        reset = ", until a run at full load in both directions resets it" if self.resets else ""
        return f"{PUSH_NAMES[self.push]} moves the datum, {follows}{reset}"


def runs_of(history: History) -> list[slice]:
    """Samples of each run, in order."""
    starts = history.run_starts
    stops = np.r_[starts[1:], len(history)]
    return [slice(int(a), int(b)) for a, b in zip(starts, stops, strict=True)]


def pushes_of(history: History, push: int) -> Floats:
    """Push by each run.

    Parameters
    ----------
    history : History
        Load history.
    push : int
        Index of the push, see `PUSH_NAMES`.

    Returns
    -------
    ndarray, shape (runs,)
        In 10 N m, or a number [1].
    """
    return np.array([PUSHES[push](history, run.start, run.stop) for run in runs_of(history)])


def full_runs(history: History) -> Flags:
    """Runs that load both flanks to nearly the largest torque, shape (runs,)."""
    least = FULL_LOAD * history.largest_torque_nm
    torque = history.applied_nm
    return np.array(
        [torque[run].max() >= least and torque[run].min() <= -least for run in runs_of(history)]
    )


def given_pushes(history: History) -> list[int]:
    """Kinds of push by the runs of a recording; one in proportion to another is left out.

    The number of runs stands before all of them: where all runs are alike it is the one law.
    """
    least = LEAST_PUSH * history.largest_torque_nm / 10.0
    given: list[int] = []
    directions = [np.full(history.run_count, history.run_count**-0.5)]
    for push in range(1, DIRECTION):
        values = pushes_of(history, push)
        size = float(np.linalg.norm(values))
        if np.max(np.abs(values), initial=0.0) <= least:
            continue
        if max(abs(float(values @ each)) for each in directions) > (1.0 - ALIKE) * size:
            continue
        directions.append(values / size)
        given.append(push)
    return given


def single_laws(history: History) -> list[DatumLaw]:
    """Laws of one push that differ on this recording.

    The direction of the last excursion is a law of its own where it changes from run to run, and a
    reset where some of the runs before the last are at full load and some are not.
    """
    torques = given_pushes(history)
    laws = [DatumLaw(push, memory) for push in [NUMBER, *torques] for memory in MEMORIES]
    laws += [DatumLaw(push, memory) for push in [NUMBER, *torques] for memory in TURNING_BACK]
    direction = pushes_of(history, DIRECTION)
    if np.ptp(direction) > 0:
        laws += [DatumLaw(DIRECTION, memory) for memory in (-0.5, 0.0, 0.7)]
    wiped = full_runs(history)[:-1]
    if np.any(wiped) and not np.all(wiped):
        laws += [DatumLaw(push, 1.0, resets=True) for push in [NUMBER, *torques]]
    return laws


def pairs_of_laws(history: History, memories: Sequence[float]) -> Iterator[tuple[DatumLaw, ...]]:
    """Laws of two kinds of push that move the datum together, with one memory.

    Parameters
    ----------
    history : History
        Load history.
    memories : sequence of float
        Memories that are looked at.

    Yields
    ------
    pair of DatumLaw
    """
    for first, second in combinations(given_pushes(history), 2):
        for memory in memories:
            yield DatumLaw(first, memory), DatumLaw(second, memory)


@dataclass(frozen=True, eq=False, slots=True)
class Explanation:
    """How well laws explain the offsets of the runs.

    Attributes
    ----------
    left : float
        Share of the mean square that they leave in runs left out in turn.
    laws : tuple of DatumLaw
    shifts_deg : ndarray, shape (laws,)
        Shift by a unit of each push [deg].
    """

    left: float
    laws: tuple[DatumLaw, ...]
    shifts_deg: Floats


def best_laws(history: History, offsets_deg: Floats) -> Explanation | None:
    """One law, or two pushes with one memory, that explain the offsets of the runs best.

    Two memories would also fit a zero that wanders with the temperature.

    Parameters
    ----------
    history : History
        Load history.
    offsets_deg : ndarray, shape (runs,)
        Offset of each run [deg].

    Returns
    -------
    Explanation or None
        None where no run pushes.
    """
    found = offsets_deg - offsets_deg[0]
    best: Explanation | None = None
    singles = ((law,) for law in single_laws(history))
    for laws in [*singles, *pairs_of_laws(history, MEMORIES)]:
        columns = np.column_stack([law.shifts_deg(history) for law in laws])
        if (fitted := left_out_share(columns, found)) is None:
            continue
        if best is None or fitted[0] < best.left:
            best = Explanation(fitted[0], laws, fitted[1])
    return best


def left_out_share(columns: Floats, values: Floats) -> tuple[float, Floats] | None:
    """Share of the mean square of values that a fit leaves when each is left out in turn.

    Parameters
    ----------
    columns : ndarray, shape (n, k)
        What the values are fitted by.
    values : ndarray, shape (n,)
        Values to explain.

    Returns
    -------
    share, coefficients : float and ndarray, or None
        None where the columns depend on each other.
    """
    basis, corner = np.linalg.qr(columns)
    if np.min(np.abs(np.diag(corner))) < 1e-6 * max(np.max(np.abs(corner)), 1e-300):
        return None
    part = basis.T @ values
    lever = np.minimum(np.sum(basis**2, axis=1), 0.99)
    error = float(np.mean(((values - basis @ part) / (1.0 - lever)) ** 2))
    share = error / max(float(np.mean(values**2)), 1e-300)
    return share, np.asarray(np.linalg.solve(corner, part))
