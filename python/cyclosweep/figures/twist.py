"""Twist of the input against load, free play included, beside the published line (Fig. 14)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.design.published_figures import (
    LINE_DEG,
    LINE_LOAD_TN,
    LINE_START_DEG,
    THEORY_ERROR,
    THEORY_LOAD_TN,
    is_paper_drive,
)
from cyclosweep.design.units import twist_column
from cyclosweep.errors import InputError
from cyclosweep.figures.style import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    VERMILION,
    new_figure,
    note,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cyclosweep.design.drive import Drive

__all__ = ["PAPER_LOADS_TN", "twist_figure"]

PAPER_LOADS_TN = (1.0, 2.0, 3.0, 4.0, 4.5)
"""Loads [T_N] of the paper's study."""


@styled
def twist_figure(
    drive: Drive,
    *,
    loads_tn: tuple[float, ...] = PAPER_LOADS_TN,
    components: bool | None = None,
) -> Figure:
    """Draw the twist at the input over the load, output locked, as the paper's Fig. 14 does.

    Parameters
    ----------
    drive : Drive
        A drive that can be built.
    loads_tn : tuple of float
        Loads above zero at which the published model is marked [T_N].
    components : bool, optional
        Whether the component model's curve is drawn; by default where the drive has one and a
        clearance. Its free play follows from clearances, that of the published model is given.

    Returns
    -------
    matplotlib.figure.Figure
        The published model's line from the end of the free play on, by the drive's own criterion
        and by statics; for the paper's drive the band that is printed for the loading line, and
        the 8.5 % within which its theory is said to lie at 4 T_N.

    Raises
    ------
    DesignError
        When the drive cannot be built.
    InputError
        For a load that is not above zero.
    """
    if not loads_tn or not all(math.isfinite(load) and load > 0 for load in loads_tn):
        raise InputError(f"loads_tn: found {list(loads_tn)}, expected loads above zero")
    line = drive.nominal_line("input")
    marks = drive.evaluate(loads_tn)
    twists = [marks[twist_column(load)] or math.nan for load in loads_tn]
    figure = new_figure(92.0)
    panel = figure.subplots()
    most = max(loads_tn)
    _draw_free_play(panel, drive, most)
    text = "Twist of the input from the middle of its free play, output locked."
    is_in_band = False
    if is_paper_drive(drive):
        _draw_published(panel, most)
        at = line.free_play_deg
        at += line.compliance_deg_per_nm * drive.nominal_torque_nm * LINE_LOAD_TN
        is_in_band = LINE_DEG[0] <= at <= LINE_DEG[1]
        text += " The paper prints no dimensions; those of this drive are assumed"
        text += ", chosen so that the line meets the band." if is_in_band else "."
    load = np.array([0.0, 1.04 * most])
    angle = line.free_play_deg + line.compliance_deg_per_nm * drive.nominal_torque_nm * load
    panel.plot(load, angle, color=BLUE, label=f"model, {drive.criterion}", gid="line")
    panel.plot(loads_tn, twists, "o", color=BLUE, markerfacecolor="white", gid="marks")
    if is_in_band and most >= THEORY_LOAD_TN:
        at = line.free_play_deg
        at += line.compliance_deg_per_nm * drive.nominal_torque_nm * THEORY_LOAD_TN
        panel.errorbar(
            THEORY_LOAD_TN, at, THEORY_ERROR * at, color=INK, linewidth=0.9, capsize=2.5,
            label="printed: 8.5 % from measurement",
        )  # fmt: skip
    if drive.criterion != "statics" and drive.disc_count <= 2 and drive.shaft:
        by_statics = drive.replace(criterion="statics").nominal_line("input")
        slope = by_statics.compliance_deg_per_nm * drive.nominal_torque_nm
        panel.plot(
            load, by_statics.free_play_deg + slope * load, color=VERMILION, linestyle="--",
            label="model, statics", gid="statics", linewidth=1.0,
        )  # fmt: skip
    if components if components is not None else _has_clearance(drive):
        _draw_components(panel, drive, most)
    panel.set_xlim(0, 1.04 * most)
    panel.set_ylim(0, 1.15 * panel.get_ylim()[1])
    panel.set_xlabel(f"load [$T_N$], $T_N$ = {drive.nominal_torque_nm:.4g} N m at the input")
    panel.set_ylabel("twist at the input [deg]")
    panel.grid()
    _output_scale(panel, drive)
    panel.set_title(f"{drive.name}: twist under load")
    panel.legend(loc="upper left", frameon=True, facecolor="white", edgecolor="none")
    note(figure, text)
    return figure


def _output_scale(panel: Axes, drive: Drive) -> None:
    """Add the same angle at the output on the right."""
    factor = 60.0 / drive.ratio

    def at_output(deg: npt.ArrayLike) -> npt.ArrayLike:
        return np.asarray(deg, dtype=np.float64) * factor

    def at_input(arcmin: npt.ArrayLike) -> npt.ArrayLike:
        return np.asarray(arcmin, dtype=np.float64) / factor

    right = panel.secondary_yaxis("right", functions=(at_output, at_input))
    right.set_ylabel(f"over the ratio, {drive.ratio}: at the output [arcmin]")
    panel.spines["right"].set_visible(True)


def _draw_free_play(panel: Axes, drive: Drive, most: float) -> None:
    """Shade the turn over which the drive carries nothing."""
    if drive.free_play_deg <= 0:
        return
    panel.axhspan(0, drive.free_play_deg, color=FAINT, alpha=0.45, linewidth=0)
    panel.text(
        0.99 * 1.04 * most, 0.5 * drive.free_play_deg,
        f"free play γ = {drive.free_play_deg:g}° each side", ha="right", va="center", fontsize=6.5,
    )  # fmt: skip


def _draw_published(panel: Axes, most: float) -> None:
    """Draw what the paper prints of the loading line, and how far its theory is said to be off."""
    start = LINE_START_DEG
    low, high = ((at - start) / LINE_LOAD_TN for at in LINE_DEG)
    load = np.array([0.0, LINE_LOAD_TN])
    panel.fill_between(
        load, start + low * load, start + high * load, color=ORANGE, alpha=0.45, linewidth=0,
        label="printed: 75–80° at 2.5 $T_N$", gid="published-band",
    )  # fmt: skip
    if most >= THEORY_LOAD_TN:
        beyond = np.array([LINE_LOAD_TN, THEORY_LOAD_TN])
        for slope, label in ((low, "printed line, drawn on"), (high, None)):
            panel.plot(
                beyond, start + slope * beyond, color=ORANGE, linewidth=0.8, linestyle=":",
                label=label,
            )  # fmt: skip


def _has_clearance(drive: Drive) -> bool:
    """Whether the component model of a drive has a free play of its own."""
    if drive.ring_pin_radius_mm is None or drive.disc_width_mm is None:
        return False
    return (drive.hole_clearance_mm or 0.0) + (drive.ring_clearance_mm or 0.0) > 0


def _draw_components(panel: Axes, drive: Drive, most: float) -> None:
    """Draw the component model's curve, in the sense in which both are above zero."""
    curve = drive.torque_twist("input", to_load_tn=most)
    table = curve.table.filter(pl.col("angle_deg") >= curve.free_play_deg[1], "converged")
    panel.plot(
        table["load_tn"], table["angle_deg"], color=GREEN, linestyle="-.",
        label="component model", gid="components",
    )  # fmt: skip
