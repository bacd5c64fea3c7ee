"""What is varied: a space of variants in which variant k is a function of k alone."""

from __future__ import annotations

import difflib
import functools
import hashlib
import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.drive import CRITERIA, Drive
from cyclosweep.errors import InputError

__all__ = ["Axis", "Linspace", "Method", "Space", "linspace"]

Method = Literal["grid", "sobol", "latin-hypercube", "random", "table"]
MAX_VARIANTS = 2**63
# A longer range over a count cannot be of whole numbers that make sense.
_LONGEST_COUNT = 2**16
_WHOLE = frozenset(name for name, whole, _ in _core.input_table() if whole)
_OPTIONAL = frozenset(name for name, _, optional in _core.input_table() if optional)


@dataclass(frozen=True)
class Linspace:
    """Equidistant values of an axis, both ends included; see :func:`linspace`."""

    start: float
    stop: float
    steps: int


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
        if not np.isfinite(_numbers(f"linspace: {name}", [value])[0]):
            raise InputError(f"linspace: {name}: found {value!r}, expected a finite number")
    if isinstance(steps, bool) or not isinstance(steps, (int, np.integer)):
        raise InputError(f"linspace: steps: found {steps!r}, expected a whole number")
    return Linspace(float(start), float(stop), int(steps))


@dataclass(frozen=True)
class Axis:
    """One axis as the core knows it.

    Attributes
    ----------
    name : str
        The input that varies.
    form : {"list", "linspace", "interval", "whole"}
        How ``numbers`` are meant: the values; (from, to, steps); (low, high); (low, high).
    numbers : ndarray
        float64, in the input's unit.
    """

    name: str
    form: Literal["list", "linspace", "interval", "whole"]
    numbers: npt.NDArray[np.float64]

    def values(self) -> npt.NDArray[np.float64] | None:
        """All values in order; None for an interval or whole numbers of a range."""
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
        if self.name in _WHOLE and not is_long:
            numbers = self.numbers if self.form != "linspace" else self.values()
            assert numbers is not None
            with np.errstate(invalid="ignore"):
                if np.all((numbers >= 0) & (numbers < 2**32) & (numbers == np.trunc(numbers))):
                    return pl.UInt32()
        return pl.Float64()

    def definition(self) -> dict[str, Any]:
        """What makes this axis itself, for the study's hash and the manifest."""
        numbers = np.ascontiguousarray(self.numbers)
        if len(numbers) > 64:
            digest = hashlib.sha256(numbers.tobytes()).hexdigest()
            return {"name": self.name, "form": self.form, "count": len(numbers), "sha256": digest}
        return {"name": self.name, "form": self.form, "numbers": [repr(float(v)) for v in numbers]}


