"""Hereditary memory: the zero moves from run to run."""

from collections.abc import Callable, Sequence

import numpy as np

import cyclosweep._core as _core
from cyclosweep.effects.base import Effect, Parameter, Shape
from cyclosweep.effects.history import Floats, History

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


PUSHES: tuple[Push, ...] = (_one, _largest, _signed_largest, _balance, _last_extreme, _average)
PUSH_NAMES = (
    "the number of runs",
    "the largest torque of a run",
    "the signed largest torque of a run",
    "the imbalance of a run's extremes",
    "the last turning point of a run",
    "the mean torque of a run",
)


class DatumDrift(Effect):
    """Datum that each run moves by something it did, and that forgets in time.

    `push` says what moves it (see `PUSH_NAMES`); `memory` is the part kept from run to run.
    Without `push` the offsets of the runs are free, and no other programme can be predicted.
    """

    name = "datum_drift"
    physics = (
        "Rollers, bushes and pins do not return to where they were: the zero remembers what the "
        "runs before have done. Turning the rig beyond both dead centres resets it."
    )
    source = "Kumar et al. 2016 (datum drift of up to 1 deg over repeated runs)"
    tell_tale = "offset differs by run, tied to what the last run did"
    family = "run offsets"
    shape_parameters = (
        Parameter("memory", "", "part of the shift kept to the next run", 0.0, 1.0),
    )

    def untestable(self, history: History) -> str | None:
        """Need at least three runs without a reset in between."""
        if history.resets_datum:
            return "the rig was reset between runs, so the datum cannot remember"
        if history.run_count < 3:
            return "it takes at least three runs to see the datum move"
        return super().untestable(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Every push with several memories, and free offsets."""
        grid: list[Shape] = [
            {"push": float(push), "memory": memory}
            for push in range(len(PUSHES))
            for memory in (0.0, 0.4, 0.7, 0.9, 1.0)
            if not (push == 0 and memory in (0.4, 0.9))
        ]
        if 4 <= history.run_count <= 60:
            grid.append({"free": 1.0})
        return grid

    def columns(self, history: History, shape: Shape) -> Floats:
        """Shift of the datum for a unit push [deg]."""
        if "free" in shape:
            runs = np.arange(1, history.run_count)
            return np.asarray(history.run[:, None] == runs, dtype=np.float64)
        push = PUSHES[int(shape["push"])]
        starts = history.run_starts
        stops = np.r_[starts[1:], len(history)]
        pushed = np.array(
            [push(history, int(a), int(b)) for a, b in zip(starts, stops, strict=True)]
        )
        shift = _core.remembered_datum(pushed, float(shape["memory"]))
        return np.repeat(shift, stops - starts)[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Shift by one push, or the shift of each run after the first."""
        if "free" in shape:
            return tuple(
                Parameter(f"shift_{k}_deg", "deg", f"shift of run {k + 1}", -np.inf)
                for k in range(1, 61)
            )
        what = PUSH_NAMES[int(shape["push"])]
        return (Parameter("shift_deg", "deg", f"shift a unit (10 N m, or one run) of {what}"),)
