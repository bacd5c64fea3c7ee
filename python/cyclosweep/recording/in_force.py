"""The metadata file beside a recording while it is inspected: it stands, the file may disagree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cyclosweep.design.toml_files import read_toml
from cyclosweep.errors import InputError
from cyclosweep.recording.columns import refuse_missing_columns
from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.metadata import Column, Metadata, TableOptions
from cyclosweep.recording.metadata_text import toml_value
from cyclosweep.recording.proposed import Known, Proposal
from cyclosweep.recording.recording import Recording
from cyclosweep.recording.roles import Named
from cyclosweep.recording.stated_units import stated_unit

__all__ = ["InForce"]

_BY_OPTION = ("torque_unit", "angle_unit", "lever_arm_m", "nm_per_a", "counts_per_turn")
_OWN = ("columns", "table", "drive", "side")


@dataclass(slots=True)
class InForce:
    """A metadata file in force.

    Attributes
    ----------
    path : Path
        The file.
    meta : Metadata
        What it says; its side is the one that the user gives, if one is given.
    raw : dict
        Its keys as they are written.
    known : Known
        What the user says, completed by the file's table options.
    is_overridden : bool
        Whether the user names columns or units on the command line.
    """

    path: Path
    meta: Metadata
    raw: dict[str, Any]
    known: Known
    is_overridden: bool

    @classmethod
    def read(cls, path: Path, known: Known, given: Mapping[str, str | None]) -> InForce:
        """Read a metadata file.

        Parameters
        ----------
        path : Path
            The file.
        known : Known
            What the user says.
        given : mapping of str to str or None
            Columns that the user names, by canonical column.

        Returns
        -------
        InForce

        Raises
        ------
        InputError
            It is no metadata file.
        """
        meta = Metadata.read(path)
        own = known.table.model_dump(exclude_defaults=True)
        table = TableOptions.model_validate({**meta.table.model_dump(), **own})
        overridden = bool(own) or any(given.values())
        overridden |= any(getattr(known, name) is not None for name in _BY_OPTION)
        if known.side is not None:
            meta = meta.model_copy(update={"side": known.side})
        return cls(path, meta, read_toml(path), replace(known, table=table), overridden)

    def names(self, given: Mapping[str, str | None]) -> dict[str, str | None]:
        """Columns of the file by canonical column: those that the user names, then the settings'.

        Parameters
        ----------
        given : mapping of str to str or None
            Columns that the user names.

        Returns
        -------
        dict of str to str or None
        """
        own: dict[str, str | None] = {role: c.column for role, c in self.meta.columns.items()}
        for role, name in given.items():
            if name:
                own[role] = name
                self.meta.columns.pop(role, None)  # type: ignore[call-overload]
                self.raw.get("columns", {}).pop(role, None)
        return own

    def refuse_missing_columns(self, path: Path, table: FileTable) -> None:
        """Refuse a file that lacks a column which the settings name.

        Parameters
        ----------
        path : Path
            The recording's file.
        table : FileTable
            Its table.

        Raises
        ------
        InputError
            With the key and the columns that were found.
        """
        named = {str(role): source for role, source in self.meta.columns.items()}
        refuse_missing_columns(path, self.path, self.meta, named, table.header)

    def columns(self, table: FileTable) -> dict[str, dict[str, Any]]:
        """Columns that the settings say, each with the unit that the file states if they say none.

        Parameters
        ----------
        table : FileTable
            The file.

        Returns
        -------
        dict of str to dict
            By canonical column; a unit or constant that the user gives is left to the user.
        """
        found: dict[str, dict[str, Any]] = {}
        for role, source in self.meta.columns.items():
            if role == "torque_nm" and self.known.torque_unit is not None:
                continue
            if role == "angle_deg" and self.known.angle_unit is not None:
                continue
            column = source.model_dump(exclude_defaults=True)
            stated = stated_unit(table, source.column)
            if source.unit is None and source.scale == 1.0 and stated is not None and role != "run":
                complete = Column.model_validate({**column, "unit": stated[0]})
                column = complete.model_dump(exclude_defaults=True)
            found[role] = column
        return found

    def suggestions(self, by_file: Mapping[str, Named], made: Proposal) -> list[str]:
        """Say where the file suggests something else than the settings.

        Parameters
        ----------
        by_file : mapping of str to Named
            Columns that the file's own names and units suggest, by canonical column.
        made : Proposal
            What is proposed where the settings say nothing.

        Returns
        -------
        list of str
        """
        found = []
        read = {source.column for source in self.meta.columns.values()}
        for role, named in by_file.items():
            own = self.meta.columns.get(role)  # type: ignore[call-overload]
            if own is not None and own.column != named.column:
                found.append(
                    f"{role}: the settings read column {own.column!r}, by names and units it is "
                    f"{named.column!r}."
                )
            elif own is None and not named.is_canonical and named.column not in read:
                found.append(f"{role}: not read by the settings, could be {named.column!r}.")
        for key, value in made.meta.items():
            if key in _OWN or self.raw.get(key) == value:
                continue
            why = f" ({made.remarks[key]})" if made.remarks.get(key) else ""
            now = f", the settings say {toml_value(self.raw[key])}" if key in self.raw else ""
            found.append(f"{key} = {toml_value(value)}{why}{now}.")
        return found

    def put_into(self, made: Proposal) -> None:
        """Put what the settings say into a proposal, in which it stands before anything else."""
        for key, value in self.raw.items():
            if key not in _OWN:
                made.meta[key] = value
                made.remarks.pop(key, None)
        for key in ("columns", "table"):
            for name, value in self.raw.get(key, {}).items():
                if key == "columns" and name in ("torque_nm", "angle_deg"):
                    unit = self.known.torque_unit if name == "torque_nm" else self.known.angle_unit
                    if unit is not None:
                        continue
                made.meta.setdefault(key, {})[name] = value
                made.remarks.pop(f"{key}.{name}", None)

    def recording(self, path: Path) -> tuple[Recording | None, str | None]:
        """Read a recording by the settings alone.

        Parameters
        ----------
        path : Path
            Its file.

        Returns
        -------
        Recording or None
            None where they do not say which column is the torque.
        str or None
            Why not.

        Raises
        ------
        InputError
            The file cannot be read by what they say.
        """
        try:
            return Recording.read_as(path, self.meta, self.path), None
        except InputError as error:
            if "torque_nm" in self.meta.columns:
                raise
            return None, str(error)
