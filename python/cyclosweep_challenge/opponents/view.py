"""What every opponent sees: the recording, the calibrated baseline's residual, a library."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Protocol

import numpy as np
import polars as pl
from numpy.typing import NDArray

Array = NDArray[np.float64]

DUPLICATE = 0.95
"""Correlation above which one of two columns is left out."""


@dataclass(frozen=True)
class Reply:
    """Reply of an opponent to a recording.

    Attributes
    ----------
    score : float
        Its statistic; the larger, the more is missing.
    flagged : bool
        Whether it says at its defaults that something is missing.
    named : tuple of str or None
        Effects it selects; None for a test that names nothing.
    """

    score: float
    flagged: bool
    named: tuple[str, ...] | None


class Regressed(Protocol):
    """A residual and a library of columns: what a regression needs."""

    @property
    def residual(self) -> Array:
        """Angle left over by the calibrated baseline [deg], shape (n,)."""
        ...

    @property
    def library(self) -> tuple[Array, list[str]]:
        """Columns of unit rms without the baseline, and the effect that each stands for."""
        ...


@dataclass(frozen=True)
class RecordingView:
    """A recording as every opponent sees it, read from its files.

    Attributes
    ----------
    time_s, torque_nm, angle_deg, crank_deg, temperature_c : array
        Columns of the recording.
    run : array of int
        Trial number.
    resolution_deg : float
        Division of the dial [deg].
    """

    time_s: Array
    torque_nm: Array
    angle_deg: Array
    run: NDArray[np.int64]
    crank_deg: Array
    temperature_c: Array
    resolution_deg: float

    @classmethod
    def read(cls, folder: Path) -> RecordingView:
        """Read a recording from its folder; rows count as seconds where it has no clock."""
        table = pl.read_csv(folder / "recording.csv")
        about = tomllib.loads((folder / "recording.toml").read_text())
        nothing = np.zeros(len(table))

        def column(name: str, absent: Array = nothing) -> Array:
            return table[name].cast(pl.Float64).to_numpy() if name in table.columns else absent

        return cls(
            column("time_s", np.arange(len(table), dtype=float)),
            column("torque_nm"),
            column("angle_deg"),
            column("run").astype(np.int64),
            column("crank_deg"),
            column("temperature_c"),
            float(about.get("angle_resolution_deg", 0.0)),
        )

    @cached_property
    def baseline(self) -> Array:
        """Orthonormal columns of the published model with free datum, play and compliance."""
        torque = self.torque_nm
        table = np.column_stack([np.ones_like(torque), np.sign(torque), torque])
        left, singular, _ = np.linalg.svd(table, full_matrices=False)
        return np.asarray(left[:, singular > 1e-9 * singular[0]])

    @cached_property
    def residual(self) -> Array:
        """Angle left over by the calibrated baseline [deg]."""
        return np.asarray(self.angle_deg - self.baseline @ (self.baseline.T @ self.angle_deg))

    @cached_property
    def direction(self) -> Array:
        """Sign of the last torque change: one while loading upwards, minus one downwards."""
        step = np.sign(np.diff(self.torque_nm, prepend=0.0))
        start = np.flatnonzero(np.diff(self.run, prepend=self.run[0] - 1))
        step[start] = np.sign(self.torque_nm[start])
        for k in range(1, step.size):
            if step[k] == 0.0:
                step[k] = step[k - 1]
        return np.asarray(step)

    @cached_property
    def last_extreme(self) -> Array:
        """Last turning point of the run before, zero in the first [N m]."""
        return _extreme_before(self)

    @cached_property
    def library(self) -> tuple[Array, list[str]]:
        """Textbook columns, baseline taken out, of unit rms; and the effect each stands for.

        Taking the baseline out of the columns makes every regression a joint one, which is
        kinder to the opponents than regressing the residual on the raw columns. Columns that
        hardly differ from one before them are left out, to keep regressions well conditioned.
        """
        raw = _textbook(self)
        table = np.column_stack([column for _, column in raw])
        return without_duplicates(table, self.baseline, [name for name, _ in raw])


def without_duplicates(
    table: Array, baseline: Array, names: Sequence[str]
) -> tuple[Array, list[str]]:
    """Columns without the baseline, of unit rms, those left out that hardly differ from others.

    Parameters
    ----------
    table : ndarray, shape (n, k)
        Columns.
    baseline : ndarray, shape (n, q)
        Orthonormal columns of the baseline.
    names : sequence of str
        Effect that each column stands for.

    Returns
    -------
    table : ndarray, shape (n, m)
    names : list of str
    """
    free = table - baseline @ (baseline.T @ table)
    size = np.sqrt(np.mean(free**2, axis=0))
    before = np.sqrt(np.mean(table**2, axis=0))
    chosen: list[int] = []
    for k in range(len(names)):
        if size[k] <= 1e-3 * max(float(before[k]), 1e-12):
            continue
        unit = free[:, k] / size[k]
        overlaps = [abs(float(np.mean(unit * free[:, j] / size[j]))) for j in chosen]
        if max(overlaps, default=0.0) < DUPLICATE:
            chosen.append(k)
    return free[:, chosen] / size[chosen], [names[k] for k in chosen]


def _relaxing(view: RecordingView, time_constant_s: float) -> Array:
    """Torque seen through a first-order lag that starts afresh with each run [N m]."""
    out = np.zeros_like(view.torque_nm)
    state = 0.0
    for k in range(out.size):
        if k == 0 or view.run[k] != view.run[k - 1]:
            state = 0.0
        else:
            decay = np.exp(-(view.time_s[k] - view.time_s[k - 1]) / time_constant_s)
            state = view.torque_nm[k] + (state - view.torque_nm[k]) * decay
        out[k] = state
    return out


def _extreme_before(view: RecordingView) -> Array:
    """Last turning point of the run before, zero in the first [N m]."""
    out = np.zeros_like(view.torque_nm)
    extreme = 0.0
    for number in dict.fromkeys(view.run.tolist()):
        here = view.run == number
        out[here] = extreme
        torque = view.torque_nm[here]
        turns = np.flatnonzero(np.diff(np.sign(np.diff(torque))) != 0)
        extreme = float(torque[turns[-1] + 1]) if turns.size else float(torque[-1])
    return out


def _textbook(view: RecordingView) -> list[tuple[str, Array]]:
    """Regression columns from textbooks, each with the effect that it stands for."""
    torque, side, size = view.torque_nm, np.sign(view.torque_nm), np.abs(view.torque_nm)
    top = float(size.max())
    rate = np.zeros_like(torque)
    same = np.diff(view.run) == 0
    rate[1:][same] = (np.diff(torque) / np.maximum(np.diff(view.time_s), 1e-9))[same]
    columns: list[tuple[str, Array]] = [
        ("friction_hysteresis", view.direction),
        ("load_dependent_friction", view.direction * size),
        ("contact_stiffening", side * size ** (2.0 / 3.0)),
        ("datum_drift", view.last_extreme),
        ("creep", _relaxing(view, 30.0) - torque),
        ("creep", _relaxing(view, 300.0) - torque),
        ("thermal_drift", view.temperature_c),
        ("viscous_drag", rate),
        ("load_asymmetry", size),
        ("load_asymmetry", size**2),
    ]
    columns += [("clearance_takeup", side * np.minimum(size, f * top)) for f in (0.25, 0.5)]
    columns += [("overload_softening", side * np.maximum(size - f * top, 0.0)) for f in (0.5, 0.7)]
    for order in (1, 2, 3):
        phase = np.deg2rad(order * view.crank_deg)
        columns += [("transmission_error", np.cos(phase)), ("transmission_error", np.sin(phase))]
    for order in (1, 2):
        phase = np.deg2rad(order * view.crank_deg)
        columns += [
            ("phase_dependent_compliance", torque * np.cos(phase)),
            ("phase_dependent_compliance", torque * np.sin(phase)),
        ]
    # The fitted angle, not the read one: that carries the very noise it would have to explain.
    turn = np.deg2rad(view.angle_deg - view.residual)
    columns += [("dial_eccentricity", np.cos(turn)), ("dial_eccentricity", np.sin(turn))]
    return columns


def effects_of(names: list[str], chosen: Array | list[int]) -> tuple[str, ...]:
    """Effects that the chosen columns stand for, each once."""
    return tuple(sorted({names[int(k)] for k in chosen}))
