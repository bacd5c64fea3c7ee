"""The axes of a space: what values an input takes, as lists, equal steps or ranges."""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.active_pins import CRITERIA
from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import real_numbers, whole_number
from cyclosweep.design.parts import PART_DEFAULTS
from cyclosweep.errors import InputError, did_you_mean, instance_of, one_of
from cyclosweep.sweep.distributions import Distribution, Form

__all__ = [
    "OPTIONAL",
    "WHOLE",
    "Axis",
    "Linspace",
    "criterion_codes",
    "input_column",
    "is_count",
    "known_input",
    "linspace",
    "listed_axis",
    "sampled_axis",
]

WHOLE = frozenset(name for name, whole, _ in _core.input_table() if whole)
"""Inputs that take whole numbers only."""

OPTIONAL = frozenset(
    [name for name, _, optional in _core.input_table() if optional]
    + [name for name, (kind, *_) in PART_DEFAULTS.items() if kind in ("required", "absent")]
)
"""Inputs that a variant may leave out; no number is assumed instead of them."""

# Counts have at most three digits: a longer range is not one of whole numbers.
_LONGEST_COUNT = 2**16
_MOST_STEPS = 2**63


_SHOWN = 6
"""Values of a list that a representation shows; a longer one is cut."""


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis as the core knows it.

    Attributes
    ----------
    name : str
        The input that varies.
    form : {"list", "linspace", "interval", "whole", "normal", "triangular", "log-uniform"}
        How ``numbers`` are meant: the values; (from, to, steps); (low, high); (low, high); (mean,
        standard deviation, low, high, shares below low and high); (low, mode, high); (low, high).
    numbers : ndarray
        float64, in the input's unit.
    """

    name: str
    form: Form
    numbers: npt.NDArray[np.float64]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Axis) and self.definition() == other.definition()

    def __hash__(self) -> int:
        return hash((self.name, self.form, len(self.numbers)))

    def __str__(self) -> str:
        """What the axis takes, in words."""
        if self.form == "linspace":
            start, stop, steps = self.numbers
            return f"{start:g} to {stop:g}, {int(steps):,} steps"
        if self.form == "normal":
            mean, sd, low, high = self.numbers[:4]
            ends = "" if low == -math.inf and high == math.inf else f", {low:g} to {high:g}"
            return f"normal, {mean:g} +- {sd:g}{ends}"
        if self.form != "list":
            shape = f", {self.form}" if self.form in ("triangular", "log-uniform") else ""
            return f"{self.numbers[0]:g} to {self.numbers[-1]:g}{shape}"
        shown = self.numbers[:_SHOWN]
        names = [CRITERIA[int(v)] if self.name == "criterion" else f"{v:g}" for v in shown]
        more = f", ... ({len(self.numbers):,})" if len(self.numbers) > _SHOWN else ""
        return f"{', '.join(names)}{more}"

    def values(self) -> npt.NDArray[np.float64] | None:
        """All values in order; None for a range and for a distribution."""
        if self.form == "list":
            return self.numbers
        if self.form == "linspace":
            start, stop, steps = self.numbers
            return np.linspace(start, stop, int(steps))
        return None

    @functools.cached_property
    def dtype(self) -> pl.DataType:
        """Type of the axis's column: counts where every value is one."""
        if self.name == "criterion":
            return pl.Enum(CRITERIA)
        is_long = self.form == "linspace" and self.numbers[2] > _LONGEST_COUNT
        if self.name in WHOLE and not is_long:
            numbers = self.numbers if self.form != "linspace" else self.values()
            assert numbers is not None
            with np.errstate(invalid="ignore"):
                if np.all((numbers >= 0) & (numbers < 2**32) & (numbers == np.trunc(numbers))):
                    return pl.UInt32()
        return pl.Float64()

    def definition(self) -> dict[str, Any]:
        """Return what identifies this axis in the study's hash and in the manifest."""
        numbers = np.ascontiguousarray(self.numbers)
        if len(numbers) > 64:
            digest = hashlib.sha256(numbers.tobytes()).hexdigest()
            return {"name": self.name, "form": self.form, "count": len(numbers), "sha256": digest}
        return {"name": self.name, "form": self.form, "numbers": [repr(float(v)) for v in numbers]}


@dataclass(frozen=True)
class Linspace:
    """Equidistant values of an axis, both ends included; see :func:`linspace`."""

    start: float
    stop: float
    steps: int

    def axis(self, name: str) -> Axis:
        """Make these values the axis of an input; InputError where it cannot take them."""
        if self.steps < 1:
            raise InputError(f"{name}: found {self.steps} steps, expected at least 1")
        if self.steps > _MOST_STEPS:
            raise InputError(f"{name}: found more than 2^63 steps, expected fewer")
        if name == "criterion":
            raise InputError("criterion: expected a list of values, not a range")
        axis = Axis(name, "linspace", np.array([self.start, self.stop, self.steps], float))
        if is_count(name) and axis.dtype != pl.UInt32():
            raise InputError(
                f"{name}: {self.steps} steps from {self.start:g} to {self.stop:g} "
                "are not whole numbers, expected whole ones"
            )
        return axis


