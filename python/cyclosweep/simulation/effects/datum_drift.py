"""Hereditary memory: the zero moves from run to run."""

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np

import cyclosweep._core as _core
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History

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


MEMORIES = (0.0, 0.4, 0.7, 0.9, 1.0)
"""Parts of a shift kept from run to run that are looked at."""


LEAST_PUSH = 0.01
"""Share of the largest torque that a push must reach to be one: balanced loops have a mean torque
of nothing but rounding."""


UNTOLD = 0.1
"""Share of free offsets up to which the pushes that explain the rest are believed."""


class DatumDrift(Effect):
    """Datum that each run moves by something it did, and that forgets in time.

    `push` says what moves it (see `PUSH_NAMES`); `memory` is the part kept from run to run.
    Without `push` the offsets of the runs are free; to predict another programme they are put down
    to what explains them best.
    """

    name = "datum_drift"
    physics = (
        "Rollers, bushes and pins do not return to where they were: the zero remembers what the "
        "runs before have done. Turning the rig beyond both dead centres resets it."
    )
    source = "Kumar et al. 2016 (datum drift of up to 1 deg over repeated runs)"
    tell_tale = "offset differs by run, tied to what the last run did"
    shown_by = "three or more runs without a reset between them"
    family = "run offsets"
    shape_parameters = (
        Parameter("memory", "", "part of the shift kept to the next run", 0.0, 1.0),
    )
    forms = (
        ShapeForm(("push", "memory"), ("push_2", "memory_2")),
        ShapeForm(("free",)),
    )

    def untestable(self, history: History) -> str | None:
        """Need at least three runs without a reset in between."""
        if history.resets_datum:
            return "the rig was reset between runs, so the datum cannot remember"
        if history.run_count < 3:
            return "it takes at least three runs to see the datum move"
        return super().untestable(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Every push with several memories, every two of them, and free offsets."""
        given = _given(history)
        grid: list[Shape] = [
            {"push": float(push), "memory": memory}
            for push in given
            for memory in MEMORIES
            if not (push == 0 and memory in (0.4, 0.9))
        ]
        if 4 <= history.run_count <= 60:
            grid += [
                {"push": float(first), "memory": memory, "push_2": float(second)}
                for first, second in combinations(given[1:], 2)
                for memory in (0.0, 0.4, 0.7)
            ]
            grid.append({"free": 1.0})
        return grid

    def columns(self, history: History, shape: Shape) -> Floats:
        """Shift of the datum for a unit push [deg]."""
        if "free" in shape:
            runs = np.arange(1, history.run_count)
            return np.asarray(history.run[:, None] == runs, dtype=np.float64)
        length = np.diff(np.r_[history.run_starts, len(history)])
        return np.column_stack(
            [np.repeat(_shifts(history, push, memory), length) for push, memory in _pushes(shape)]
        )

    def caution(self, shape: Shape) -> float:
        """Free offsets hold whatever differs from run to run."""
        return 6.0 if "free" in shape else 0.0

    def telling(self, history: History, shape: Shape, amplitudes: Floats) -> bool:
        """Free offsets are memory only if what the runs before did explains them."""
        if "free" not in shape:
            return True
        best = _explained(history, amplitudes)
        return best is not None and best[0] < UNTOLD

    def fewer_amplitudes(self, shape: Shape) -> bool:
        """Free offsets: one a run after the first, up to sixty."""
        return "free" in shape

    def portable(
        self, history: History, shape: Shape, amplitudes: Floats
    ) -> tuple[Shape, Sequence[float]]:
        """One or two pushes that explain free offsets best, by the error on runs left out."""
        if "free" not in shape:
            return shape, amplitudes.tolist()
        best = _explained(history, amplitudes)
        if best is None:
            return shape, amplitudes.tolist()
        named: dict[str, float] = {}
        for k, (push, memory) in enumerate(best[1]):
            tail = f"_{k + 1}" if k else ""
            named |= {f"push{tail}": float(push), f"memory{tail}": memory}
        return named, best[2].tolist()

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Shift by one push, or the shift of each run after the first."""
        if "free" in shape:
            return tuple(
                Parameter(f"shift_{k}_deg", "deg", f"shift of run {k + 1}", -np.inf)
                for k in range(1, 61)
            )
        return tuple(
            Parameter(
                f"shift{'' if k == 1 else f'_{k}'}_deg",
                "deg",
                f"shift a unit (10 N m, or one run) of {PUSH_NAMES[push]}",
            )
            for k, (push, _) in enumerate(_pushes(shape), 1)
        )


def _explained(
    history: History, amplitudes: Floats
) -> tuple[float, tuple[tuple[int, float], ...], Floats] | None:
    """Share of free offsets that the best one or two pushes leave in runs left out; pushes, shifts.

    Two pushes share one memory, for there is one zero that forgets; with a memory each they would
    also fit a zero that wanders with the temperature. Offsets drawn at random leave more than
    `UNTOLD` 97 times in a hundred.
    """
    found = np.r_[0.0, amplitudes]
    single = [(push, memory) for push in _given(history) for memory in MEMORIES]
    shifts = {one: _shifts(history, *one) for one in single}
    best: tuple[float, tuple[tuple[int, float], ...], Floats] | None = None
    alike = (pair for pair in combinations(single, 2) if pair[0][1] == pair[1][1])
    for pushes in [*((one,) for one in single), *alike]:
        columns = np.column_stack([shifts[one] for one in pushes])
        basis, corner = np.linalg.qr(columns)
        if np.min(np.abs(np.diag(corner))) < 1e-6 * max(np.max(np.abs(corner)), 1e-300):
            continue
        part = basis.T @ found
        lever = np.minimum(np.sum(basis**2, axis=1), 0.99)
        error = float(np.mean(((found - basis @ part) / (1.0 - lever)) ** 2))
        if best is None or error < best[0]:
            best = error, pushes, np.asarray(np.linalg.solve(corner, part))
    if best is None:
        return None
    return best[0] / max(float(np.mean(found**2)), 1e-300), best[1], best[2]


def _given(history: History) -> list[int]:
    """Pushes that the runs of a recording give, the number of runs first."""
    least = LEAST_PUSH * history.largest_torque_nm / 10.0
    return [0] + [
        push
        for push in range(1, len(PUSHES))
        if np.max(np.abs(_pushed(history, push)), initial=0.0) > least
    ]


def _pushed(history: History, push: int) -> Floats:
    """Push by each run."""
    starts = history.run_starts
    stops = np.r_[starts[1:], len(history)]
    return np.array(
        [PUSHES[push](history, int(a), int(b)) for a, b in zip(starts, stops, strict=True)]
    )


def _pushes(shape: Shape) -> list[tuple[int, float]]:
    """What moves the datum, and the part of it that is kept."""
    first = [(int(shape["push"]), float(shape["memory"]))]
    if "push_2" not in shape:
        return first
    return [*first, (int(shape["push_2"]), float(shape.get("memory_2", shape["memory"])))]


def _shifts(history: History, push: int, memory: float) -> Floats:
    """Shift of the datum in each run for a unit push [deg]."""
    return _core.remembered_datum(_pushed(history, push), memory)
