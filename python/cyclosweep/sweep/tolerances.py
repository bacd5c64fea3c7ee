"""Tolerances of a drive's inputs: how far made pieces deviate, alone and batch by batch."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import whole_number
from cyclosweep.design.part_units import PART_INPUTS
from cyclosweep.design.toml_files import read_toml, refuse_other_kind
from cyclosweep.design.units import INPUTS, is_input
from cyclosweep.errors import InputError, did_you_mean, naming
from cyclosweep.sweep.axes import is_count, known_input
from cyclosweep.sweep.distributions import Distribution, distribution_from, uniform

__all__ = ["Tolerances", "deviations", "nominal_value", "pieces"]

_MOST_PIECES = 2**32 - 1
_BATCH_SEED = 0x6261_7463_6865_7300
"""Added to the seed of the batches' draws, which must not be those of the pieces."""
_KEYS = ("tolerances", "batches", "batch_size")


@dataclass(frozen=True)
class Tolerances:
    """How far made pieces deviate from the drawing.

    Attributes
    ----------
    inputs : mapping
        Deviation of each piece from its batch, by input: ``0.01`` for anything within +-0.01, a
        pair ``(low, high)``, or a distribution of deviations. A log-uniform one is a factor.
    batches : mapping
        Deviation that all pieces of a batch share, by input, in the same forms: of a tool or a
        setting that lasts for a batch. What varies alone and with the batch adds up.
    batch_size : int
        Pieces of a batch.

    Examples
    --------
    >>> Tolerances({"eccentricity_mm": 0.01}).inputs["eccentricity_mm"].high
    0.01
    """

    inputs: Mapping[str, Any] = field(default_factory=dict)
    batches: Mapping[str, Any] = field(default_factory=dict)
    batch_size: int = 1

    def __post_init__(self) -> None:
        inputs = {name: _deviation(name, given) for name, given in self.inputs.items()}
        batches = {name: _deviation(name, given) for name, given in self.batches.items()}
        for name in (*self.inputs, *self.batches):
            if not is_input(str(name)):
                hint = did_you_mean(name, [*INPUTS, *PART_INPUTS])
                raise InputError(f"tolerances.{name}: no such input of a drive{hint}")
        whole_number("batch_size", self.batch_size, least=1)
        if not inputs and not batches:
            raise InputError("tolerances: none, expected at least one input and its deviation")
        object.__setattr__(self, "inputs", inputs)
        object.__setattr__(self, "batches", batches)

    @property
    def names(self) -> tuple[str, ...]:
        """Inputs that deviate."""
        return tuple(dict.fromkeys([*self.inputs, *self.batches]))

    @classmethod
    def of(cls, given: Tolerances | Mapping[str, Any]) -> Tolerances:
        """Make tolerances of a mapping of inputs; tolerances pass through."""
        if isinstance(given, Tolerances):
            return given
        if not isinstance(given, Mapping):
            raise InputError(f"tolerances: found {given!r}, expected deviations by input")
        return cls(dict(given))

    @classmethod
    def from_toml(cls, path: str | Path) -> Tolerances:
        """Read a tolerance file.

        Parameters
        ----------
        path : str or Path
            Tables ``[tolerances]`` and, where there are batches, ``[batches]`` and the key
            ``batch_size``. Each input has a number or a distribution, as
            ``{ distribution = "normal", sd = 0.004 }``.

        Raises
        ------
        InputError
            One line that names the file, the key or the kind of file that was found, and what was
            expected.
        """
        table = read_toml(path)
        refuse_other_kind(table, "tolerances", path)
        with naming(path):
            for key in table:
                if key not in _KEYS:
                    raise InputError(f"{key}: no such key{did_you_mean(key, _KEYS)}")
            read = {
                key: {name: _from_file(f"{key}.{name}", given) for name, given in each.items()}
                for key in _KEYS[:2]
                if isinstance(each := table.get(key, {}), dict)
            }
            size = table.get("batch_size", 1)
            if read.get("batches") and "batch_size" not in table:
                raise InputError("batch_size: missing, expected how many pieces share a batch")
            return cls(read.get("tolerances", {}), read.get("batches", {}), size)

    def __repr__(self) -> str:
        batches = f", batches of {self.batch_size:,}" if self.batches else ""
        return f"<Tolerances of {', '.join(self.names)}{batches}>"


