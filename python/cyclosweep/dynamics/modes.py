"""Natural frequencies of a train, their shapes, and what moves them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.dynamics.chain import Chain
from cyclosweep.errors import InputError

__all__ = ["Modes", "natural_frequencies_hz"]

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Modes:
    """Natural frequencies and shapes of a train, the slowest first.

    Attributes
    ----------
    train : Chain
        What they are modes of.
    stiffnesses_nm_per_rad : ndarray, shape (springs,)
        Stiffness that each spring has, on its own shaft [N m/rad].
    frequencies_hz : ndarray, shape (modes,)
        Natural frequencies [Hz]; exactly zero for a part of the train that nothing holds.
    shapes : ndarray, shape (modes, nodes)
        Angle of each node on its own shaft, the largest of a mode referred to the first shaft
        being one [1].
    """

    train: Chain
    stiffnesses_nm_per_rad: Reals
    frequencies_hz: Reals
    shapes: Reals
    _kinetic: Reals
    _potential: Reals

    @property
    def energy_shares(self) -> pl.DataFrame:
        """Who holds the energy of each mode.

        Returns
        -------
        polars.DataFrame
            ``mode`` (from 1), ``frequency_hz``, ``component``, ``kind`` (``inertia`` or
            ``spring``), ``share``: of the kinetic energy for inertias, of the elastic energy for
            springs (0 in a mode of frequency zero) [1].
        """
        rows = []
        for mode, frequency in enumerate(self.frequencies_hz):
            parts = (
                ("inertia", self.train.names, self._kinetic[mode]),
                ("spring", self.train.spring_names, self._potential[mode]),
            )
            for kind, names, shares in parts:
                for name, share in zip(names, shares, strict=True):
                    rows.append((mode + 1, float(frequency), name, kind, float(share)))
        schema = {
            "mode": pl.Int64,
            "frequency_hz": pl.Float64,
            "component": pl.String,
            "kind": pl.String,
            "share": pl.Float64,
        }
        return pl.DataFrame(rows, schema=schema, orient="row")

    @property
    def sensitivities(self) -> pl.DataFrame:
        """What each frequency does when an inertia or a stiffness grows.

        By Rayleigh's quotient a frequency grows by half of the spring's share of the elastic
        energy when the stiffness grows by one percent, and falls by half of the inertia's share of
        the kinetic energy.

        Returns
        -------
        polars.DataFrame
            ``mode``, ``frequency_hz``, ``component``, ``kind``, ``percent_per_percent`` [1] and
            ``hz_per_unit`` [Hz/(N m/rad)] or [Hz/(kg m^2)].
        """
        shares = self.energy_shares
        values = {
            **dict(zip(self.train.names, self.train.inertias_kg_m2, strict=True)),
            **dict(zip(self.train.spring_names, self.stiffnesses_nm_per_rad, strict=True)),
        }
        sign = pl.when(pl.col("kind") == "spring").then(0.5).otherwise(-0.5)
        moving = pl.col("frequency_hz") > 0
        elasticity = pl.when(moving).then(sign * pl.col("share")).otherwise(0.0)
        value = pl.col("component").replace_strict(values, return_dtype=pl.Float64)
        return shares.with_columns(percent_per_percent=elasticity).select(
            "mode",
            "frequency_hz",
            "component",
            "kind",
            "percent_per_percent",
            hz_per_unit=pl.col("percent_per_percent") * pl.col("frequency_hz") / value,
        )

    def summary(self, least: float = 0.01) -> pl.DataFrame:
        """Who holds each mode's energy, the greatest share first.

        Parameters
        ----------
        least : float
            Shares below it are left out [1].

        Returns
        -------
        polars.DataFrame
            ``mode``, ``frequency_hz``, ``component``, ``kind``, ``energy_share``,
            ``percent_per_percent``; modes of frequency zero left out.
        """
        keys = ("mode", "component", "kind")
        moved = self.sensitivities.select(*keys, "percent_per_percent")
        shares = self.energy_shares.rename({"share": "energy_share"})
        return (
            shares.join(moved, on=keys, maintain_order="left")
            .filter((pl.col("energy_share") >= least) & (pl.col("frequency_hz") > 0))
            .sort("mode", "energy_share", descending=[False, True])
        )

    def table(self) -> pl.DataFrame:
        """Frequencies with the shape of each mode.

        Returns
        -------
        polars.DataFrame
            ``mode``, ``frequency_hz``, and for each node its angle ``<name>``.
        """
        columns: dict[str, object] = {
            "mode": np.arange(1, len(self.frequencies_hz) + 1),
            "frequency_hz": self.frequencies_hz,
        }
        for name, shape in zip(self.train.names, self.shapes.T, strict=True):
            columns[name] = shape
        return pl.DataFrame(columns)


def natural_frequencies_hz(
    inertias_kg_m2: npt.ArrayLike, stiffnesses_nm_per_rad: npt.ArrayLike
) -> Reals:
    """Natural frequencies of many chains at once, on all cores.

    Parameters
    ----------
    inertias_kg_m2 : array_like, shape (chains, nodes)
        Inertias [kg m^2], all referred to one shaft.
    stiffnesses_nm_per_rad : array_like, shape (chains, nodes - 1) or (chains, nodes)
        Stiffnesses between neighbours [N m/rad]; with as many as inertias the last spring goes to
        the ground.

    Returns
    -------
    ndarray, shape (chains, nodes)
        Frequencies [Hz], the slowest first; zero exactly for the rigid mode, NaN for a chain with
        an inertia that is not above zero or a stiffness below zero.

    Raises
    ------
    InputError
        When the shapes do not fit.

    Examples
    --------
    >>> natural_frequencies_hz([[5.0, 11.0, 22.0]], [[1e5, 2e5]]).round(3)
    array([[ 0.   , 19.682, 32.254]])
    """
    inertias = np.ascontiguousarray(inertias_kg_m2, dtype=np.float64)
    stiffnesses = np.ascontiguousarray(stiffnesses_nm_per_rad, dtype=np.float64)
    if inertias.ndim != 2 or stiffnesses.ndim != 2:
        raise InputError("natural frequencies: expected tables with one row a chain")
    try:
        return _core.chain_frequencies(inertias, stiffnesses)
    except ValueError as error:
        raise InputError(f"natural frequencies: {error}") from None
