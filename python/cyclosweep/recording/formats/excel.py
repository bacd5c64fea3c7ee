"""Workbooks: .xlsx, .xlsm, .xlsb, .xls and .ods, read by calamine."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from cyclosweep.errors import InputError
from cyclosweep.recording.digit_groups import told_apart
from cyclosweep.recording.file_table import GridTable, spelling
from cyclosweep.recording.formats.installed import needs
from cyclosweep.recording.layout import SAMPLE_ROWS, bare_unit, find_layout, passed_note
from cyclosweep.recording.messages import one_line
from cyclosweep.recording.metadata import TableOptions

__all__ = ["read_excel"]


def read_excel(path: Path, options: TableOptions, wanted: Collection[str]) -> GridTable:
    """Read the first sheet that has a table, or the one that the metadata name.

    Parameters
    ----------
    path : Path
        The workbook.
    options : TableOptions
        Sheet, row of the names, spelling of numbers that are text.
    wanted : collection of str
        Names that the metadata give.

    Returns
    -------
    GridTable

    Raises
    ------
    InputError
        Not installed, damaged, or no sheet has a table.
    """
    calamine: Any = needs("python_calamine", path, "export the sheet as CSV")
    try:
        with calamine.CalamineWorkbook.from_path(str(path)) as book:
            names = list(book.sheet_names)
            if options.sheet is not None and options.sheet not in names:
                raise InputError(
                    f"{path}, key table.sheet: found {options.sheet!r}, expected one of "
                    f"{', '.join(names)}"
                )
            tables = []
            for name in [options.sheet] if options.sheet else names:
                rows = book.get_sheet_by_name(name).to_python(skip_empty_area=False)
                table = _table(path, rows, options, wanted)
                if table is not None:
                    tables.append((name, table))
    except InputError:
        raise
    except Exception as error:  # calamine has an exception for each format
        said = one_line(str(error)).rstrip(".")
        raise InputError(
            f"{path}: not a readable workbook ({said}); save it again as .xlsx, or export the "
            "sheet as CSV"
        ) from None
    if not tables:
        row = (
            "a row of names" if options.header_row is None else f"names in row {options.header_row}"
        )
        raise InputError(f"{path}: no sheet with {row} above numbers, found {', '.join(names)}")
    sheet, table = max(tables, key=lambda found: len(set(found[1].columns) & set(wanted)))
    others = [name for name, _ in tables if name != sheet]
    if others:
        table.notes.append(
            f"Sheet {sheet!r} read; {', '.join(map(repr, others))} have tables, too "
            "([table] sheet)."
        )
    return table


def _table(
    path: Path, rows: list[list[Any]], options: TableOptions, wanted: Collection[str]
) -> GridTable | None:
    """Find the table of a sheet.

    Parameters
    ----------
    path : Path
        For messages.
    rows : list of list
        Cells of the sheet.
    options, wanted
        As for `read_excel`.

    Returns
    -------
    GridTable or None
        None where the sheet has no names above numbers.
    """
    looked_at = rows[: (options.header_row or 0) + SAMPLE_ROWS]
    sample = [["" if cell is None else str(cell) for cell in row] for row in looked_at]
    given = None if options.header_row is None else options.header_row - 1
    layout = find_layout(sample, wanted, given)
    if layout is None or layout.header is None:
        return None
    names = [name.strip() for name in sample[layout.header]]
    units: dict[str, str] = {}
    if layout.units is not None:
        cells = [bare_unit(cell) for cell in sample[layout.units]]
        units = {n: u for n, u in zip(names, cells, strict=False) if n and u}
    body = rows[layout.first :]
    columns: dict[str, Any] = {}
    for place, name in enumerate(names):
        if not name:
            continue
        if name in columns:
            raise InputError(
                f"{path}, row {layout.header + 1}: column {name} appears more than once"
            )
        columns[name] = [row[place] if place < len(row) else "" for row in body]
    texts = [c for column in columns.values() for c in column if isinstance(c, str)]
    decimal, thousands = spelling(texts)
    if thousands in {"", decimal}:
        decimal, thousands = told_apart("\n".join(texts).encode(), "\n") or (decimal, thousands)
    notes = [f"Names of the columns found in row {layout.header + 1}."] if layout.header else []
    notes += [passed_note("Row", row + 1, sample[row]) for row in layout.passed]
    return GridTable(
        path, columns, units, notes, layout.first + 1,
        options.decimal or decimal, options.thousands or thousands,
    )  # fmt: skip
