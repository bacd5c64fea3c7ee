"""Expressions of columns as text, such as `2 * eccentricity_mm < bush_wall_mm`, for polars."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping

import polars as pl

from cyclosweep.errors import InputError

__all__ = ["FUNCTIONS", "condition", "expression", "names_in", "number"]

FUNCTIONS = frozenset(
    [
        *("abs", "ceil", "floor", "mod", "round", "sign", "greatest", "least"),
        *("cbrt", "exp", "ln", "log", "log10", "log1p", "log2", "pi", "pow", "power", "sqrt"),
        *("acos", "asin", "atan", "atan2", "cos", "cosd", "cosh", "cot", "degrees", "radians"),
        *("sin", "sind", "sinh", "tan", "tand", "tanh", "coalesce", "if", "ifnull", "nullif"),
    ]
)
"""Functions of SQL that an expression may use: those whose value follows from one row alone."""

_WORDS = frozenset(
    [
        *("and", "or", "not", "in", "is", "null", "true", "false", "between", "like"),
        *("case", "when", "then", "else", "end"),
    ]
)
_TOKEN = re.compile(
    r"""(?P<text>'(?:[^']|'')*')
    |(?P<quoted>"[^"]+")
    |(?P<name>[^\W\d]\w*)
    |(?P<number>(?:\d+\.\d*|\.\d+|\d+)(?:[eE][+-]?\d+)?)
    |(?P<space>\s+)
    |(?P<sign>.)""",
    re.VERBOSE | re.DOTALL,
)
_HINTS = {"**": "power(a, b)", "^": "power(a, b)", "&": "and", "|": "or",
          ">>": "a comparison such as a_mm > b_mm", "<<": "a comparison such as a_mm < b_mm",
          "->": "a comparison such as a_mm > b_mm"}  # fmt: skip
"""Signs of other languages, and what SQL has for them."""


def expression(
    text: str, columns: Mapping[str, pl.DataType], *, where: str = "expression"
) -> pl.Expr:
    """Read an expression of columns, in the SQL of polars.

    Parameters
    ----------
    text : str
        For example ``ring_pin_circle_radius_mm - ring_pin_radius_mm - eccentricity_mm``: columns,
        numbers, ``+ - * / %``, comparisons, ``and``, ``or``, ``not``, ``between``, ``in``,
        ``case when ... then ... else ... end`` and :data:`FUNCTIONS`.
    columns : mapping of str to polars.DataType
        Columns there are, as ``frame.collect_schema()`` gives them.
    where : str
        What a message names: the key of the file.

    Returns
    -------
    polars.Expr
        Its value of a row depends on that row alone. Counts are computed with as real numbers, so
        that ``output_pin_count - 12`` may be below zero.

    Raises
    ------
    InputError
        For a column that is not there, with the nearest one that is; for a function that needs
        other rows than its own, as an average does; for text that is no expression.

    Examples
    --------
    >>> columns = {"eccentricity_mm": pl.Float64(), "output_pin_count": pl.UInt32()}
    >>> rows = pl.DataFrame({"eccentricity_mm": [0.5], "output_pin_count": [8]}, schema=columns)
    >>> rows.select(expression("0.5 * eccentricity_mm - output_pin_count", columns)).item()
    -7.75
    """
    if not isinstance(text, str) or not text.strip():
        raise InputError(f"{where}: found {text!r}, expected an expression of columns")
    if text.strip() in columns:
        return pl.col(text.strip())
    spelt = "".join(_spelt(text, columns, where))
    try:
        found = pl.sql_expr(spelt)
        _some_rows(columns).select(found)
    except pl.exceptions.PolarsError as error:
        reason = str(error).splitlines()[0].replace(f"'{spelt}'", "it")
        if reason.startswith("operator "):  # by a name that is polars' own
            reason = "it has another sign than + - * / %, comparisons, and, or, not"
        raise InputError(f"{where}: found {text!r}, which is no expression: {reason}") from None
    return found


def number(
    text: str,
    columns: Mapping[str, pl.DataType],
    *,
    where: str = "expression",
    allow_truth: bool = True,
) -> pl.Expr:
    """Read an expression whose value is a number; see :func:`expression`.

    Parameters
    ----------
    text, columns, where
        As for :func:`expression`.
    allow_truth : bool
        Take true and false for 1 and 0.

    Returns
    -------
    polars.Expr
        Of type Float64.

    Raises
    ------
    InputError
        As there, and where its value is a text or, unless allowed, true or false.
    """
    found = expression(text, columns, where=where)
    dtype = _dtype(found, columns)
    if not (dtype.is_numeric() or (allow_truth and dtype == pl.Boolean())):
        raise InputError(f"{where}: found {text!r}, which is no number, expected one")
    return found.cast(pl.Float64)


def condition(
    text: str, columns: Mapping[str, pl.DataType], *, where: str = "condition"
) -> pl.Expr:
    """Read an expression that is true or false; see :func:`expression`.

    Parameters
    ----------
    text, columns, where
        As for :func:`expression`.

    Returns
    -------
    polars.Expr
        Of type Boolean.

    Raises
    ------
    InputError
        As there, and where its value is a number or a text.
    """
    found = expression(text, columns, where=where)
    if _dtype(found, columns) != pl.Boolean():
        raise InputError(f"{where}: found {text!r}, expected a comparison such as a_mm < b_mm")
    return found


def names_in(text: str) -> list[str]:
    """Names of the columns that an expression reads, whether or not they are there.

    Parameters
    ----------
    text : str
        The expression.

    Returns
    -------
    list of str
        Each once, in order.

    Examples
    --------
    >>> names_in("least(a_mm, 2 * b_mm) > 0 and a_mm < 5")
    ['a_mm', 'b_mm']
    """
    tokens = [match for match in _TOKEN.finditer(text) if match.lastgroup != "space"]
    return list(dict.fromkeys(name for k in range(len(tokens)) if (name := _column(tokens, k))))


def _some_rows(columns: Mapping[str, pl.DataType]) -> pl.DataFrame:
    """Rows to try an expression on: polars finds some mistakes of type in computing only."""
    values = {name: [_some_value(kind), None] for name, kind in columns.items()}
    return pl.DataFrame(values, schema=dict(columns))


def _some_value(kind: pl.DataType) -> str | float | None:
    if isinstance(kind, pl.Enum):
        return str(kind.categories[0])
    if kind == pl.String():
        return "ok"
    if kind == pl.Boolean():
        return True
    return 1 if kind.is_numeric() else None


def _dtype(found: pl.Expr, columns: Mapping[str, pl.DataType]) -> pl.DataType:
    frame = pl.LazyFrame(schema=dict(columns))
    return frame.select(found.alias("value")).collect_schema()["value"]


def _column(tokens: list[re.Match[str]], place: int) -> str | None:
    """Name of the column that a token is; None for any other token."""
    token = tokens[place]
    if token.lastgroup == "quoted":
        return token[0][1:-1]
    if token.lastgroup != "name" or token[0].lower() in _WORDS:
        return None
    called = place + 1 < len(tokens) and tokens[place + 1][0] == "("
    return None if called else token[0]


def _spelt(text: str, columns: Mapping[str, pl.DataType], where: str) -> Iterator[str]:
    """Write an expression so that polars computes with reals; InputError for an unknown name."""
    for sign, wanted in _HINTS.items():
        if sign in re.sub(r"'[^']*'|\"[^\"]*\"", "", text):
            raise InputError(f"{where}: found {sign!r} in {text!r}, expected {wanted}")
    tokens = [match for match in _TOKEN.finditer(text) if match.lastgroup != "space"]
    for place, token in enumerate(tokens):
        name = _column(tokens, place)
        if name is not None:
            if name not in columns:
                raise InputError(f"{where}: no column {name}{_suggestion(name, columns)}")
            is_count = columns[name].is_integer()
            yield f' CAST("{name}" AS DOUBLE) ' if is_count else f' "{name}" '
        elif token.lastgroup == "name":
            word = token[0].lower()
            if word not in _WORDS and word not in FUNCTIONS:
                raise InputError(
                    f"{where}: found {token[0]}(...) in {text!r}, expected functions of one row, "
                    "such as abs, sqrt, power, sin, ln, least and greatest"
                )
            follow = "".join(sign[0] for sign in tokens[place + 1 : place + 3])
            if word in FUNCTIONS - {"pi"} and follow == "()":
                raise InputError(f"{where}: found {token[0]}() in {text!r}, expected {token[0]}(a)")
            yield f" {token[0]} "
        elif token.lastgroup == "number" and "." in token[0] and "e" not in token[0].lower():
            # Without an exponent polars would take it as a decimal of that many digits.
            yield f"{token[0]}e0"
        else:
            yield token[0]


def _suggestion(name: str, columns: Mapping[str, pl.DataType]) -> str:
    close = difflib.get_close_matches(name, columns, n=1)
    return f", did you mean {close[0]}?" if close else ""
