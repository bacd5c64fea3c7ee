"""Load programmes: what is done to the specimen, sample by sample, from poor to rich."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM, SMALLEST_TORQUE_NM

Array = NDArray[np.float64]

PROGRAMMES = ("oneway", "poor", "middle", "rich")


@dataclass(frozen=True)
class Programme:
    """Torque, clock, trial, mesh position and temperature of every sample.

    Attributes
    ----------
    time_s, torque_nm, crank_deg, temperature_c : array
        Clock [s], input torque [N m], locked crank position [deg] and housing temperature [degC].
    run : array of int
        Trial number; play, slip and creep start afresh when it changes.
    """

    time_s: Array
    torque_nm: Array
    run: NDArray[np.int64]
    crank_deg: Array
    temperature_c: Array

    def __len__(self) -> int:
        return int(self.torque_nm.size)

    @property
    def run_starts(self) -> NDArray[np.bool_]:
        """Mark the first sample of every run."""
        return np.concatenate(([True], np.diff(self.run) != 0))

    def take(self, keep: NDArray[np.bool_] | NDArray[np.int64]) -> Programme:
        """Return the programme restricted to some of its samples."""
        return Programme(
            self.time_s[keep],
            self.torque_nm[keep],
            self.run[keep],
            self.crank_deg[keep],
            self.temperature_c[keep],
        )

    def rate_nm_per_s(self) -> Array:
        """Torque rate of the step that led to each sample [N m/s], shape (N,)."""
        step = np.diff(self.torque_nm, prepend=self.torque_nm[:1])
        lapse = np.diff(self.time_s, prepend=self.time_s[:1])
        start = self.run_starts
        rate = np.zeros(len(self))
        rate[~start] = step[~start] / np.maximum(lapse[~start], 1e-9)
        after = np.minimum(np.flatnonzero(start) + 1, len(self) - 1)
        rate[start] = rate[after]
        return rate


@dataclass(frozen=True)
class _Trial:
    """One run before sampling: corners of the torque path, holds at them, rate and place."""

    corners_nm: tuple[float, ...]
    holds_s: tuple[float, ...]
    rate_nm_per_s: float
    crank_deg: float
    ambient_c: float

    def path(self) -> tuple[Array, Array]:
        """Knots of the torque path: time [s] and torque [N m]."""
        clock, knots, level = 0.0, [(0.0, 0.0)], 0.0
        for target, hold in zip(self.corners_nm, self.holds_s, strict=True):
            clock += abs(target - level) / self.rate_nm_per_s
            knots.append((clock, target))
            if hold > 0.0:
                clock += hold
                knots.append((clock, target))
            level = target
        table = np.array(knots)
        return table[:, 0], table[:, 1]


def _loop(
    kind: str, amplitude: float, rng: np.random.Generator
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Corners and holds of one trial of a given kind, scaled to an amplitude [N m]."""
    a = amplitude
    dwell = float(rng.uniform(90.0, 260.0))
    shapes: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
        "oneway": ((a, 0.0), (0.0, 0.0)),
        "full": ((a, -a, 0.0), (0.0, 0.0, 0.0)),
        "closed": ((a, -a, 0.5 * a, 0.0), (0.0, 0.0, 0.0, 0.0)),
        "nested": (
            (a, 0.35 * a, 0.8 * a, 0.1 * a, a, -a, -0.4 * a, -0.75 * a, 0.0),
            (0.0,) * 9,
        ),
        "biased": ((a, 0.3 * a, a, 0.3 * a, a, -0.6 * a, 0.0), (0.0,) * 7),
        "dwell": ((a, 0.45 * a, -a, 0.0), (dwell, 0.6 * dwell, dwell, 0.0)),
    }
    corners, holds = shapes[kind]
    return corners, holds


def _part_read(knots: Array, levels: Array) -> float:
    """Part of a trial's time in which the torque is large enough to be read [-]."""
    within = np.linspace(0.0, float(knots[-1]), 2000)
    return float(np.mean(np.abs(np.interp(within, knots, levels)) >= SMALLEST_TORQUE_NM))


def _sampled(trials: list[_Trial], samples: int, rng: np.random.Generator) -> Programme:
    """Sample the trials so that about ``samples`` readings fall outside the dead zone."""
    paths = [trial.path() for trial in trials]
    spans = np.array([knots[-1] for knots, _ in paths])
    share = np.sqrt(spans)
    read = np.array([_part_read(*path) for path in paths])
    counts = np.maximum(12, np.round(samples * share / (share * read).sum())).astype(int)
    columns: list[tuple[Array, ...]] = []
    clock = 0.0
    housing = trials[0].ambient_c
    for number, (trial, (knots, levels), count) in enumerate(
        zip(trials, paths, counts, strict=True), start=1
    ):
        step = max(0.05, round(float(knots[-1]) / int(count), 2))
        within = np.arange(1, int(knots[-1] / step) + 1) * step
        torque = np.interp(within, knots, levels)
        seen = np.abs(torque) >= SMALLEST_TORQUE_NM
        warming = np.exp(-within / 1500.0)
        temperature = trial.ambient_c + (housing - trial.ambient_c) * warming
        columns.append(
            (
                clock + within[seen],
                torque[seen],
                np.full(int(seen.sum()), float(number)),
                np.full(int(seen.sum()), trial.crank_deg),
                temperature[seen],
            )
        )
        rest = float(rng.uniform(120.0, 600.0))
        housing = float(
            trial.ambient_c + (temperature[-1] - trial.ambient_c) * np.exp(-rest / 1500.0)
        )
        clock += float(knots[-1]) + rest
    time, torque, run, crank, temperature = (
        np.concatenate([block[k] for block in columns]) for k in range(5)
    )
    return Programme(
        np.round(time, 3),
        np.round(torque, 5),
        run.astype(np.int64),
        np.round(crank, 3),
        np.round(temperature, 3),
    )


