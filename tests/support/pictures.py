"""What a test asks of a picture: its marked artists, its lines, whether anything is cut."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

Reals = npt.NDArray[np.float64]


def artists(figure: Figure, gid: str) -> list[Artist]:
    """Everything drawn under a mark."""
    return [artist for artist in figure.findobj() if artist.get_gid() == gid]


def lines(figure: Figure, gid: str) -> list[Reals]:
    """Points of the lines under a mark, shape (points, 2) each."""
    from matplotlib.lines import Line2D

    found = [artist for artist in artists(figure, gid) if isinstance(artist, Line2D)]
    return [np.asarray(line.get_xydata(), dtype=np.float64) for line in found]


def cut(figure: Figure) -> list[str]:
    """Edges over which something of a picture sticks out [inch]."""
    figure.draw_without_rendering()
    box = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    sides = {"left": -box.x0, "bottom": -box.y0, "right": box.x1 - width, "top": box.y1 - height}
    return [f"{side} {over:.3f}" for side, over in sides.items() if over > 0.01]
