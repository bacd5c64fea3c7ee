"""A study on disk, opened to choose from: its drive, its columns, its rows, its summary."""

from __future__ import annotations

import ast
import json
import math
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

import polars as pl

from cyclosweep.design.active_pins import CRITERIA
from cyclosweep.design.drive import Drive
from cyclosweep.design.inputs import DriveInputs
from cyclosweep.design.numbers import whole_number
from cyclosweep.design.parts import Engine
from cyclosweep.errors import InputError, path_of
from cyclosweep.sweep.dataset_files import MANIFEST, parts_of, read_footer, read_manifest
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.study import StudyModel
from cyclosweep.sweep.summary import PartSummary, Summary, merge

__all__ = ["StoredStudy", "open_study"]


@dataclass(frozen=True)
class StoredStudy:
    """A finished or unfinished study on disk.

    Attributes
    ----------
    folder : Path
        Where it is.
    drive : Drive
        What does not vary, with the marks of where its numbers come from.
    axes : tuple of str
        Inputs that vary.
    definition : dict
        What decides the numbers: method, axes, loads, limits, and the model where it is not the
        published one alone.
    columns : dict
        Symbol, unit and meaning of every column.
    hash, version : str
        SHA-256 of the definition, and the version of cyclosweep that computed it.
    variants, rows : int
        Variants of the whole study, and those that are there.
    objectives : tuple of Objective
        What its best variants are best in.
    parts : tuple of Path
        The Parquet files, in order.
    """

    folder: Path
    drive: Drive
    axes: tuple[str, ...]
    definition: dict[str, Any]
    columns: dict[str, dict[str, str]]
    hash: str
    version: str
    variants: int
    rows: int
    objectives: tuple[Objective, ...]
    parts: tuple[Path, ...]

    @property
    def objective(self) -> Objective | None:
        """The first objective; None where there is none."""
        return self.objectives[0] if self.objectives else None

    @property
    def complete(self) -> bool:
        """Whether every variant is there."""
        return self.rows == self.variants

    @property
    def frame(self) -> pl.LazyFrame:
        """The rows, in order of their variants."""
        return pl.scan_parquet(list(self.parts))

    @property
    def model(self) -> StudyModel:
        """Whether the component model's columns are there."""
        found = self.definition.get("model", "published")
        return "components" if found == "components" else "published"

    @property
    def solver(self) -> Engine | None:
        """The engine that solved the component model; None without it."""
        found = self.definition.get("solver")
        return "full" if found == "full" else "quadratic" if found == "quadratic" else None

    @property
    def loads_tn(self) -> tuple[float, ...]:
        """Loads [T_N] at which twists were computed."""
        return tuple(float(load) for load in self.definition.get("loads_tn", ()))

    @property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest value of each column that a feasible variant has."""
        return {name: (float(low), float(high)) for name, low, high in self.definition["limits"]}

    @property
    def own_columns(self) -> frozenset[str]:
        """Columns of the user's own, which the stored study does not tell how to compute."""
        return frozenset(name for name, _ in self.definition.get("own_columns", ()))

    @cached_property
    def summary(self) -> Summary:
        """Counts by status, ranges of the results and best variants, of the parts' footers."""
        records = [footer["record"] for path in self.parts if (footer := read_footer(path))]
        return merge(
            [PartSummary.from_json(record) for record in records],
            list(self.columns),
            self.objectives,
            {name: about["unit"] for name, about in self.columns.items()},
        )

    def row(self, variant: int) -> dict[str, Any]:
        """Return the row of one variant.

        Parameters
        ----------
        variant : int
            Its number, as in the column ``variant``.

        Raises
        ------
        InputError
            When the study, or what is there of it, has no such variant.
        """
        number = whole_number("variant", variant)
        found = self.frame.filter(pl.col("variant") == number).collect()
        if found.is_empty():
            first = self.definition.get("start", 0)
            raise InputError(
                f"{self.folder}: no variant {number}, expected one from {first} to "
                f"{first + self.variants - 1}"
                + ("" if self.complete else f", of which {self.rows:,} are there")
            )
        return found.row(0, named=True)

    def drive_of(self, variant: int, *, name: str | None = None) -> Drive:
        """Return the drive of one variant.

        Parameters
        ----------
        variant : int
            Its number.
        name : str, optional
            What it is called; by default the study's drive and the number.

        Returns
        -------
        Drive
            What varies is marked as derived from the study.

        Raises
        ------
        InputError
            When there is no such variant, or its inputs are none a drive can have.
        """
        row = self.row(variant)
        known = self.drive.every_input()
        whole = {key for key, field in DriveInputs.model_fields.items() if field.annotation is int}
        changes: dict[str, Any] = {}
        for axis in self.axes:
            value = row[axis]
            if isinstance(value, float) and math.isnan(value):
                value = None
            if axis in whole and isinstance(value, float) and value.is_integer():
                value = int(value)
            if axis in known:
                changes[axis] = value
        try:
            drive = self.drive.replace(**changes)
        except InputError as error:
            raise InputError(f"{self.folder}: variant {variant}: {error}") from None
        origin = f"derived: variant {variant} of study {self.hash[:12]}"
        marks = {**drive.provenance, **{k: origin for k, v in changes.items() if v is not None}}
        called = name or f"{self.drive.name}, variant {variant}"
        return drive.model_copy(update={"name": called, "provenance": marks})

    def __repr__(self) -> str:
        share = "" if self.complete else f"{self.rows:,} of "
        return (
            f"<StoredStudy {self.folder}: {share}{self.variants:,} variants of {self.drive.name} "
            f"over {', '.join(self.axes)}>"
        )