def _rich(samples: int, rng: np.random.Generator, second: bool) -> Programme:
    """Nested and biased loops, three rates, dwells, eight positions, changing temperature."""
    levels = (
        [0.85, 1.2, 1.75, 2.25, 2.75, 3.2, 3.7, 4.1, 1.5, 3.5, 2.0, 3.0]
        if second
        else [1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.3, 1.0, 2.5, 4.0, 1.75]
    )
    kinds = ["full", "nested", "dwell", "closed", "biased", "full"] * 2
    rates = [0.3, 1.1, 2.8] if second else [0.2, 0.75, 2.2]
    amplitudes = rng.permutation(levels) * RATED_INPUT_TORQUE_NM
    order = rng.permutation(kinds)
    positions = rng.uniform(0.0, 360.0, 8)
    visited = np.concatenate([rng.permutation(8), rng.choice(8, 4, replace=False)])
    speeds = rng.permutation(np.tile(rates, 4))
    start = float(rng.uniform(19.0, 23.0))
    ambient = start + np.concatenate(([0.0], rng.uniform(-3.0, 11.0, 11)))
    trials = []
    for k in range(12):
        corners, holds = _loop(str(order[k]), float(amplitudes[k]), rng)
        sign = 1.0 if k == 0 or rng.random() < 0.6 else -1.0
        trials.append(
            _Trial(
                tuple(sign * c for c in corners),
                holds,
                float(speeds[k]),
                float(positions[visited[k]]),
                float(ambient[k]),
            )
        )
    return _sampled(trials, samples, rng)


def _middle(samples: int, rng: np.random.Generator, second: bool) -> Programme:
    """Two amplitudes, two rates, three positions and one dwell."""
    top = float(rng.uniform(3.2, 4.3)) * RATED_INPUT_TORQUE_NM
    scale = 0.8 if second else 1.0
    rates = [0.5, 1.5] if second else [0.35, 1.4]
    positions = rng.uniform(0.0, 360.0, 3)
    start = float(rng.uniform(19.0, 23.0))
    kinds = ["full", "closed", "dwell", "biased", "full"]
    trials = []
    for k, kind in enumerate(kinds):
        amplitude = top * scale * (1.0 if k % 2 == 0 else 0.55)
        corners, holds = _loop(kind, amplitude, rng)
        trials.append(
            _Trial(corners, holds, rates[k % 2], float(positions[k % 3]), start + 0.8 * k)
        )
    return _sampled(trials, samples, rng)


def _repeated(kind: str, samples: int, rng: np.random.Generator, second: bool) -> Programme:
    """Three identical trials at one rate and one position: the usual catalogue test."""
    top = float(rng.uniform(2.6, 4.3)) * RATED_INPUT_TORQUE_NM * (0.75 if second else 1.0)
    rate = float(rng.uniform(0.3, 1.2)) * (1.6 if second else 1.0)
    crank = float(rng.uniform(0.0, 360.0))
    start = float(rng.uniform(19.0, 24.0))
    corners, holds = _loop(kind, top, rng)
    trials = [_Trial(corners, holds, rate, crank, start + 0.2 * k) for k in range(3)]
    return _sampled(trials, samples, rng)


def make_programme(
    name: str, rng: np.random.Generator, samples: int = 3000, *, second: bool = False
) -> Programme:
    """Draw a load programme.

    Parameters
    ----------
    name : {"oneway", "poor", "middle", "rich"}
        ``oneway``: one direction, one rate, one position, three times over. ``poor``: three
        identical full loops. ``middle``: two amplitudes and rates, three positions, one dwell.
        ``rich``: twelve trials with nested and biased loops, three rates, dwells, eight
        positions of which four are visited again, and a changing temperature.
    rng : numpy.random.Generator
        Source of everything that varies from one programme to the next.
    samples : int
        Readings wanted; reached within a few per cent.
    second : bool
        Draw the held-out programme instead: amplitudes and rates the first one does not have.

    Raises
    ------
    ValueError
        If the name is none of ``PROGRAMMES``.
    """
    if name == "rich":
        return _rich(samples, rng, second)
    if name == "middle":
        return _middle(samples, rng, second)
    if name == "poor":
        return _repeated("full", samples, rng, second)
    if name == "oneway":
        return _repeated("oneway", samples, rng, second)
    raise ValueError(f"programme: found {name!r}, expected one of {', '.join(PROGRAMMES)}")
