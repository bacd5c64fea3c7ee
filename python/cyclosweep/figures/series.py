"""Stiffness, play, lost motion and active pins over load and over clearance."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.figures.style import (
    COLOURS,
    DASHES,
    TWO_COLUMNS_MM,
    headline,
    new_figure,
    note,
    styled,
)
from cyclosweep.sweep.scan import sweep
from cyclosweep.sweep.space import Space

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cyclosweep.design.drive import Drive

__all__ = [
    "OVER_CLEARANCE",
    "OVER_LOAD",
    "clearance_series_figure",
    "load_series_figure",
    "play_arcmin",
    "series_rows",
]

OVER_LOAD = {
    "loaded_twist_arcmin": "twist [arcmin]",
    "tangent_stiffness_100pct_nm_per_arcmin": "tangent stiffness [N m/arcmin]",
    "active_output_pins_mean": "active output pins [1]",
    "effective_output_pins": "effective output pins [1]",
    "output_pin_force_max_n": "largest force on a pin [N]",
    "input_torque_ripple_pp": "ripple of the input torque [1]",
}
"""Results drawn over the load, and their axes."""

OVER_CLEARANCE = {
    "tangent_stiffness_100pct_nm_per_arcmin": "tangent stiffness [N m/arcmin]",
    "lost_motion_3pct_arcmin": "lost motion at 3 % [arcmin]",
    "play_arcmin": "play at the output [arcmin]",
    "active_output_pins_mean": "active output pins [1]",
}
"""Results drawn over the clearance of the holes, and their axes."""

_SMALL_LOAD = 0.02
"""Load over the rated one up to which a drive is turned to find the ends of its play [1]."""

_LOADS = tuple(0.05 + 4.45 * k / 44 for k in range(45))
_CLEARANCES_MM = tuple(0.2 * k / 32 for k in range(33))


@styled
def load_series_figure(
    drive: Drive,
    *,
    hole_clearances_mm: Sequence[float] = (0.0, 0.05, 0.1, 0.15),
    loads: Sequence[float] = _LOADS,
) -> Figure:
    """Draw twist, stiffness, active pins and the largest force over the load.

    Parameters
    ----------
    drive : Drive
        A drive with a component model.
    hole_clearances_mm : sequence of float
        A line each [mm]; one to six.
    loads : sequence of float
        Output torque over the rated one [1].

    Returns
    -------
    matplotlib.figure.Figure
        Lines ``gid`` the column's name, one for each clearance in order.

    Raises
    ------
    DesignError
        When the drive cannot be built or has no component model.
    InputError
        For a number that is none, or too many lines.
    """
    rows = series_rows(drive, hole_clearances_mm, loads, tuple(OVER_LOAD))
    lines = {f"{clearance:g} mm": rows.filter(pl.col("hole_clearance_mm") == clearance)
             for clearance in hole_clearances_mm}  # fmt: skip
    figure = _panels(lines, OVER_LOAD, "load", "output torque over the rated one [1]",
                     "hole clearance")  # fmt: skip
    headline(figure, f"{drive.name}: over the load")
    note(figure, f"Component model, full engine; rated torque {drive.output_torque_nm:g} N m.")
    return figure


@styled
def clearance_series_figure(
    drive: Drive,
    *,
    loads: Sequence[float] = (0.25, 1.0, 2.5),
    hole_clearances_mm: Sequence[float] = _CLEARANCES_MM,
) -> Figure:
    """Draw stiffness, lost motion, play and active pins over the clearance of the holes.

    Parameters
    ----------
    drive : Drive
        A drive with a component model.
    loads : sequence of float
        A line each: output torque over the rated one [1]; one to six. Play does not depend on it,
        and lost motion is meant at 3 % of that torque.
    hole_clearances_mm : sequence of float
        Clearances [mm].

    Returns
    -------
    matplotlib.figure.Figure
        Lines ``gid`` the column's name, one for each load in order.

    Raises
    ------
    DesignError
        When the drive cannot be built or has no component model.
    InputError
        For a number that is none, or too many lines.
    """
    rows = series_rows(drive, hole_clearances_mm, loads, tuple(OVER_CLEARANCE))
    lines = {f"{load:g}": rows.filter(pl.col("load") == load) for load in loads}
    figure = _panels(lines, OVER_CLEARANCE, "hole_clearance_mm", "clearance of the holes [mm]",
                     "load / rated")  # fmt: skip
    headline(figure, f"{drive.name}: over the clearance")
    note(figure, f"Component model, full engine; rated torque {drive.output_torque_nm:g} N m.")
    return figure


def series_rows(
    drive: Drive,
    hole_clearances_mm: Sequence[float],
    loads: Sequence[float],
    columns: Sequence[str],
) -> pl.DataFrame:
    """Results of a drive over clearance and load.

    Parameters
    ----------
    drive : Drive
        A drive with a component model.
    hole_clearances_mm : sequence of float
        Clearances [mm].
    loads : sequence of float
        Output torque over the rated one [1].
    columns : sequence of str
        Result columns, and ``play_arcmin``, see :func:`play_arcmin`.

    Returns
    -------
    polars.DataFrame
        ``hole_clearance_mm``, ``load`` and the columns, a row for each pair.

    Raises
    ------
    DesignError
        When the drive cannot be built or has no component model.
    InputError
        For a clearance below zero, a load that is not above it, or none at all.
    """
    for name, values, least in (("clearance", hole_clearances_mm, 0.0), ("load", loads, 1e-6)):
        if not values or not all(math.isfinite(value) and value >= least for value in values):
            raise InputError(f"{name}: found {list(values)}, expected numbers above zero")
    drive.accepted("full")
    pairs = [(clearance, load) for clearance in hole_clearances_mm for load in loads]
    variants = pl.DataFrame(
        {
            "hole_clearance_mm": [float(clearance) for clearance, _ in pairs],
            "output_torque_nm": [drive.output_torque_nm * load for _, load in pairs],
        }
    )
    found = sweep(Space.table(drive, variants), model="components", solver="full")
    found = found.with_columns(pl.Series("load", [float(load) for _, load in pairs]))
    if "play_arcmin" in columns:
        plays = [play_arcmin(drive, clearance) for clearance in hole_clearances_mm]
        each = pl.Series("play_arcmin", plays)
        found = found.with_columns(each.gather([k // len(loads) for k in range(len(pairs))]))
    return found.select("hole_clearance_mm", "load", *columns)


def play_arcmin(drive: Drive, hole_clearance_mm: float) -> float:
    """Play of a drive at its output with the crank locked at zero, from end to end.

    Parameters
    ----------
    drive : Drive
        A drive with a component model.
    hole_clearance_mm : float
        Clearance of its holes [mm].

    Returns
    -------
    float
        In arcmin.
    """
    of = drive.replace(hole_clearance_mm=float(hole_clearance_mm))
    below, above = of.torque_twist("output", to_load_tn=_SMALL_LOAD, points=2).free_play_deg
    return 60 * (above - below)


def _panels(
    lines: dict[str, pl.DataFrame], results: dict[str, str], over: str, label: str, what: str
) -> Figure:
    """Draw results as lines over a quantity."""
    if len(lines) > 6:
        raise InputError(f"{what}: found {len(lines)} lines, expected one to six")
    figure = new_figure(20.0 + 21.0 * len(results), TWO_COLUMNS_MM)
    panels = figure.subplots(len(results) // 2, 2, sharex=True)
    for panel, (column, axis) in zip(panels.flat, results.items(), strict=True):
        for k, (name, rows) in enumerate(lines.items()):
            if column == "play_arcmin" and k:
                continue  # it does not depend on the load
            panel.plot(
                rows[over], rows[column], color=COLOURS[k], linestyle=DASHES[k], label=name,
                gid=column,
            )  # fmt: skip
        panel.set_ylabel(axis)
        panel.set_ylim(bottom=0)
        panel.grid()
    for panel in panels[-1]:
        panel.set_xlabel(label)
    panels[0, 0].legend(title=what, title_fontsize=6.5)
    return figure