def open_study(folder: str | Path) -> StoredStudy:
    """Open a finished or unfinished study.

    Parameters
    ----------
    folder : str or Path
        Where a sweep was written.

    Returns
    -------
    StoredStudy

    Raises
    ------
    InputError
        When the folder holds no study, or one whose manifest is missing or damaged.

    Examples
    --------
    >>> import tempfile, cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8, 9])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = cs.sink(space, folder)
    ...     study = cs.open_study(folder)
    ...     study.rows, study.axes, study.drive_of(2).output_pin_count
    (3, ('output_pin_count',), 9)
    """
    folder = path_of("folder", folder)
    if not folder.is_dir():
        found = "is a file" if folder.exists() else "no such folder"
        raise InputError(f"{folder}: {found}, expected the folder of a study")
    manifest = read_manifest(folder)
    parts = parts_of(folder)
    if manifest is None and (parts or (folder / MANIFEST).exists()):
        found = "holds no JSON object" if (folder / MANIFEST).exists() else "missing"
        raise InputError(
            f"{folder / MANIFEST}: {found}, expected a study's manifest; sweeping the study again "
            "into this folder writes it and keeps its parts"
        )
    if manifest is None:
        raise InputError(f"{folder}: no study there, expected a folder that a sweep was written to")
    if not parts:
        raise InputError(f"{folder}: no part of the study is there yet, expected at least one")
    try:
        definition = manifest["definition"]
        first = manifest.get("objective")
        given = manifest.get("objectives", [] if first is None else [first])
        derived = [name for name, _ in definition.get("derived", [])]
        records = [footer["record"] for path in parts if (footer := read_footer(path))]
        return StoredStudy(
            folder=folder,
            drive=_drive(manifest),
            axes=(*(axis["name"] for axis in definition["axes"]), *derived),
            definition=definition,
            columns=manifest["columns"],
            hash=manifest["study"],
            version=manifest["version"],
            variants=manifest["variants"],
            rows=sum(record["stop"] - record["start"] for record in records),
            objectives=tuple(Objective(column, bool(most)) for column, most in given),
            parts=tuple(parts),
        )
    except (KeyError, TypeError, ValueError, InputError) as error:
        raise InputError(f"{folder}: manifest is damaged ({error}); sweep again") from None


def _drive(manifest: dict[str, Any]) -> Drive:
    """Drive of a study; of an older one, whose manifest has the numbers alone, without marks."""
    if "drive" in manifest:
        return Drive.from_json(json.dumps(manifest["drive"]))
    definition = manifest["definition"]
    table: dict[str, Any] = {"name": "drive", "shaft": [{"kind": k} for k in definition["shaft"]]}
    for key, text in definition["drive"].items():
        value = float(text)
        if match := re.fullmatch(r"shaft_(\d+)_(\w+)", key):
            table["shaft"][int(match[1]) - 1][match[2]] = value
        elif key == "criterion":
            table[key] = CRITERIA[int(value)]
        elif not math.isnan(value):
            is_whole = int in (DriveInputs.model_fields[key].annotation, *_arguments(key))
            table[key] = int(value) if is_whole else value
    if not table["shaft"]:
        del table["shaft"]
    for key, text in {**definition.get("parts", {}), **definition.get("train", {})}.items():
        if (number := ast.literal_eval(text)) is not None:
            table[key] = number
    return Drive.from_json(json.dumps(table))


def _arguments(key: str) -> tuple[Any, ...]:
    return get_args(DriveInputs.model_fields[key].annotation)
