"""A locked-output test along torque-twist curves: Coulomb friction, free play, noise and a dial."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import polars as pl

Array = npt.NDArray[np.float64]

LARGEST_SHARE = 0.9
"""Largest torque of a programme over the largest one of its curve."""


@dataclass(frozen=True)
class Curve:
    """Torques at which the crank begins to move, over its angle.

    Attributes
    ----------
    angle_deg : ndarray, shape (n,)
        Angles, rising [deg].
    forwards_nm : ndarray, shape (n,)
        Torque above which it moves on [N m].
    backwards_nm : ndarray, shape (n,)
        Torque below which it moves back [N m].
    """

    angle_deg: Array
    forwards_nm: Array
    backwards_nm: Array

    @classmethod
    def read(cls, path: Path) -> Curve:
        """Read what ``cyclosweep torque-twist --side input`` has written.

        Parameters
        ----------
        path : pathlib.Path
            The file.

        Returns
        -------
        Curve

        Raises
        ------
        ValueError
            When it has no torques of loading and unloading.
        """
        table = pl.read_csv(path)
        needed = ("angle_deg", "loading_torque_nm", "unloading_torque_nm")
        if not set(needed) <= set(table.columns):
            raise ValueError(f"{path}: expected columns {', '.join(needed)}")
        table = table.select(needed).cast(pl.Float64).drop_nulls().sort("angle_deg")
        if table.height < 3:
            raise ValueError(f"{path}: expected torques of loading and unloading, --side input")
        angle, loading, unloading = (table[name].to_numpy() for name in needed)
        return cls(angle, np.maximum(loading, unloading), np.minimum(loading, unloading))

    def largest_torque(self) -> float:
        """Torque that both directions reach [N m]."""
        return float(min(self.forwards_nm.max(), -self.backwards_nm.min()))

    def follow(self, torque_nm: Array) -> Array:
        """Angle of the crank along a torque, from the middle of the play on.

        Parameters
        ----------
        torque_nm : ndarray, shape (n,)
            Torque at the crank [N m].

        Returns
        -------
        ndarray, shape (n,)
            In deg. The crank rests while the torque is between those that move it.
        """
        angle = np.empty(len(torque_nm))
        place = 0.0
        for k, torque in enumerate(torque_nm):
            if torque > np.interp(place, self.angle_deg, self.forwards_nm):
                place = _first(self.angle_deg, self.forwards_nm, place, float(torque))
            elif torque < np.interp(place, self.angle_deg, self.backwards_nm):
                mirrored = -self.angle_deg[::-1], -self.backwards_nm[::-1]
                place = -_first(*mirrored, -place, -float(torque))
            angle[k] = place
        return angle


def _first(angle: Array, torque: Array, start: float, wanted: float) -> float:
    """First angle beyond `start` at which a torque is reached; the last one if none does.

    Parameters
    ----------
    angle, torque : ndarray, shape (n,)
        A curve, angles rising [deg], [N m].
    start : float
        Angle to start from [deg].
    wanted : float
        Torque to reach [N m].

    Returns
    -------
    float
        In deg.
    """
    ahead = np.flatnonzero((angle > start) & (torque >= wanted))
    if not len(ahead):
        return float(angle[-1])
    end = int(ahead[0])
    low, high = float(torque[end - 1]), float(torque[end])
    if high <= wanted or high <= low:
        return float(angle[end])
    part = (wanted - low) / (high - low)
    return max(start, float(angle[end - 1] + part * (angle[end] - angle[end - 1])))


def programme(largest_nm: float, samples: int) -> Array:
    """Torque of one run: to the largest one, to its negative and back to nothing.

    Parameters
    ----------
    largest_nm : float
        Largest torque [N m].
    samples : int
        Readings.

    Returns
    -------
    ndarray, shape (samples,)
        In N m.
    """
    corners = np.array([0.0, 1.0, -1.0, 0.0]) * largest_nm
    return np.interp(np.linspace(0.0, 4.0, samples), [0.0, 1.0, 3.0, 4.0], corners)


def record(
    curves: dict[float, Curve],
    rng: np.random.Generator,
    samples: int,
    *,
    noise_deg: float,
    resolution_deg: float,
) -> pl.DataFrame:
    """One run a curve, as a dial reads it.

    Parameters
    ----------
    curves : dict
        Curves by the angle of the crank in the middle of the play [deg].
    rng : numpy.random.Generator
        Source of the noise.
    samples : int
        Readings of each run.
    noise_deg : float
        Standard deviation of a reading [deg].
    resolution_deg : float
        Step of the dial [deg]; 0: continuous.

    Returns
    -------
    polars.DataFrame
        Canonical columns and ``clean_deg``, the angle without noise and dial.
    """
    tables = []
    for run, (crank, curve) in enumerate(sorted(curves.items()), 1):
        torque = programme(LARGEST_SHARE * curve.largest_torque(), samples)
        clean = curve.follow(torque)
        read = clean + rng.normal(0.0, noise_deg, samples)
        if resolution_deg > 0:
            read = resolution_deg * np.round(read / resolution_deg)
        tables.append(
            pl.DataFrame(
                {
                    "time_s": np.arange(samples) + (run - 1) * (samples + 60.0),
                    "torque_nm": torque.round(5),
                    "angle_deg": read.round(5),
                    "run": np.full(samples, run),
                    # The mesh zone stands where the crank does.
                    "crank_deg": np.full(samples, crank),
                    "clean_deg": clean,
                }
            )
        )
    return pl.concat(tables)
