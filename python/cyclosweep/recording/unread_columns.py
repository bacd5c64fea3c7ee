"""Columns of a file that are not read, though their names say what a diagnosis looks for."""

from collections.abc import Mapping

from cyclosweep.errors import InputError
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.metadata import Column, Metadata
from cyclosweep.recording.roles import describe

__all__ = ["unread_columns"]

OPTIONAL = ("time_s", "run", "crank_deg", "temperature_c")
"""Canonical columns that a file may lack."""


def unread_columns(meta: Metadata, sources: Mapping[str, Column], table: FileTable) -> list[Fault]:
    """Remark on columns that could be the clock, the runs, the mesh position or the temperature.

    Without them what follows the position looks like a zero that moves from run to run. Where the
    settings name columns, what they leave out is left out on purpose.

    Parameters
    ----------
    meta : Metadata
        What the settings say.
    sources : mapping of str to Column
        File column of each canonical one.
    table : FileTable
        The file.

    Returns
    -------
    list of Fault
        One for each canonical column that the file lacks, and another column could be.
    """
    if meta.columns:
        return []
    read = {source.column for source in sources.values()} | set(meta.keep) | set(meta.abs_max)
    others = [column for column in table.header if column not in read]
    remarks = []
    for name in OPTIONAL:
        if sources[name].column in table.header:
            continue
        for column in others:
            named = describe(column, table.units.get(column))
            if named.role == name and not named.is_command and _varies(table, column, name):
                remarks.append(
                    Fault(
                        "column_unread",
                        None,
                        f"Column {column!r} is not read, and could be {name}: name it under "
                        "[columns], or let `cyclosweep inspect` propose that file.",
                    )
                )
                break
    return remarks


def _varies(table: FileTable, column: str, name: str) -> bool:
    """Whether a column holds numbers, more than one of them; text may be a clock nobody knows.

    Parameters
    ----------
    table : FileTable
        The file.
    column : str
        One of its columns.
    name : str
        Canonical column that it could be.

    Returns
    -------
    bool
    """
    try:
        values = table.read([column], [])[column]
    except InputError:
        return name == "time_s"
    return values.drop_nulls().drop_nans().n_unique() > 1
