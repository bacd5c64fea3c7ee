"""Changing the sizes of causes until each is as visible as wanted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.bench import Answer, Bench, in_balance
from cyclosweep_challenge.second_generator.laws.law import Cause
from cyclosweep_challenge.second_generator.recipes import Recipe
from cyclosweep_challenge.second_generator.sensor import Sensor
from cyclosweep_challenge.second_generator.visibility import Size, size_of, tangents

Array = NDArray[np.float64]

TOLERANCE = 0.01
"""Relative error of the visibility that is reached."""
ROUNDS = 12
"""Changes of size tried."""
LARGEST_SHARE = 0.3
"""Share of the largest torque that friction or drag may take at most [-]."""
LARGEST_TWIST = 0.25
"""Largest angle that a cause adds over the twist at the largest torque, at most [-].

A law that adds a quarter still leaves a stiffness above zero."""
SEPARATE, SEPARATE_D = 0.25, 8.0
"""Least part of a cause's visibility that the other causes leave, and least value of it [-]."""


class CannotShowError(ValueError):
    """The cause cannot have the wanted visibility on this specimen and programme."""


@dataclass(frozen=True)
class Made:
    """Causes on one programme: answer with all of them and each one's signature."""

    bench: Bench
    answer: Answer
    seen: NDArray[np.bool_]
    signatures: Array
    free: tuple[Array, ...]

    def starts(self) -> NDArray[np.bool_]:
        """Whether a reading with the flanks in contact is the first of its run."""
        return first_rows(self.bench.path.run[self.seen])


def first_rows(run: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether a row is the first of its run."""
    return np.asarray(np.diff(run, prepend=run[0] - 1) != 0)


def measured(bench: Bench, causes: list[Cause]) -> Made:
    """Measure with all causes and with each of them taken out, on the same side of the play."""
    answer = bench.measure(causes)
    seen = answer.side != 0.0
    if seen.sum() < max(8, 0.5 * len(seen)):
        raise CannotShowError("most readings would fall into the play")
    columns, free = [], []
    for cause in causes:
        rest = [other for other in causes if other is not cause]
        bare = bench.measure(rest, answer.side if in_balance(cause) else None)
        columns.append((answer.angle_deg - bare.angle_deg)[seen])
        load = bench.path.load if in_balance(cause) else answer.twist
        free.append(tangents(answer.side[seen], load[seen]))
    signatures = np.column_stack(columns) if columns else np.zeros((int(seen.sum()), 0))
    return Made(bench, answer, seen, signatures, tuple(free))


def sizes_of(made: Made, sensor: Sensor) -> list[Size]:
    """Size of every cause."""
    starts, count = made.starts(), made.signatures.shape[1]
    return [
        size_of(
            made.signatures[:, k],
            made.free[k],
            made.signatures[:, [j for j in range(count) if j != k]],
            sensor,
            starts,
        )
        for k in range(count)
    ]


def reach(
    recipe: Recipe, bench: Bench, causes: list[Cause]
) -> tuple[list[Cause], Sensor, Made, list[Size]]:
    """Change sizes, or the noise under a friction of given share, until d is as wanted."""
    sensor, wanted = recipe.sensor, recipe.d
    for _ in range(ROUNDS):
        made = measured(bench, causes)
        sizes = sizes_of(made, sensor)
        if recipe.share:
            factor = sizes[0].d / wanted[0]
            sensor = sensor.scaled(factor)
            sizes = sizes_of(made, sensor)
        errors = [abs(s.d / w - 1.0) for s, w in zip(sizes, wanted, strict=True)]
        if max(errors, default=0.0) <= TOLERANCE:
            _check(bench, causes, sizes)
            return causes, sensor, made, sizes
        steps = [
            np.clip(w / max(s.d, 1e-9), 0.02, 50.0) for s, w in zip(sizes, wanted, strict=True)
        ]
        if recipe.share:
            steps[0] = 1.0
        causes = [replace(c, size=c.size * float(f)) for c, f in zip(causes, steps, strict=True)]
        if any(in_balance(c) and c.size > 2.0 * LARGEST_SHARE for c in causes):
            raise CannotShowError(
                "friction would have to take more of the torque than any drive shows"
            )
    raise CannotShowError("no size gives the wanted visibility")


def _check(bench: Bench, causes: list[Cause], sizes: list[Size]) -> None:
    """Refuse sizes that no bench shows."""
    twist = bench.specimen.twist_deg * bench.top
    for cause, size in zip(causes, sizes, strict=True):
        if in_balance(cause) and cause.size > LARGEST_SHARE:
            raise CannotShowError(
                "friction would have to take more of the torque than any drive shows"
            )
        if size.d_apart < max(SEPARATE * size.d, min(SEPARATE_D, 0.9 * size.d)):
            raise CannotShowError("another cause looks the same on this programme")
        if in_balance(cause):
            continue
        if size.raw_peak_deg > LARGEST_TWIST * twist or abs(cause.size) > twist:
            raise CannotShowError("a cause would have to be larger than any bench shows")