def deviations(
    tolerances: Tolerances, count: int, *, seed: int = 0
) -> dict[str, tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]]:
    """Draw what makes pieces deviate.

    Parameters
    ----------
    tolerances : Tolerances
        How far they do.
    count : int
        Number of pieces; they come batch after batch.
    seed : int
        Seed of the draws.

    Returns
    -------
    dict
        For each input factors [1] and what is added [the input's unit], each of shape (count,): a
        piece has the drawing's value times the one plus the other.
    """
    found = {name: (np.ones(count), np.zeros(count)) for name in tolerances.names}
    size = tolerances.batch_size
    batch_count = -(-count // size)
    # Sobol points that follow each other lie in different places by design, which the pieces of
    # a batch do not; the strata of a Latin hypercube are met in no order.
    layout = "latin-hypercube" if tolerances.batches else "sobol"
    for spread, draws, repeats, own_seed in (
        (tolerances.inputs, count, 1, seed),
        (tolerances.batches, batch_count, size, (seed + _BATCH_SEED) % 2**64),
    ):
        if not spread:
            continue
        axes = [(name, *each.core()) for name, each in spread.items()]
        values = _core.sample(axes, layout, draws, own_seed, 0, draws)
        for (name, each), column in zip(spread.items(), values, strict=True):
            factor, added = found[name]
            drawn = np.repeat(column, repeats)[:count]
            if each.kind == "log-uniform":
                factor *= drawn
            else:
                added += drawn
    return found


def pieces(
    drive: Drive, tolerances: Tolerances | Mapping[str, Any], count: int, *, seed: int = 0
) -> pl.DataFrame:
    """Inputs of pieces of one drive as manufacturing makes them.

    Parameters
    ----------
    drive : Drive
        The drive as drawn.
    tolerances : Tolerances or mapping
        As for :meth:`~cyclosweep.sweep.space_makers.SpaceMakers.around`.
    count : int
        Number of pieces.
    seed : int
        Seed of the draws.

    Returns
    -------
    polars.DataFrame
        A column for each input that deviates, in its unit.

    Raises
    ------
    InputError
        For an unknown input, one that the drive has no value of, or a whole number.
    """
    tolerances = Tolerances.of(tolerances)
    count = whole_number("count", count, least=1, most=_MOST_PIECES)
    seed = whole_number("seed", seed, least=0, most=2**64 - 1)
    values = {name: nominal_value(drive, name) for name in tolerances.names}
    drawn = deviations(tolerances, count, seed=seed)
    return pl.DataFrame(
        {name: values[name] * factor + added for name, (factor, added) in drawn.items()}
    )


def nominal_value(drive: Drive, name: str) -> float:
    """Value of an input as drawn.

    Parameters
    ----------
    drive : Drive
        The drive.
    name : str
        The input.

    Returns
    -------
    float
        In the input's unit.

    Raises
    ------
    InputError
        For an unknown input, one without a value, a whole number or the criterion.
    """
    try:
        known_input(drive, name)
    except InputError as error:
        raise InputError(f"tolerances.{error}") from None
    if is_count(name) or name == "criterion":
        raise InputError(
            f"tolerances.{name}: a whole number or a word does not deviate, expected another input"
        )
    published = drive.values()
    value = published[name] if name in published else getattr(drive, name)
    if value is None or math.isnan(value):
        raise InputError(f"tolerances.{name}: the drive has no value of it, expected one")
    return float(value)


def _deviation(name: str, given: object) -> Distribution:
    """A distribution of deviations; a number means anything up to it on either side."""
    if isinstance(given, Distribution):
        return given
    try:
        if isinstance(given, tuple | list) and len(given) == 2:
            return uniform(*given)
        if isinstance(given, int | float) and not isinstance(given, bool) and given > 0:
            return uniform(-given, given)
    except InputError as error:
        raise InputError(f"tolerances.{name}: {error}") from None
    raise InputError(
        f"tolerances.{name}: found {given!r}, expected a deviation above 0, (low, high) or a "
        "distribution"
    )


def _from_file(where: str, given: object) -> Any:
    if isinstance(given, Mapping):
        return distribution_from(where, given)
    return given
