"""Drawings as SVG in millimetres, with the arcs of the DXF and a group for each layer."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path

from cyclosweep.atomic import write_text
from cyclosweep.cad.drawing import CENTRES, TITLE, Circle, Drawing, Outline

__all__ = ["save_svg", "svg_text"]

_COLOURS = {
    "HOUSING": "#666",
    "RING_PINS": "#1f5fbf",
    "OUTPUT_PINS": "#a0349c",
    "BUSHES": "#c77700",
}
_OF_DISCS = ("#000", "#00813e", "#0088a8", "#8a6d00")
_CENTRE = "#c00"
_ECCENTRIC = "#7a5cc0"

_STRAIGHT = 1e-9
"""Bulge below which an arc is a straight line to every digit that is written."""

_LETTER_WIDTH = 0.56
"""Mean width of a sans-serif letter over its height, to leave room for the title."""


def save_svg(drawn: Drawing, path: str | Path) -> None:
    """Write a drawing.

    Parameters
    ----------
    drawn : Drawing
        The drawing.
    path : str or Path
        File to write, whole or not at all.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    write_text(path, svg_text(drawn))


def svg_text(drawn: Drawing) -> str:
    """Return a drawing as the text of an SVG file, one user unit a millimetre."""
    radius = drawn.radius_mm
    edge, line = 1.12 * radius, 1.8 * drawn.letter_mm
    longest = max(len(text) for text in drawn.title)
    # Long lines of a title are set smaller rather than cut.
    letter = min(drawn.letter_mm, 2 * radius / (longest * _LETTER_WIDTH))
    height = 2 * edge + line * (len(drawn.title) + 0.5)
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * edge:.4f}mm" height="{height:.4f}mm" '
        f'viewBox="{-edge:.4f} {-edge:.4f} {2 * edge:.4f} {height:.4f}" role="img" '
        'style="background:#fff">\n'
        f"<title>{escape(drawn.name)}</title>\n<desc>{escape(' / '.join(drawn.title))}</desc>\n"
        f'<g transform="scale(1 -1)" fill="none" stroke-width="{radius / 320:.4g}">\n'
    ]
    for layer in drawn.layers[:-2]:
        parts.append(f'<g id="{layer}" stroke="{_colour(layer)}">\n')
        parts += [_shape(part) for part in drawn.parts if part.layer == layer]
        parts.append("</g>\n")
    dash = f"{radius / 40:.4g} {radius / 150:.4g} {radius / 200:.4g} {radius / 150:.4g}"
    parts.append(
        f'<g id="{CENTRES}" stroke="{_CENTRE}" stroke-width="{radius / 700:.4g}" '
        f'stroke-dasharray="{dash}">\n'
    )
    parts += [_shape(circle) for circle in drawn.pitch_circles]
    for x, y, to_x, to_y in drawn.centre_lines:
        parts.append(f'<path d="M{_number(x)} {_number(y)}L{_number(to_x)} {_number(to_y)}"/>\n')
    parts.append(
        f'</g>\n</g>\n<g id="{TITLE}" font-family="sans-serif" font-size="{letter:.4g}">\n'
    )
    for number, text in enumerate(drawn.title):
        below = edge + line * (number + 0.5)
        parts.append(f'<text x="{-radius:.4f}" y="{below:.4f}">{escape(text)}</text>\n')
    return "".join([*parts, "</g>\n</svg>\n"])


def _shape(part: Outline | Circle) -> str:
    if isinstance(part, Circle):
        at = f'cx="{_number(part.x_mm)}" cy="{_number(part.y_mm)}"'
        return f'<circle {at} r="{_number(part.radius_mm)}"/>\n'
    rows = [(float(x), float(y), float(bulge)) for x, y, bulge in part.vertices]
    words = [f"M{_number(rows[0][0])} {_number(rows[0][1])}"]
    for (x, y, bulge), (to_x, to_y, _) in zip(rows, rows[1:] + rows[:1], strict=True):
        end = f"{_number(to_x)} {_number(to_y)}"
        if abs(bulge) < _STRAIGHT:
            words.append(f"L{end}")
            continue
        radius = math.hypot(to_x - x, to_y - y) * (1 + bulge**2) / (4 * abs(bulge))
        words.append(f"A{radius:.9g} {radius:.9g} 0 {abs(bulge) > 1:d} {bulge > 0:d} {end}")
    return f'<path d="{"".join(words)}Z"/>\n'


def _number(value: float) -> str:
    """A length [mm] to a hundredth of the finest chord error."""
    return f"{value:.8f}".rstrip("0").rstrip(".")


def _colour(layer: str) -> str:
    part, _, number = layer.rpartition("_")
    if part == "DISC":
        return _OF_DISCS[int(number) - 1]
    return _ECCENTRIC if part == "ECCENTRIC" else _COLOURS[layer]