def linspace(start: float, stop: float, steps: int) -> Linspace:
    """Equidistant values of an axis, both ends included, in constant memory.

    Parameters
    ----------
    start, stop : float
        First and last value, in the axis's unit.
    steps : int
        How many values.

    Returns
    -------
    Linspace

    Raises
    ------
    InputError
        For an end that is no finite number, or steps that are no whole number.

    Examples
    --------
    >>> linspace(0.3, 0.8, 50).steps
    50
    """
    for name, value in (("start", start), ("stop", stop)):
        if not math.isfinite(real_numbers(f"linspace: {name}", [value])[0]):
            raise InputError(f"linspace: {name}: found {value!r}, expected a finite number")
    return Linspace(float(start), float(stop), whole_number("linspace: steps", steps))


def is_count(name: str) -> bool:
    """Whether an input takes whole numbers only."""
    return name in WHOLE


def known_input(drive: Drive, name: str) -> str:
    """Return the name of an input, and refuse one that a drive does not have.

    Parameters
    ----------
    drive : Drive
        Whose inputs.
    name : str
        The name.

    Returns
    -------
    str

    Raises
    ------
    InputError
        With the nearest name that the drive does have.
    """
    instance_of("drive", drive, Drive)
    known = drive.every_input()
    if name not in known:
        raise InputError(f"{name}: no such input of this drive{did_you_mean(name, known)}")
    return name


def criterion_codes(values: Iterable[object]) -> list[float]:
    """Numbers by which the core knows criteria; InputError for a name that is none."""
    codes = []
    for value in values:
        codes.append(float(CRITERIA.index(one_of("criterion", str(value), CRITERIA))))
    return codes


def input_column(
    column: pl.Series, row_name: Callable[[int], str] = lambda index: f"row {index}"
) -> pl.Series:
    """Return the values of an input, a row each.

    Parameters
    ----------
    column : polars.Series
        Cells, named as the input: numbers, texts that are numbers, or names of criteria.
    row_name : callable
        What a message calls a row, counted from 0.

    Returns
    -------
    polars.Series
        Numbers, null where a cell is empty; names of criteria as they were.

    Raises
    ------
    InputError
        For the first cell that is none.
    """
    words = CRITERIA if column.name == "criterion" else None
    if words is None and column.dtype.is_numeric():
        return column
    for index, cell in enumerate(column):
        is_right = cell in words if words is not None else _is_number(cell)
        if not is_right:
            expected = f"one of {', '.join(words)}" if words is not None else "a number"
            raise InputError(
                f"{row_name(index)}, {column.name}: found {cell!r}, expected {expected}"
            )
    return column if words is not None else column.cast(pl.Float64)


def _is_number(cell: object) -> bool:
    if cell is None or (isinstance(cell, (int, float)) and not isinstance(cell, bool)):
        return True
    try:
        return isinstance(cell, str) and math.isfinite(float(cell))
    except ValueError:
        return False


def listed_axis(drive: Drive, name: str, values: object) -> Axis:
    """Make an axis that takes each of its values, as every axis of a grid does.

    Parameters
    ----------
    drive : Drive
        What the axis belongs to.
    name : str
        The input that varies.
    values : Linspace or iterable
        Equal steps, or the values one by one in the input's unit; names for ``criterion``.

    Returns
    -------
    Axis

    Raises
    ------
    InputError
        For an unknown input, no values, or one that is no number.
    """
    known_input(drive, name)
    if isinstance(values, Linspace):
        return values.axis(name)
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise InputError(f"{name}: found {values!r}, expected a list of values or linspace(...)")
    numbers = criterion_codes(values) if name == "criterion" else real_numbers(name, values)
    if not numbers:
        raise InputError(f"{name}: no values, expected at least one")
    return Axis(name, "list", np.array(numbers))


def sampled_axis(drive: Drive, name: str, values: object) -> Axis:
    """Make an axis for sampling: a range, or values that are drawn with equal shares.

    Parameters
    ----------
    drive : Drive
        What the axis belongs to.
    name : str
        The input that varies.
    values : tuple of two numbers, Distribution, Linspace or iterable
        ``(low, high)`` in the input's unit, whole numbers for counts; a distribution, as
        ``normal(0.5, 0.01)``; or as for a grid.

    Returns
    -------
    Axis

    Raises
    ------
    InputError
        For an unknown input, a range from high to low, or values that are no numbers.
    """
    known_input(drive, name)
    if isinstance(values, Distribution):
        if is_count(name) or name == "criterion":
            raise InputError(f"{name}: found a distribution, expected a range or list of values")
        return Axis(name, *values.core())
    if isinstance(values, tuple) and len(values) == 2 and name != "criterion":
        low, high = real_numbers(name, values)
        if not (math.isfinite(low) and math.isfinite(high) and low <= high):
            raise InputError(f"{name}: found ({low:g}, {high:g}), expected (low, high)")
        if is_count(name) and not (low.is_integer() and high.is_integer()):
            raise InputError(f"{name}: found ({low:g}, {high:g}), expected whole numbers")
        return Axis(name, "whole" if is_count(name) else "interval", np.array([low, high]))
    if isinstance(values, (str, bytes)) or not isinstance(values, (Linspace, Iterable)):
        raise InputError(f"{name}: found {values!r}, expected (low, high) or a list of values")
    return listed_axis(drive, name, values)
