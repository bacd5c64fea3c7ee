"""Drawings as DXF: one closed polyline of arcs for each outline, layers by part."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cyclosweep.atomic import unfinished
from cyclosweep.cad.drawing import CENTRES, TITLE, Drawing, Outline
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document

__all__ = ["save_dxf"]

_VERSION = "R2000"
"""Oldest version with closed polylines of arcs in one entity; every program of a shop reads it."""

_COLOURS = {"HOUSING": 8, "RING_PINS": 5, "OUTPUT_PINS": 6, "BUSHES": 30, CENTRES: 1, TITLE: 7}
"""Colours of AutoCAD's index; discs and eccentrics take the next ones."""

_OF_DISCS = (7, 3, 4, 2)
_ECCENTRIC = 140


def save_dxf(drawn: Drawing, path: str | Path) -> None:
    """Write a drawing.

    Parameters
    ----------
    drawn : Drawing
        The drawing.
    path : str or Path
        File to write, whole or not at all.

    Raises
    ------
    InputError
        Without ezdxf.
    OSError
        When the file cannot be written.
    """
    document = _document(drawn)
    with unfinished(path) as temporary:
        document.saveas(temporary)


def _document(drawn: Drawing) -> Document:
    try:
        from ezdxf import units
        from ezdxf.document import Drawing as New
        from ezdxf.enums import TextEntityAlignment
        from ezdxf.tools.standards import setup_linetypes
    except ImportError:
        raise InputError("DXF needs ezdxf: pip install 'cyclosweep[cad]'") from None
    document = New.new(_VERSION)
    document.units = units.MM
    setup_linetypes(document)
    document.header["$LTSCALE"] = max(drawn.radius_mm / 100, 0.1)
    for name in drawn.layers:
        line = "CENTER" if name == CENTRES else "CONTINUOUS"
        document.layers.add(name, color=_colour(name), linetype=line)
    space = document.modelspace()
    for part in drawn.parts:
        on = {"layer": part.layer}
        if isinstance(part, Outline):
            rows = part.vertices.tolist()
            space.add_lwpolyline(rows, format="xyb", close=True, dxfattribs=on)
        else:
            space.add_circle((part.x_mm, part.y_mm), part.radius_mm, dxfattribs=on)
    on = {"layer": CENTRES}
    for circle in drawn.pitch_circles:
        space.add_circle((circle.x_mm, circle.y_mm), circle.radius_mm, dxfattribs=on)
    for x, y, to_x, to_y in drawn.centre_lines:
        space.add_line((x, y), (to_x, to_y), dxfattribs=on)
    for number, line in enumerate(drawn.title):
        text = space.add_text(line, height=drawn.letter_mm, dxfattribs={"layer": TITLE})
        below = -drawn.radius_mm * 1.1 - 1.8 * number * drawn.letter_mm
        text.set_placement((-drawn.radius_mm, below), align=TextEntityAlignment.TOP_LEFT)
    return document


def _colour(layer: str) -> int:
    part, _, number = layer.rpartition("_")
    if part == "DISC":
        return _OF_DISCS[int(number) - 1]
    return _ECCENTRIC if part == "ECCENTRIC" else _COLOURS[layer]
