"""How every picture looks: colours, type, widths; and how it is saved, the same bytes each time."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from cyclosweep.atomic import unfinished
from cyclosweep.errors import InputError, require_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "BLUE",
    "COLOURS",
    "DASHES",
    "FAINT",
    "FORMATS",
    "GREEN",
    "GREY",
    "INK",
    "ORANGE",
    "PINK",
    "SEQUENTIAL",
    "SINGLE_COLUMN_MM",
    "SKY",
    "TWO_COLUMNS_MM",
    "VERMILION",
    "above",
    "headline",
    "new_figure",
    "note",
    "save",
    "styled",
]

P = ParamSpec("P")
R = TypeVar("R")

SINGLE_COLUMN_MM = 89.0
"""Width of one column of a journal's page [mm]."""

TWO_COLUMNS_MM = 183.0
"""Width of both columns [mm]."""

INK = "#1d232b"
GREY = "#6b7480"
FAINT = "#cdd2d9"
BLUE = "#0072b2"
VERMILION = "#d55e00"
GREEN = "#009e73"
ORANGE = "#e69f00"
SKY = "#56b4e9"
PINK = "#cc79a7"

COLOURS = (BLUE, VERMILION, GREEN, PINK, ORANGE, SKY, INK)
"""Colours of Okabe and Ito, which colour-blind readers tell apart, in the order of use."""

DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 1)), (0, (8, 2)))
"""Dashes that go with them, so that lines stay apart in grey."""

SEQUENTIAL = "cividis"
"""Scale of magnitudes: even in lightness, and in grey."""

FORMATS = ("png", "svg", "pdf")
"""Kinds of file that a picture is saved as."""

_HOUSE: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 7.0,
    "axes.titlesize": 7.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 7.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": False,
    "axes.prop_cycle": f"cycler('color', {list(COLOURS)})",
    "grid.color": FAINT,
    "grid.linewidth": 0.5,
    "text.color": INK,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "lines.linewidth": 1.3,
    "lines.markersize": 4.0,
    "patch.linewidth": 0.6,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
    "hatch.linewidth": 0.5,
    "figure.facecolor": "white",
    "figure.labelsize": 7.0,
    "figure.titlesize": 7.5,
    "figure.titleweight": "bold",
    "savefig.facecolor": "white",
    "image.cmap": SEQUENTIAL,
    "svg.hashsalt": "cyclosweep",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
}
"""Settings of matplotlib within which every picture is drawn and saved."""


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Have a function draw within the house's settings, whatever the user's own are.

    Parameters
    ----------
    draw : callable
        A function that returns a figure.

    Returns
    -------
    callable
        The same; it raises InputError where matplotlib is missing. Titles and entries of legends
        that would end beyond the page are broken into lines.
    """

    @functools.wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> R:
        with _house():
            figure = draw(*args, **kwargs)
            _keep_on_page(figure)
            return figure

    return drawn


def _keep_on_page(figure: Any) -> None:
    """Break titles and entries of legends into lines where they end beyond the page."""
    width = figure.bbox.width
    titles = [title for panel in figure.axes for title in (panel.title, panel._left_title)]
    titles += [figure._suptitle] if figure._suptitle is not None else []
    legends = [legend for panel in figure.axes if (legend := panel.get_legend()) is not None]
    entries = [entry for legend in legends for entry in legend.get_texts()]
    texts = [(each, each.get_text()) for each in (*titles, *entries)]
    wide = [item for item in texts if item[0].get_window_extent().width > 0.3 * width]
    # Panels give way to a legend, down to nothing: what is far too wide is broken beforehand.
    for text, whole in wide:
        if text in entries:
            _break(text, whole, 0.6 * width)
    # Lines take height, and a panel that keeps its shape then stands elsewhere.
    for _ in range(_MOST_LAYOUTS if wide else 0):
        figure.draw_without_rendering()
        beyond = [item for item in wide if item[0].get_window_extent().x1 > width]
        if not beyond:
            return
        for text, whole in beyond:
            _break(text, whole, 0.97 * width - text.get_window_extent().x0)


_MOST_LAYOUTS = 4
"""Times that a picture is laid out anew to keep its texts on the page."""


def _break(text: Any, whole: str, room: float) -> None:
    """Break a text into lines no wider than the room [pixels] where there is a blank."""
    lines: list[str] = []
    for word in whole.split(" "):
        longer = f"{lines[-1]} {word}" if lines else word
        text.set_text(longer)
        if lines and text.get_window_extent().width > room:
            lines.append(word)
        else:
            lines[-1:] = [longer]
    text.set_text("\n".join(lines))


def _house() -> Any:
    require_matplotlib()
    from matplotlib import style

    return style.context(["default", _HOUSE])


def new_figure(height_mm: float, width_mm: float = SINGLE_COLUMN_MM) -> Figure:
    """Return an empty figure of a size in print.

    Parameters
    ----------
    height_mm, width_mm : float
        Size [mm].

    Returns
    -------
    matplotlib.figure.Figure
        Of which no window or registry knows.
    """
    from matplotlib.figure import Figure

    return Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained")


def note(figure: Figure, text: str) -> None:
    """Write what a reader must know below all panels.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The picture.
    text : str
        Sentences; broken into lines that fit the width.
    """
    import textwrap

    # Half of the type's size is about the mean width of a letter of DejaVu Sans.
    letters = int(figure.get_figwidth() * 72 / (0.545 * 6.0))
    lines = textwrap.wrap(text, letters)
    figure.supxlabel("\n".join(lines), x=0.012, ha="left", fontsize=6.0, color=GREY)


def headline(figure: Figure, text: str) -> None:
    """Write a picture's title above all panels.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The picture.
    text : str
        The title.
    """
    figure.suptitle(text, x=0.012, ha="left")


def above(panel: Axes, columns: int = 2, **options: Any) -> None:
    """Put a panel's legend above it, where it covers nothing.

    Parameters
    ----------
    panel : matplotlib.axes.Axes
        The panel.
    columns : int
        Entries beside each other.
    **options
        Of matplotlib's legend.
    """
    panel.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=columns,
        borderaxespad=0.2,
        borderpad=0.0,
        columnspacing=1.2,
        **options,
    )


def save(figure: Figure, path: str | Path, dpi: float = 300.0) -> None:
    """Save a picture as PNG, SVG or PDF, whole or not at all, the same bytes each time.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The picture.
    path : str or Path
        Its file; the ending says the format.
    dpi : float
        Dots of a PNG in an inch.

    Raises
    ------
    InputError
        For another ending.
    OSError
        When it cannot be written.
    """
    ending = Path(path).suffix.lower().removeprefix(".")
    if ending not in FORMATS:
        raise InputError(f"{path}: found {ending or 'no ending'}, expected .png, .svg or .pdf")
    # Files would carry the time and the version of the library otherwise.
    undated: dict[str, dict[str, Any]] = {
        "png": {"Software": None},
        "svg": {"Date": None, "Creator": None},
        "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    }
    with _house(), unfinished(path) as file:
        figure.savefig(file, format=ending, dpi=dpi, metadata=undated[ending])
