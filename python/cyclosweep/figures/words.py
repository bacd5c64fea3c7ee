"""Short names of columns for axes, each with its unit."""

from __future__ import annotations

import re

from cyclosweep.design.units import quantity

__all__ = ["axis_label", "short_name"]


def axis_label(column: str, *, breaks: bool = False) -> str:
    """Name of a column and its unit, as an axis carries them.

    Parameters
    ----------
    column : str
        A column, or an expression of columns, which stays as it is.
    breaks : bool
        Whether the unit stands on a line of its own.

    Returns
    -------
    str

    Examples
    --------
    >>> axis_label("output_stiffness_nm_per_arcmin")
    'output stiffness [N m/arcmin]'
    >>> axis_label("output_pin_count")
    'output pin count [1]'
    >>> axis_label("2 * bush_wall_mm")
    '2 * bush_wall_mm'
    """
    unit = _unit(column)
    if unit is None:
        return short_name(column)
    between = "\n" if breaks else " "
    return f"{short_name(column)}{between}[{unit}]"


def short_name(column: str) -> str:
    """Name of a column in words, without its unit.

    Parameters
    ----------
    column : str
        A column, or an expression of columns, which stays as it is.

    Returns
    -------
    str

    Examples
    --------
    >>> short_name("twist_4p5tn_deg"), short_name("free_play_deg")
    ('twist at 4.5 T_N', 'free play')
    >>> short_name("lost_motion_3pct_arcmin")
    'lost motion at 3 %'
    """
    unit = _unit(column)
    if unit is None:
        return column
    name = column
    plain = unit.lower().replace("/", "_per_").replace("(", "").replace(")", "").replace("^", "")
    for suffix in (plain.replace(" ", ""), plain.replace(" ", "_")):
        name = name.removesuffix(f"_{suffix}")
    words = name.split("_")
    if words[0] == "twist" and words[-1].endswith("tn"):
        load = words[-1].removesuffix("tn").replace("p", ".")
        return f"twist at {'-' if 'minus' in words else ''}{load} T_N"
    return re.sub(r"\b(\d+)pct\b", r"at \1 %", " ".join(words))


def _unit(column: str) -> str | None:
    """Unit of a known column; None of any other text."""
    try:
        return quantity(column).unit
    except KeyError:
        return None