@dataclass(frozen=True, eq=False)
class Space:
    """A space of variants around a drive, up to 2^63 of them, in constant memory.

    Make one with :meth:`grid`, :meth:`sobol`, :meth:`latin_hypercube`, :meth:`random` or
    :meth:`table`. ``space[a:b]`` is the space of those variants, which keep their values;
    ``space[k]`` is the drive of variant k.

    Examples
    --------
    >>> space = Space.grid(Drive.reference_87(), output_pin_count=[6, 8, 9])
    >>> len(space), space[1].output_pin_count
    (3, 8)
    """

    drive: Drive
    method: Method
    axes: tuple[Axis, ...]
    total: int
    seed: int = 0
    start: int = 0
    stop: int = 0

    @classmethod
    def grid(cls, drive: Drive, /, **axes: Linspace | Iterable[float | str]) -> Space:
        """Every combination of the axes' values, the last axis fastest.

        Parameters
        ----------
        drive : Drive
            What does not vary.
        **axes
            For each input that varies a list of values or a :func:`linspace`.

        Raises
        ------
        InputError
            For an unknown input, an empty axis, a value that is not a number, or more than
            2^63 variants.
        """
        built = tuple(_countable(drive, name, values) for name, values in axes.items())
        return cls._made(drive, "grid", built, 1, 0)

    @classmethod
    def sobol(cls, drive: Drive, count: int, /, *, seed: int = 0, **axes: Any) -> Space:
        """Scrambled Sobol points; a power of two of them is balanced best.

        Parameters
        ----------
        drive : Drive
            What does not vary.
        count : int
            Number of variants, up to 2^63.
        seed : int
            Seed of the scrambling.
        **axes
            For each input that varies a range ``(low, high)``, whole numbers for counts, or a
            list of values.

        Raises
        ------
        InputError
            As for :meth:`grid`, without an axis, and for more than 128 axes.

        Notes
        -----
        Direction numbers of Joe and Kuo (2008), 64 bits, scrambled by a random lower-triangular
        matrix and a shift.
        """
        return cls._sampled(drive, "sobol", count, seed, axes)

    @classmethod
    def latin_hypercube(cls, drive: Drive, count: int, /, *, seed: int = 0, **axes: Any) -> Space:
        """Latin hypercube: on every axis each of ``count`` equal strata is met once.

        Parameters are those of :meth:`sobol`.
        """
        return cls._sampled(drive, "latin-hypercube", count, seed, axes)

    @classmethod
    def random(cls, drive: Drive, count: int, /, *, seed: int = 0, **axes: Any) -> Space:
        """Independent uniform points. Parameters are those of :meth:`sobol`."""
        return cls._sampled(drive, "random", count, seed, axes)

    @classmethod
    def table(cls, drive: Drive, frame: pl.DataFrame, /) -> Space:
        """One variant a row of a frame whose columns are inputs.

        Parameters
        ----------
        drive : Drive
            What does not vary.
        frame : polars.DataFrame
            Columns named as inputs; null and NaN are kept and give the status
            ``non_finite_input`` where the input is not optional.

        Raises
        ------
        InputError
            For a column that is no input or holds no numbers.
        """
        axes = []
        for column in frame.get_columns():
            name = _known(drive, column.name)
            if name == "criterion":
                numbers = _criterion_codes(column.to_list())
            else:
                if not column.dtype.is_numeric():
                    raise InputError(f"{name}: found {column.dtype}, expected numbers")
                numbers = column.cast(pl.Float64).fill_null(np.nan).to_numpy()
            axes.append(Axis(name, "list", np.ascontiguousarray(numbers, dtype=np.float64)))
        return cls._made(drive, "table", tuple(axes), frame.height, 0)

    @classmethod
    def _sampled(
        cls, drive: Drive, method: Method, count: int, seed: int, axes: Mapping[str, Any]
    ) -> Space:
        if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or count < 1:
            raise InputError(f"count: found {count!r}, expected a whole number above zero")
        is_whole = isinstance(seed, (int, np.integer)) and not isinstance(seed, bool)
        if not (is_whole and 0 <= seed < 2**64):
            raise InputError(f"seed: found {seed!r}, expected a whole number from 0 to 2^64 - 1")
        if not axes:
            raise InputError(f"{method}: no axes, expected at least one input that varies")
        built = tuple(_sampled_axis(drive, name, values) for name, values in axes.items())
        return cls._made(drive, method, built, int(count), int(seed))

    @classmethod
    def _made(
        cls, drive: Drive, method: Method, axes: tuple[Axis, ...], count: int, seed: int
    ) -> Space:
        if count > MAX_VARIANTS:
            raise InputError(f"count: found {count}, expected at most 2^63 variants")
        space = cls(drive, method, axes, count, seed)
        try:
            total = space.core().count
        except ValueError as error:
            raise InputError(f"axes: {error}") from None
        return replace(space, total=total, stop=total)

    def core(
        self,
        loads_tn: Sequence[float] = (),
        limits: Sequence[tuple[str, float, float]] = (),
    ) -> _core.Study:
        """Return the core's study over the whole space, slices not applied."""
        return _core.Study(
            list(self.drive.values().items()),
            [segment.kind for segment in self.drive.shaft],
            [(axis.name, axis.form, np.ascontiguousarray(axis.numbers)) for axis in self.axes],
            self.method,
            self.total,
            self.seed,
            list(loads_tn),
            list(limits),
        )

    def __len__(self) -> int:
        count = self.stop - self.start
        if count > sys.maxsize:
            raise OverflowError(
                f"{count:,} variants are one too many for len(), expected space.stop - space.start"
            )
        return count

    @overload
    def __getitem__(self, key: slice) -> Space: ...
    @overload
    def __getitem__(self, key: int) -> Drive: ...
    def __getitem__(self, key: slice | int) -> Space | Drive:
        if isinstance(key, slice):
            first, last, step = key.indices(self.stop - self.start)
            if step != 1:
                raise ValueError("a space is cut in steps of one")
            return replace(self, start=self.start + first, stop=self.start + max(first, last))
        count = self.stop - self.start
        if not -count <= key < count:
            raise IndexError(f"variant {key} of {count}")
        index = np.array([self.start + key % count], dtype=np.uint64)
        core = self.core()
        changes: dict[str, Any] = {}
        for axis in self.axes:
            value = float(core.axis_at(axis.name, index)[0])
            if axis.name == "criterion":
                changes[axis.name] = CRITERIA[int(value)]
            elif axis.name in _OPTIONAL and math.isnan(value):
                changes[axis.name] = None
            elif axis.name in _WHOLE and value.is_integer():
                changes[axis.name] = int(value)
            else:
                changes[axis.name] = value
        return self.drive.replace(**changes)

    def __repr__(self) -> str:
        axes = ", ".join(axis.name for axis in self.axes)
        count = self.stop - self.start  # len() ends at 2^63 - 1
        return f"<Space: {count:,} variants of {self.drive.name}, {self.method} over {axes}>"

    def definition(self) -> dict[str, Any]:
        """What makes this space itself, for the study's hash and the manifest."""
        drive = {name: repr(value) for name, value in self.drive.values().items()}
        return {
            "drive": drive,
            "shaft": [segment.kind for segment in self.drive.shaft],
            "method": self.method,
            "axes": [axis.definition() for axis in self.axes],
            "total": self.total,
            "seed": self.seed,
            "start": self.start,
            "stop": self.stop,
        }


