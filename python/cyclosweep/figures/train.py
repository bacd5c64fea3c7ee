"""Pictures of a train: mode shapes, Campbell diagram, transient, shock factor over the play."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from cyclosweep.dynamics.formulas import reversal_shock_factor
from cyclosweep.errors import InputError
from cyclosweep.figures.style import (
    BLUE,
    COLOURS,
    DASHES,
    FAINT,
    GREY,
    INK,
    SEQUENTIAL,
    SINGLE_COLUMN_MM,
    TWO_COLUMNS_MM,
    VERMILION,
    new_figure,
    save,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cyclosweep.dynamics.modes import Modes
    from cyclosweep.dynamics.transient import Transient

__all__ = [
    "campbell_figure",
    "mode_shapes_figure",
    "save_transient",
    "shock_map_figure",
    "transient_figure",
]


@styled
def mode_shapes_figure(modes: Modes, most: int = 6) -> Figure:
    """Angle along the train, referred to the first shaft, one panel a mode.

    Parameters
    ----------
    modes : Modes
        The modes.
    most : int
        Modes drawn, the slowest first.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        Without matplotlib.
    """
    count = min(most, len(modes.frequencies_hz))
    names = list(modes.train.names)
    if modes.train.grounded:
        names.append("ground")
    figure = new_figure(20.0 + 26.0 * count, max(SINGLE_COLUMN_MM, 30.0 + 18.0 * len(names)))
    panels = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    for k, panel in enumerate(panels):
        referred = modes.shapes[k] * modes.train.node_ratios
        referred = referred / np.abs(referred).max()
        if modes.train.grounded:
            referred = np.r_[referred, 0.0]
        panel.axhline(0.0, color=FAINT, linewidth=0.8)
        panel.plot(range(len(names)), referred, marker="o", color=BLUE)
        panel.set_ylim(-1.15, 1.15)
        panel.set_title(f"mode {k + 1}: {modes.frequencies_hz[k]:.4g} Hz")
    panels[-1].set_xticks(range(len(names)), names)
    figure.supylabel("angle referred to the first shaft, largest = 1")
    return figure


@styled
def campbell_figure(modes: Modes, orders: pl.DataFrame, largest_speed_rpm: float) -> Figure:
    """Frequencies of modes and of what excites them over the input speed.

    Parameters
    ----------
    modes : Modes
        Natural frequencies.
    orders : polars.DataFrame
        ``source``, ``order`` and ``adds_up``, as
        :func:`cyclosweep.design.excitation.excitation_orders` gives them.
    largest_speed_rpm : float
        End of the axis [rpm].

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        Without matplotlib.
    """
    figure = new_figure(105.0, TWO_COLUMNS_MM)
    panel = figure.subplots()
    speeds = np.geomspace(largest_speed_rpm / 1000, largest_speed_rpm, 200)
    moving = [float(f) for f in modes.frequencies_hz if f > 0]
    for frequency in moving:
        panel.axhline(frequency, color=INK, linewidth=1.0)
        panel.annotate(
            f"{frequency:.4g} Hz", (speeds[0], frequency), xytext=(3, 3),
            textcoords="offset points", fontsize=6.5,
        )  # fmt: skip
    for k, (source, order, adds_up) in enumerate(
        orders.select("source", "order", "adds_up").iter_rows()
    ):
        style = "-" if adds_up else ":"
        label = f"{source}, order {order:.5g}{'' if adds_up else ' (discs cancel)'}"
        panel.plot(speeds, order * speeds / 60, style, color=COLOURS[k % len(COLOURS)], label=label)
        at = [60 * f / order for f in moving if speeds[0] <= 60 * f / order <= largest_speed_rpm]
        if adds_up and at:
            panel.plot(at, [order * s / 60 for s in at], "o", color=COLOURS[k % len(COLOURS)])
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlim(speeds[0], largest_speed_rpm)
    panel.set_xlabel("input speed [rpm]")
    panel.set_ylabel("frequency [Hz]")
    panel.legend(fontsize=6.5, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


@styled
def transient_figure(run: Transient) -> Figure:
    """Torques of all springs over time, with every impact marked, and the energies.

    Parameters
    ----------
    run : Transient
        A transient.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        Without matplotlib.
    """
    names = list(run.peak_torques_nm)
    figure = new_figure(20.0 + 34.0 * (len(names) + 1), TWO_COLUMNS_MM)
    panels = figure.subplots(len(names) + 1, 1, sharex=True)
    time = run.table["time_s"].to_numpy()
    for name, panel in zip(names, panels[:-1], strict=True):
        panel.plot(
            time,
            run.table[f"torque_{name}_nm"].to_numpy(),
            color=BLUE,
            linewidth=1.0,
        )
        at = run.impacts.filter(pl.col("spring") == name)["time_s"].to_numpy()
        if len(at):
            panel.plot(
                at, np.zeros(len(at)), "k^", markersize=4,
                label=f"{len(at)} impact{'s' if len(at) > 1 else ''}",
            )  # fmt: skip
        peak = run.peak_torques_nm[name]
        panel.plot(run.peak_times_s[name], peak, "o", color=VERMILION, label=f"peak {peak:.4g} N m")
        static = run.static_torques_nm[name]
        if static:
            panel.axhline(static, color=GREY, linestyle="--", label=f"static {static:.4g} N m")
        panel.set_ylabel(f"{name}\n[N m]")
        panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=6.5)
    energies = (
        ("kinetic", "kinetic_energy_j"),
        ("elastic", "elastic_energy_j"),
        ("taken by friction", "friction_loss_j"),
    )
    for (label, column), dash in zip(energies, DASHES, strict=False):
        panels[-1].plot(time, run.table[column].to_numpy(), dash, label=label, linewidth=1.0)
    panels[-1].set_ylabel("energy [J]")
    panels[-1].set_xlabel("time [s]")
    panels[-1].legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=6.5)
    return figure


@styled
def shock_map_figure(
    torque_nm: float,
    stiffnesses_nm_per_rad: tuple[float, float],
    gaps_deg: tuple[float, float],
    mark: tuple[float, float] | None = None,
) -> Figure:
    """Shock factor of a reversal over play and stiffness.

    Parameters
    ----------
    torque_nm : float
        Torque that is reversed [N m].
    stiffnesses_nm_per_rad : tuple of float
        Least and greatest stiffness [N m/rad].
    gaps_deg : tuple of float
        Least and greatest half play [deg].
    mark : tuple of float, optional
        Stiffness and half play of a drive to be marked.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InputError
        Without matplotlib.
    """
    figure = new_figure(80.0)
    panel = figure.subplots()
    gaps = np.linspace(*gaps_deg, 81)
    stiffnesses = np.geomspace(*stiffnesses_nm_per_rad, 81)
    factors = [
        [
            reversal_shock_factor(torque_nm, stiffness_nm_per_rad=k, gap_rad=math.radians(g))
            for k in stiffnesses
        ]
        for g in gaps
    ]
    filled = panel.contourf(stiffnesses, gaps, factors, levels=16, cmap=SEQUENTIAL)
    lines = panel.contour(stiffnesses, gaps, factors, levels=8, colors="white", linewidths=0.6)
    panel.clabel(lines, fontsize=6.5)
    figure.colorbar(filled, ax=panel, label="shock factor of a reversal")
    if mark is not None:
        panel.plot(*mark, "o", color=VERMILION, markersize=8)
    panel.set_xscale("log")
    panel.set_xlabel("stiffness at the input [N m/rad]")
    panel.set_ylabel("half of the play at the input [deg]")
    panel.set_title(f"{torque_nm:.4g} N m reversed")
    return figure


def save_transient(run: Transient, path: Path) -> bool:
    """Save the picture of a transient where matplotlib is installed.

    Parameters
    ----------
    run : Transient
        A transient.
    path : Path
        PNG file.

    Returns
    -------
    bool
        Whether it was saved.
    """
    try:
        figure = transient_figure(run)
    except InputError:
        return False
    save(figure, path, dpi=150)
    return True
