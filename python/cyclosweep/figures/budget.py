"""Which part of a drive gives how much of its compliance, several drives side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from cyclosweep.errors import InputError, one_of
from cyclosweep.figures.style import COLOURS, INK, above, headline, new_figure, note, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["MOST_DRIVES", "budget_figure"]

MOST_DRIVES = 6
"""Drives that stay legible side by side."""

_HATCHES = ("", "////", "....", "xxxx", "----", "oooo")
"""Fillings of the bars, so that drives stay apart in grey."""


@styled
def budget_figure(budget: pl.DataFrame, *, model: str | None = None) -> Figure:
    """Draw the compliance budget of one or more drives as bars.

    Parameters
    ----------
    budget : polars.DataFrame
        ``drive``, ``model``, ``part``, ``compliance_arcmin_per_nm``,
        ``stiffness_nm_per_arcmin``, ``share``: :attr:`cyclosweep.Comparison.budget`.
    model : {"components", "published"}, optional
        Whose budget; by default that of the component model where every drive has one.

    Returns
    -------
    matplotlib.figure.Figure
        A bar for each part and drive (``gid`` the drive's name): its compliance, with its percent
        of the whole and the stiffness of the drive if nothing but it yielded.

    Raises
    ------
    InputError
        Without a budget, or for more than six drives.
    """
    drives = budget["drive"].unique(maintain_order=True).to_list()
    if not 1 <= len(drives) <= MOST_DRIVES:
        raise InputError(f"budget: found {len(drives)} drives, expected 1 to {MOST_DRIVES}")
    if model is None:
        of_components = budget.filter(pl.col("model") == "components")["drive"].n_unique()
        model = "components" if of_components == len(drives) else "published"
    one_of("model", model, ("components", "published"))
    rows = budget.filter(pl.col("model") == model)
    if rows["drive"].n_unique() < len(drives):
        missing = next(name for name in drives if name not in rows["drive"])
        raise InputError(f"{missing}: has no compliance budget by the model {model}")
    parts = rows["part"].unique(maintain_order=True).to_list()
    height = 0.8 / len(drives)
    figure = new_figure(30.0 + len(parts) * (4.0 + 3.4 * len(drives)) + 3.0 * len(drives))
    panel = figure.subplots()
    most = float(rows["compliance_arcmin_per_nm"].max())  # type: ignore[arg-type]
    places = np.arange(len(parts), dtype=np.float64)
    for k, drive in enumerate(drives):
        own = {row["part"]: row for row in rows.filter(pl.col("drive") == drive).to_dicts()}
        widths = [
            1e3 * own[part]["compliance_arcmin_per_nm"] if part in own else 0 for part in parts
        ]
        total = 1 / sum(row["compliance_arcmin_per_nm"] for row in own.values())
        at = places - 0.4 + (k + 0.5) * height
        panel.barh(
            at, widths, height=0.88 * height, color=COLOURS[k], hatch=_HATCHES[k], gid=drive,
            edgecolor="white", label=f"{drive}: {total:.4g} N m/arcmin",
        )  # fmt: skip
        for place, width, part in zip(at, widths, parts, strict=True):
            if part in own:
                panel.annotate(
                    _words(own[part]), (max(width, 0.0), place), xytext=(3, 0), va="center",
                    textcoords="offset points", fontsize=6.0, color=INK,
                )  # fmt: skip
    panel.set_yticks(places, [_broken(part) for part in parts])
    panel.set_ylim(len(parts) - 0.5, -0.5)
    # A preloaded drive's clearances take off what its contacts count from their first touch.
    least = min(0.0, float(rows["compliance_arcmin_per_nm"].min()))  # type: ignore[arg-type]
    panel.set_xlim(1.1e3 * least, 1e3 * most * 1.9)
    panel.set_xlabel("compliance at the output [10$^{-3}$ arcmin/(N m)]")
    panel.tick_params(axis="y", length=0)
    panel.grid(axis="x")
    above(panel, columns=1)
    headline(figure, "Compliance budget")
    words = {
        "components": "Component model at rated torque, mean over the crank, from the unloaded "
        "middle; clearances taken up are part of it.",
        "published": "Published model, Eqs. (4)-(11), before the torque transfer efficiency.",
    }[model]
    note(figure, f"{words} In N m/arcmin: the drive if nothing but this part yielded.")
    return figure


def _words(item: dict[str, float | None]) -> str:
    """Percent and stiffness of a part."""
    share, stiffness = item["share"], item["stiffness_nm_per_arcmin"]
    percent = f"{100 * (share or 0.0):.1f} %"
    return f"{percent}, rigid" if not stiffness else f"{percent}, {_digits(stiffness)} N m/arcmin"


def _digits(value: float) -> str:
    """Three digits without a power of ten."""
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def _broken(part: str) -> str:
    """Name of a part on two lines where it is long."""
    import textwrap

    return "\n".join(textwrap.wrap(part, 18))
