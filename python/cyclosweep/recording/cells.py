"""Single cells of a table: numbers in any country's spelling, and what stands for none."""

import re

from cyclosweep.errors import InputError
from cyclosweep.recording.messages import shown

__all__ = [
    "MINUS",
    "MISSING",
    "BadCellError",
    "is_number",
    "number_in",
    "spelt_number",
]

MISSING = [
    *("", "NA", "N/A", "na", "n/a", "n.a.", "null", "NULL", "None", "-", "--", "---", "----"),
    *("#N/A", "#NV", "#NUM!", "#VALUE!", "#DIV/0!", "k.A."),
    *(
        f"{sign}1.#{text}"
        for sign in ("", "-")
        for text in ("QNAN", "QNAN0", "SNAN", "IND", "IND00", "IND0000", "INF", "INF00")
    ),
]
"""Cell contents that stand for a value that is not there.

The texts of an amplifier beyond its range, such as OVERLOAD, are none of them: the drive saw that
load, so whoever reads the file has to say that its rows are to be passed over.
"""

MINUS = "\N{MINUS SIGN}"
"""Sign that word processors and some locales write before negative numbers."""

_GROUPED = re.compile(r"[+-]?\d{1,3}(?:(?P<sign>[.,'’  ])\d{3})(?:(?P=sign)\d{3})*(?:[.,]\d*)?")
_PLAIN = re.compile(
    r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eEdD][+-]?\d+)?|[+-]?(?:nan|inf|infinity)", re.IGNORECASE
)


_FORTRAN = re.compile(r"[+-]?[\d.]+[dD][+-]?\d+")


class BadCellError(InputError):
    """A cell with text where a number belongs.

    Attributes
    ----------
    cell : str
        Its text.
    where : str
        File, line or row, column, what was found and what was expected.
    """

    def __init__(self, place: str, cell: str) -> None:
        """Say where the cell stands and how to pass over its row.

        Parameters
        ----------
        place : str
            File, line or row, and column.
        cell : str
            Its text.
        """
        self.cell = cell.strip()
        self.where = f"{place}: found {shown(cell)}, expected a number"
        super().__init__(
            f"{self.where}; [table] missing = [{shown(cell)}] in the settings passes over such rows"
        )


def number_in(cell: str) -> float | None:
    """Value of a cell, None where it is not a number."""
    if "_" in cell:
        return None
    if _FORTRAN.fullmatch(cell):
        cell = cell.lower().replace("d", "e")
    try:
        return float(cell)
    except ValueError:
        return None


def is_number(cell: str) -> bool:
    """Whether a cell is a number in any spelling: 1362.82, 1.362,820 or 1,362.82."""
    cell = cell.strip().replace(MINUS, "-")
    return bool(_PLAIN.fullmatch(cell) or _GROUPED.fullmatch(cell))


def spelt_number(cell: str, decimal: str, thousands: str) -> float | None:
    """Value of a cell in a country's spelling.

    Parameters
    ----------
    cell : str
        The cell.
    decimal : str
        Decimal sign.
    thousands : str
        Signs that may divide groups of three digits; empty: none.

    Returns
    -------
    float or None
        None where it is no number in this spelling.

    Examples
    --------
    >>> spelt_number("1.362,820", ",", ".")
    1362.82
    >>> spelt_number("1.36,2", ",", ".") is None
    True
    """
    cell = cell.strip().replace(MINUS, "-")
    if thousands and (grouped := _GROUPED.fullmatch(cell)) and grouped["sign"] in thousands:
        cell = cell.replace(grouped["sign"], "")
    if decimal == ",":
        cell = cell.replace(",", ".") if "." not in cell else "?"
    return number_in(cell)
