"""A space of variants of a drive, in which variant k is a function of k alone."""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, overload

import numpy as np
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.active_pins import CRITERIA
from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import whole_number
from cyclosweep.design.units import quantity
from cyclosweep.errors import InputError, instance_of
from cyclosweep.notebook import html_table
from cyclosweep.sweep.any_table import as_frame
from cyclosweep.sweep.axes import (
    OPTIONAL,
    WHOLE,
    Axis,
    Linspace,
    criterion_codes,
    known_input,
    linspace,
    listed_axis,
    sampled_axis,
)
from cyclosweep.sweep.derived import Derived, derivations, with_derived
from cyclosweep.sweep.space_makers import SpaceMakers

__all__ = ["Axis", "Linspace", "Method", "Space", "linspace"]

Method = Literal["grid", "sobol", "latin-hypercube", "random", "table"]
Layout = Method | Literal["saltelli"]
"""How variants are laid out; the last for Sobol indices alone, which no study file asks for."""
MAX_VARIANTS = 2**63


@dataclass(frozen=True)
class Space(SpaceMakers):
    """A space of variants around a drive, up to 2^63 of them, in constant memory.

    Make one with :meth:`grid`, :meth:`sobol`, :meth:`latin_hypercube`, :meth:`random`,
    :meth:`table`, :meth:`around` or :meth:`from_salib`. ``space[a:b]`` is the space of those
    variants, which keep their values; ``space[k]`` is the drive of variant k.

    Examples
    --------
    >>> space = Space.grid(Drive.reference_87(), output_pin_count=[6, 8, 9])
    >>> len(space), space[1].output_pin_count
    (3, 8)
    """

    drive: Drive
    method: Layout
    axes: tuple[Axis, ...]
    total: int
    seed: int = 0
    start: int = 0
    stop: int = 0
    derived: tuple[Derived, ...] = ()

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
        built = tuple(listed_axis(drive, name, values) for name, values in axes.items())
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
            For each input that varies a range ``(low, high)``, whole numbers for counts, a
            distribution (:mod:`cyclosweep.sweep.distributions`), or a list of values.

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

        Parameters
        ----------
        drive : Drive
            What does not vary.
        count : int
            Number of variants, up to 2^63.
        seed : int
            Seed of the permutations.
        **axes
            As for :meth:`sobol`.

        Raises
        ------
        InputError
            As for :meth:`sobol`.
        """
        return cls._sampled(drive, "latin-hypercube", count, seed, axes)

    @classmethod
    def random(cls, drive: Drive, count: int, /, *, seed: int = 0, **axes: Any) -> Space:
        """Independent uniform points.

        Parameters
        ----------
        drive : Drive
            What does not vary.
        count : int
            Number of variants, up to 2^63.
        seed : int
            Seed of the draws.
        **axes
            As for :meth:`sobol`.

        Raises
        ------
        InputError
            As for :meth:`sobol`.
        """
        return cls._sampled(drive, "random", count, seed, axes)

    @classmethod
    def table(cls, drive: Drive, frame: Any, /) -> Space:
        """One variant a row of a table whose columns are inputs.

        Parameters
        ----------
        drive : Drive
            What does not vary.
        frame : polars.DataFrame, pandas.DataFrame, pyarrow.Table, mapping or structured ndarray
            Columns named as inputs; null and NaN are kept and give the status
            ``non_finite_input`` where the input is not optional.

        Raises
        ------
        InputError
            For a column that is no input or holds no numbers.
        """
        table = as_frame(frame)
        axes = []
        for column in table.get_columns():
            name = known_input(drive, column.name)
            if name == "criterion":
                numbers = np.array(criterion_codes(column.to_list()))
            else:
                if not column.dtype.is_numeric():
                    raise InputError(f"{name}: found {column.dtype}, expected numbers")
                numbers = column.cast(pl.Float64).fill_null(np.nan).to_numpy()
            axes.append(Axis(name, "list", np.ascontiguousarray(numbers, dtype=np.float64)))
        return cls._made(drive, "table", tuple(axes), table.height, 0)

    @classmethod
    def _sampled(
        cls, drive: Drive, method: Layout, count: int, seed: int, axes: Mapping[str, Any]
    ) -> Space:
        count = whole_number("count", count, least=1)
        seed = whole_number("seed", seed, most=2**64 - 1)
        if not axes:
            raise InputError(f"{method}: no axes, expected at least one input that varies")
        built = tuple(sampled_axis(drive, name, values) for name, values in axes.items())
        return cls._made(drive, method, built, count, seed)

    @classmethod
    def _made(
        cls, drive: Drive, method: Layout, axes: tuple[Axis, ...], count: int, seed: int
    ) -> Space:
        if count > MAX_VARIANTS:
            raise InputError(f"count: found {count}, expected at most 2^63 variants")
        instance_of("drive", drive, Drive)
        space = cls(drive, method, axes, count, seed)
        try:
            total = space.core().count
        except ValueError as error:
            raise InputError(f"axes: {error}") from None
        return replace(space, total=total, stop=total)

    def derive(self, **quantities: str | float) -> Space:
        """Return this space with inputs that follow from others, variant by variant.

        Parameters
        ----------
        **quantities
            Expression of each by name: of an input, whose value in the drive it replaces, or of a
            quantity of your own that other expressions use. It may name axes, keys of the drive
            and other derived quantities; see :mod:`cyclosweep.sweep.expressions`.

        Returns
        -------
        Space
            Each quantity is a column of its sweeps.

        Raises
        ------
        InputError
            For an expression that names what is not there, an axis, or quantities that follow
            from each other.

        Examples
        --------
        >>> space = Space.grid(Drive.reference_87(), eccentricity_mm=[0.5, 0.6]).derive(
        ...     rim_mm="4 + eccentricity_mm",
        ...     disc_outer_radius_mm="ring_pin_circle_radius_mm - rim_mm",
        ... )
        >>> space[1].disc_outer_radius_mm
        70.4
        """
        given: dict[str, str | float] = {each.name: each.text for each in self.derived}
        found = derivations(self.drive, self.axes, given | quantities)
        return replace(self, derived=found)

    def on_rows(self, inputs: pl.DataFrame) -> Space:
        """Return the space of some variants whose inputs, derived ones included, are columns."""
        axes = []
        for name in inputs.columns:
            if name in self.varying and name in self.drive.every_input():
                column = inputs[name].to_physical().cast(pl.Float64).fill_null(math.nan)
                axes.append(Axis(name, "list", np.ascontiguousarray(column.to_numpy())))
        return Space(self.drive, "table", tuple(axes), inputs.height, 0, 0, inputs.height)

    @property
    def varying(self) -> frozenset[str]:
        """Inputs that vary: axes, and those that follow from them."""
        return frozenset([*(a.name for a in self.axes), *(d.name for d in self.derived)])

    def core(
        self,
        loads_tn: Sequence[float] = (),
        limits: Sequence[tuple[str, float, float]] = (),
    ) -> _core.Study:
        """Return the core's study over the whole space, slices not applied.

        Parameters
        ----------
        loads_tn : sequence of float
            Loads [T_N].
        limits : sequence of (str, float, float)
            Column, least and greatest value in the column's unit.

        Returns
        -------
        cyclosweep._core.Study
        """
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
        key = operator.index(key)
        count = self.stop - self.start
        if not -count <= key < count:
            raise IndexError(f"variant {key} of {count}")
        index = np.array([self.start + key % count], dtype=np.uint64)
        core = self.core()
        changes: dict[str, Any] = {}
        numbers = {axis.name: float(core.axis_at(axis.name, index)[0]) for axis in self.axes}
        if self.derived:
            table = pl.DataFrame({name: [value] for name, value in numbers.items()})
            if "criterion" in numbers:
                words = pl.lit(CRITERIA[int(numbers["criterion"])], dtype=pl.Enum(CRITERIA))
                table = table.with_columns(words.alias("criterion"))
            row = with_derived(table, self.drive, self.derived).row(0, named=True)
            inputs = self.drive.every_input()
            own = {each.name: row[each.name] for each in self.derived if each.name in inputs}
            numbers |= {name: math.nan if value is None else value for name, value in own.items()}
        for name, value in numbers.items():
            if name == "criterion":
                changes[name] = CRITERIA[int(value)]
            elif name in OPTIONAL and math.isnan(value):
                changes[name] = None
            elif name in WHOLE and value.is_integer():
                changes[name] = int(value)
            else:
                changes[name] = value
        return self.drive.replace(**changes)

    def __repr__(self) -> str:
        axes = ", ".join(axis.name for axis in self.axes)
        count = self.stop - self.start  # len() ends at 2^63 - 1
        return f"<Space: {count:,} variants of {self.drive.name}, {self.method} over {axes}>"

    def _repr_html_(self) -> str:
        drive = self.drive
        rows = {
            "variants": f"{self.stop - self.start:,} of {drive.name} ({drive.ratio}:1)",
            "method": self.method if self.method == "grid" else f"{self.method}, seed {self.seed}",
            **{f"{axis.name} [{quantity(axis.name).unit}]": axis for axis in self.axes},
        }
        return html_table("Space", rows)

    def definition(self) -> dict[str, Any]:
        """Return what identifies this space in the study's hash and in the manifest."""
        drive = {name: repr(value) for name, value in self.drive.values().items()}
        derived = {"derived": [[each.name, each.text] for each in self.derived]}
        return {
            **(derived if self.derived else {}),
            "drive": drive,
            "shaft": [segment.kind for segment in self.drive.shaft],
            "method": self.method,
            "axes": [axis.definition() for axis in self.axes],
            "total": self.total,
            "seed": self.seed,
            "start": self.start,
            "stop": self.stop,
        }
