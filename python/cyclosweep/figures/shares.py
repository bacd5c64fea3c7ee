"""Count of active pins and each pin's share of the load over a turn of the mesh zone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
import numpy.typing as npt

from cyclosweep.design.active_pins import CRITERIA
from cyclosweep.errors import DesignError, one_of
from cyclosweep.figures.active_map import turn_axis
from cyclosweep.figures.style import (
    BLUE,
    COLOURS,
    DASHES,
    FAINT,
    GREY,
    INK,
    above,
    new_figure,
    note,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cyclosweep.design.drive import Drive

__all__ = ["ACTIVE_SHARE", "pin_forces", "shares_figure"]

Reals = npt.NDArray[np.float64]
By = Literal["statics", "components"]

ACTIVE_SHARE = 0.01
"""Share of the largest force from which a pin counts as active, as in a sweep's columns."""

_STEP_DEG = 3.0
"""Step of the mesh zone between two equilibria [deg]."""

_MOST_LABELS = 16
"""Pins up to which each carries its number."""


@styled
def shares_figure(
    drive: Drive, *, by: By | None = None, output_torque_nm: float | None = None
) -> Figure:
    """Draw how many pins carry by each rule, and what share of disc 1's load each pin carries.

    Parameters
    ----------
    drive : Drive
        A drive that can be built.
    by : {"statics", "components"}, optional
        Where the shares come from: forces in proportion to the sine of a pin's position, or the
        component model's; by default the latter where the drive has one.
    output_torque_nm : float, optional
        Load of the component model [N m], rated by default.

    Returns
    -------
    matplotlib.figure.Figure
        Above: contacts of all discs by the three criteria and by the component model. Below: each
        pin's force over the sum of all forces of disc 1 (``gid`` ``share``), pin 0 thick.

    Raises
    ------
    DesignError
        When the drive cannot be built, or has no component model that is asked for.
    """
    if (reason := drive.explain()) is not None:
        raise DesignError(f"{drive.name}: {reason}")
    has_model = drive.ring_pin_radius_mm is not None and drive.disc_width_mm is not None
    chosen: By = by or ("components" if has_model else "statics")
    one_of("by", chosen, get_args(By))
    turn = np.arange(0.0, 360.0 + 0.5 * _STEP_DEG, _STEP_DEG)
    forces = pin_forces(drive, turn, chosen, output_torque_nm)
    figure = new_figure(108.0)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1.15))
    _draw_counts(top, drive)
    if chosen == "components":
        largest = forces.max(axis=(1, 2), keepdims=True)
        count = (forces > ACTIVE_SHARE * largest).sum(axis=(1, 2))
        top.plot(turn, count, color=INK, linewidth=1.0, marker=".", markersize=2,
                 label="component model", gid="counted")  # fmt: skip
    above(top, columns=2)
    _draw_shares(bottom, turn, forces[:, 0, :])
    top.set_title(f"{drive.name}: who carries the load", pad=25)
    torque = drive.output_torque_nm if output_torque_nm is None else output_torque_nm
    words = {
        "statics": "Shares by statics: force in proportion to the sine of the pin's position.",
        "components": f"Shares by the component model at {torque:.4g} N m, in the sense "
        "of its positive torque; active from 1 % of the largest force.",
    }[chosen]
    note(figure, words)
    return figure


def pin_forces(
    drive: Drive, turn_deg: Reals, by: By, output_torque_nm: float | None = None
) -> Reals:
    """Force of each disc on each output pin over the position of the mesh zone.

    Parameters
    ----------
    drive : Drive
        A drive that can be built.
    turn_deg : ndarray, shape (positions,)
        Positions of the mesh zone [deg].
    by : {"statics", "components"}
        Statics: the sine of a pin's position where that is above zero, in no unit. Components:
        forces [N].
    output_torque_nm : float, optional
        Load of the component model [N m], rated by default.

    Returns
    -------
    ndarray, shape (positions, discs, output pins)
        By statics in the order of :meth:`cyclosweep.Drive.hole_locus`, by components in that of
        the component model.
    """
    if by == "components":
        states = [drive.loaded(output_torque_nm, math.radians(at)) for at in turn_deg]
        return np.array([np.abs(state.output_pin_forces_n) for state in states])
    holes = (np.arange(drive.output_pin_count) + 0.5) * math.tau / drive.output_pin_count
    holes += math.radians(drive.hole_clocking_deg)
    leads = np.arange(drive.disc_count) * math.tau / drive.disc_count
    travel = np.radians(turn_deg) * (1 + 1 / drive.ratio)
    psi = travel[:, None, None] + leads[None, :, None] - holes[None, None, :]
    forces: Reals = np.maximum(np.sin(psi), 0.0)
    return forces


def _draw_counts(panel: Axes, drive: Drive) -> None:
    """Draw the number of active contacts by each criterion as steps."""
    most = 0
    for criterion, colour, dash in zip(CRITERIA, COLOURS, DASHES, strict=False):
        sectors = drive.active_pins(criterion).sectors
        edges = [*sectors["start_deg"], sectors["end_deg"][-1]]
        counts = sectors["active"].to_numpy()
        most = max(most, int(counts.max()))
        panel.step(
            edges, np.r_[counts, counts[-1]], where="post", color=colour, linestyle=dash,
            label=criterion, gid=criterion,
        )  # fmt: skip
    panel.set_ylim(0, 1.12 * most)
    panel.set_ylabel("active pins [1]")
    panel.grid(axis="x")


def _draw_shares(panel: Axes, turn: Reals, forces: Reals) -> None:
    """Draw each pin's share of a disc's load."""
    shares = 100 * forces / forces.sum(axis=1, keepdims=True)
    pins = shares.shape[1]
    for pin in range(pins):
        other = GREY if pins <= _MOST_LABELS else FAINT
        panel.plot(
            turn, shares[:, pin], gid="share", color=other if pin else BLUE,
            linewidth=0.8 if pin else 1.8, zorder=2 if pin else 3,
        )  # fmt: skip
        if pins <= _MOST_LABELS:
            peak = int(shares[:, pin].argmax())
            panel.annotate(
                f"{pin}", (turn[peak], shares[peak, pin]), xytext=(0, 2), ha="center",
                textcoords="offset points", va="bottom", fontsize=6.5,
                color=BLUE if pin == 0 else INK,
            )  # fmt: skip
    panel.set_ylim(0, 1.14 * float(shares.max()))
    panel.set_ylabel("share of disc 1's load [%]")
    panel.set_title("Share of each output pin, counted from 0", fontweight="normal")
    turn_axis(panel)
    panel.grid(axis="x")
