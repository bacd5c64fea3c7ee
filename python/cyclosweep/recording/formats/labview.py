"""LabVIEW measurement files (.lvm): a header of keys, then one block of columns for each segment.

The layout is NI's "Specification for the LabVIEW Measurement File (.lvm)".
"""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.cells import MISSING, BadCellError, spelt_number
from cyclosweep.recording.file_table import GridTable

__all__ = ["read_lvm"]

_END = "***End_of_Header***"


def read_lvm(path: Path, content: bytes, missing: Sequence[str] = ()) -> GridTable:
    """Read all segments, one below the other.

    Parameters
    ----------
    path : Path
        The file, for messages.
    content : bytes
        Its text in UTF-8.
    missing : sequence of str
        Texts besides the usual ones that stand for a value that is not there.

    Returns
    -------
    GridTable
        With the column ``X_Value``, made of the time step where the file has none; a column
        ``segment`` where there are several.

    Raises
    ------
    InputError
        A header or a cell is not what the specification says.
    """
    lines = content.decode("utf-8", "replace").replace("\r\n", "\n").split("\n")
    keys = _keys(lines)
    separator = "," if keys.get("Separator", ["Tab"])[0].casefold() == "comma" else "\t"
    decimal = keys.get("Decimal_Separator", ["."])[0] or "."
    starts = [k for k, line in enumerate(lines) if line.startswith(_END)]
    columns: dict[str, list[Any]] = {}
    units: dict[str, str] = {}
    segments, first = 0, 1
    for at, stop in zip(starts[1:], [*starts[2:], len(lines)], strict=False):
        if at + 1 >= len(lines):
            break
        own = _keys(lines[_segment_start(lines, at) : at], separator)
        names = [cell.strip() for cell in lines[at + 1].split(separator)]
        data = [name for name in names if name and name not in ("X_Value", "Comment")]
        for name, unit in zip(data, own.get("Y_Unit_Label", []), strict=False):
            units.setdefault(name, unit.strip())
        units.setdefault("X_Value", (own.get("X_Dimension", ["Time"])[0] == "Time" and "s") or "")
        first = at + 3 if not segments else first
        block = _block(
            path, lines, range(at + 2, stop), names, separator, decimal, {*MISSING, *missing}
        )
        count = len(block[data[0]]) if data else 0
        if not np.isfinite(block.get("X_Value", [])).any():
            zero = spelt_number(own.get("X0", ["0"])[0], decimal, "") or 0.0
            step = spelt_number(own.get("Delta_X", ["1"])[0], decimal, "") or 1.0
            block["X_Value"] = list(zero + step * np.arange(count))
        segments += 1
        block["segment"] = [float(segments)] * count
        if columns and set(block) != set(columns):
            raise InputError(
                f"{path}, line {at + 2}: found columns {', '.join(names)}, expected those of the "
                "first segment"
            )
        for name, values in block.items():
            columns.setdefault(name, []).extend(values)
    if not columns:
        raise InputError(f"{path}: no segment with a header and samples")
    if segments == 1:
        del columns["segment"]
    units = {name: unit for name, unit in units.items() if unit and name in columns}
    return GridTable(path, {n: np.array(v) for n, v in columns.items()}, units, [], first)


def _keys(lines: list[str], separator: str = "") -> dict[str, list[str]]:
    """Values by key in a header, up to its end.

    Parameters
    ----------
    lines : list of str
        Lines from the first of the header on.
    separator : str
        Between cells; empty: a tabulator where a line has one, else a comma.

    Returns
    -------
    dict of str to list of str
    """
    found: dict[str, list[str]] = {}
    for line in lines:
        if line.startswith(_END):
            break
        cells = line.split(separator or ("\t" if "\t" in line else ","))
        found[cells[0].strip()] = [cell for cell in cells[1:] if cell.strip()]
    return found


def _segment_start(lines: list[str], end: int) -> int:
    """First line of the header of a segment.

    Parameters
    ----------
    lines : list of str
        The whole text.
    end : int
        Line at which the header ends.

    Returns
    -------
    int
    """
    start = end
    while start > 0 and lines[start - 1].strip() and not lines[start - 1].startswith(_END):
        start -= 1
    return start


def _block(
    path: Path,
    lines: list[str],
    rows: range,
    names: list[str],
    separator: str,
    decimal: str,
    missing: Collection[str],
) -> dict[str, list[float]]:
    """Read the samples of one segment, up to the header of the next.

    Parameters
    ----------
    path : Path
        For messages.
    lines : list of str
        The whole text.
    rows : range
        Lines of the segment and of the next one's header.
    names : list of str
        Columns.
    separator, decimal : str
        Character between cells, and decimal sign.
    missing : collection of str
        Texts that stand for a value that is not there.

    Returns
    -------
    dict of str to list of float

    Raises
    ------
    InputError
        For a cell that is no number.
    """
    block: dict[str, list[float]] = {n: [] for n in names if n and n != "Comment"}
    for row in rows:
        if not lines[row].strip():
            if any(lines[k].strip() for k in rows if k > row):
                break
            continue
        for name, cell in zip(names, lines[row].split(separator), strict=False):
            if name not in block:
                continue
            value = np.nan if cell.strip() in missing else spelt_number(cell, decimal, "")
            if value is None:
                raise BadCellError(f"{path}, line {row + 1}, column {name}", cell)
            block[name].append(value)
    longest = max(map(len, block.values()), default=0)
    return {name: values + [np.nan] * (longest - len(values)) for name, values in block.items()}
