"""Load programmes: torque, clock, run, mesh position and temperature of every reading."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SMALLEST = 0.06
"""Torque below which a bench gives no reading, in rated torques: the shaft is in its play."""
SPEED_STEPS = (1.0, 3.0, 10.0)
"""Three loading speeds of a rich programme, as multiples of the slowest."""
KINDS = ("rich", "poor", "weights")

LOOPS: dict[str, tuple[float, ...]] = {
    "full": (1.0, 0.0, -1.0, 0.0),
    "nested": (1.0, 0.4, 0.9, 0.2, 0.7, 0.0, -0.8, -0.3, -1.0, 0.0),
    "biased": (0.6, 0.15, 0.6, 0.15, 0.8, 0.3, 1.0, 0.0, -0.5, 0.0),
    "negative": (-1.0, -0.25, -0.9, 0.0, 0.8, 0.3, 0.6, 0.0),
    "stairs": (0.25, 0.5, 0.75, 1.0, 0.5, 0.0, -0.5, -1.0, -0.4, 0.0),
}
"""Turning points of a run, in parts of the largest torque; every run begins at zero."""


@dataclass(frozen=True)
class Path:
    """Load history sampled where readings are taken; each array has shape (N,).

    Attributes
    ----------
    load : array
        Torque in rated torques [-].
    time_s : array
        Clock [s]; known here also where a recording has none.
    run : array of int
        Number of the run; it rises from run to run.
    crank_deg : array
        Mesh position at which the output was locked [deg].
    temperature_c : array
        Temperature of the housing [deg C].
    """

    load: Array
    time_s: Array
    run: NDArray[np.int64]
    crank_deg: Array
    temperature_c: Array

    def __len__(self) -> int:
        return len(self.load)

    @property
    def starts(self) -> NDArray[np.bool_]:
        """Whether a row is the first of its run, shape (N,)."""
        return np.asarray(np.diff(self.run, prepend=self.run[0] - 1) != 0)


def _ramps(
    points: tuple[float, ...], speeds: list[float], dwell_s: float
) -> tuple[list[float], list[float]]:
    """Corner times [s] and loads [rated torques] of one run."""
    time, load, now, before = [0.0], [0.0], 0.0, 0.0
    for k, point in enumerate(points):
        now += abs(point - before) / speeds[k % len(speeds)]
        time.append(now)
        load.append(point)
        if dwell_s > 0.0 and point != 0.0:
            now += dwell_s
            time.append(now)
            load.append(point)
        before = point
    return time, load


def make_path(
    kind: str,
    rng: np.random.Generator,
    rows: int,
    top: float,
    positions_deg: Array,
    *,
    again: bool = False,
    smallest: float = SMALLEST,
) -> Path:
    """Lay out a load programme.

    Parameters
    ----------
    kind : {"rich", "poor", "weights"}
        Nested and biased loops at three speeds with dwells, several positions and a warm soak;
        identical loops at one speed and position; or weights hung on and off by hand.
    rng : numpy.random.Generator
        Source of chance.
    rows : int
        Readings wanted; those too close to zero torque are missing.
    top : float
        Largest torque in rated torques [-].
    positions_deg : array
        Mesh positions to visit, in turn [deg].
    again : bool
        The unseen second programme: other loops, nine tenths of the torque.
    smallest : float
        Torque below which nothing is read [rated torques].

    Raises
    ------
    ValueError
        If the kind is unknown.
    """
    if kind == "weights":
        return _weights(rng, rows, top * (0.9 if again else 1.0), float(positions_deg[0]))
    if kind not in KINDS:
        raise ValueError(f"programme: found {kind!r}, expected one of {', '.join(KINDS)}")
    slow = float(np.exp(rng.uniform(np.log(0.01), np.log(0.05))))
    if kind == "rich":
        names = [str(n) for n in rng.permutation(list(LOOPS))] * 3
        names = names[: 6 if again else max(2, min(12, rows // 25))]
    else:
        names = ["full"] * (2 if again else max(1, min(4, rows // 15)))
    reach = top * (0.9 if again else 1.0)
    each = max(rows // len(names), 4)
    order = rng.permutation(len(positions_deg))
    begin, columns = 0.0, []
    for number, name in enumerate(names, start=1):
        points = tuple(reach * p for p in LOOPS[name])
        if kind == "rich":
            points = tuple(p * float(rng.uniform(0.85, 1.0)) for p in points)
            speeds = [slow * SPEED_STEPS[(k // 2 + number) % 3] for k in range(len(points))]
            dwell = float(rng.uniform(0.1, 0.4)) * reach / slow if number % 2 else 0.0
        else:
            speeds, dwell = [3.0 * slow], 0.0
        corners, loads = _ramps(points, speeds, dwell)
        # Half of the readings are even in time and half even in torque, so that slow ramps,
        # dwells and fast ramps are all seen.
        travelled = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(loads)))])
        mixed = np.array(corners) / corners[-1] + travelled / travelled[-1]
        instants = np.interp(np.linspace(0.0, 2.0, each + 1)[1:], mixed, corners)
        turn = order[(number - 1) % len(order)]
        columns.append(
            (
                np.interp(instants, corners, loads),
                begin + instants,
                np.full(each, number, dtype=np.int64),
                np.full(each, positions_deg[turn]),
            )
        )
        begin += corners[-1] + (float(rng.uniform(30.0, 300.0)) if kind == "rich" else 20.0)
    load, time, run, crank = (np.concatenate(part) for part in zip(*columns, strict=True))
    path = Path(load, time, run, crank, _temperature(kind, rng, time))
    keep = np.abs(path.load) >= smallest
    return Path(*(getattr(path, name)[keep] for name in path.__dataclass_fields__))


def _temperature(kind: str, rng: np.random.Generator, time_s: Array) -> Array:
    """Housing temperature: even on a poor bench, a warm soak with a pause on a rich one [deg C]."""
    room = float(rng.uniform(18.0, 24.0))
    if kind != "rich":
        return np.full(len(time_s), room)
    share = time_s / max(float(time_s[-1]), 1.0)
    heated = 1.0 - np.exp(-np.maximum(share - rng.uniform(0.05, 0.2), 0.0) / rng.uniform(0.15, 0.4))
    cooled = np.maximum(share - rng.uniform(0.55, 0.8), 0.0) * rng.uniform(0.5, 1.5)
    return np.asarray(room + rng.uniform(10.0, 25.0) * (heated - cooled), dtype=float)


def _weights(rng: np.random.Generator, rows: int, top: float, position_deg: float) -> Path:
    """Weights hung on a lever by hand and taken off, one direction and then the other."""
    runs = 2 if rows >= 40 else 1
    quarter = max((rows // runs + 2) // 4, 4)
    up = np.linspace(top / quarter, top, quarter)
    loop = np.concatenate([up, up[-2::-1], -up, -up[-2::-1]])
    load = np.concatenate([loop] * runs)
    run = np.repeat(np.arange(1, runs + 1), len(loop))
    time = np.cumsum(rng.uniform(15.0, 45.0, len(load)))
    room = np.full(len(load), float(rng.uniform(18.0, 24.0)))
    return Path(load, time, run.astype(np.int64), np.full(len(load), position_deg), room)