def is_count(name: str) -> bool:
    """Whether an input takes whole numbers only."""
    return name in _WHOLE


def _known(drive: Drive, name: str) -> str:
    known = drive.inputs()
    if name not in known:
        close = difflib.get_close_matches(name, known, n=1)
        hint = f", did you mean {close[0]}?" if close else ""
        raise InputError(f"{name}: no such input of this drive{hint}")
    return name


def _criterion_codes(values: Iterable[object]) -> npt.NDArray[np.float64]:
    codes = []
    for value in values:
        if value not in CRITERIA:
            raise InputError(f"criterion: found {value!r}, expected one of {', '.join(CRITERIA)}")
        codes.append(CRITERIA.index(value))
    return np.array(codes, dtype=np.float64)


def _numbers(name: str, values: Iterable[object]) -> npt.NDArray[np.float64]:
    listed = list(values)
    for value in listed:
        if isinstance(value, (bool, np.bool_)) or not isinstance(
            value, (int, float, np.integer, np.floating)
        ):
            raise InputError(f"{name}: found {value!r}, expected a number")
    return np.array(listed, dtype=np.float64)


def _listed(drive: Drive, name: str, values: Iterable[object]) -> Axis:
    numbers = _criterion_codes(values) if name == "criterion" else _numbers(name, values)
    if len(numbers) == 0:
        raise InputError(f"{name}: no values, expected at least one")
    return Axis(name, "list", numbers)


def _countable(drive: Drive, name: str, values: Linspace | Iterable[object]) -> Axis:
    _known(drive, name)
    if isinstance(values, Linspace):
        if values.steps < 1:
            raise InputError(f"{name}: found {values.steps} steps, expected at least 1")
        if name == "criterion":
            raise InputError("criterion: expected a list of values, not a range")
        axis = Axis(name, "linspace", np.array([values.start, values.stop, values.steps], float))
        if name in _WHOLE and axis.dtype != pl.UInt32():
            raise InputError(
                f"{name}: {values.steps} steps from {values.start:g} to {values.stop:g} "
                "are not whole numbers, expected whole ones"
            )
        return axis
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise InputError(f"{name}: found {values!r}, expected a list of values or linspace(...)")
    return _listed(drive, name, values)


def _sampled_axis(drive: Drive, name: str, values: object) -> Axis:
    _known(drive, name)
    if isinstance(values, tuple) and len(values) == 2 and name != "criterion":
        low, high = _numbers(name, values)
        if not (np.isfinite(low) and np.isfinite(high) and low <= high):
            raise InputError(f"{name}: found ({low:g}, {high:g}), expected (low, high)")
        if name in _WHOLE:
            if low != np.trunc(low) or high != np.trunc(high):
                raise InputError(f"{name}: found ({low:g}, {high:g}), expected whole numbers")
            return Axis(name, "whole", np.array([low, high]))
        return Axis(name, "interval", np.array([low, high]))
    if isinstance(values, (Linspace, list, tuple, np.ndarray)):
        return _countable(drive, name, values)
    raise InputError(f"{name}: found {values!r}, expected (low, high) or a list of values")
