"""A drawing of a disc or of the whole drive: outlines, circles, centre marks and its title."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

import cyclosweep._core as _core
from cyclosweep.cad.disc import LEAST_WALL_MM, Disc, checked_disc
from cyclosweep.cad.fitting import arcs_within, checked_chord_error
from cyclosweep.cad.profile import turning
from cyclosweep.design.drive import Drive
from cyclosweep.errors import DesignError, InputError

__all__ = ["CENTRES", "TITLE", "Circle", "Drawing", "Outline", "drawing"]

Reals = npt.NDArray[np.float64]

CENTRES, TITLE = "CENTRES", "TITLE"
"""Layers of centre marks and pitch circles, and of the title."""

_OVERHANG = 1.15
"""Length of a marked circle's centre lines over its diameter."""

_LETTER = 1 / 45
"""Height of the title's letters over the drawing's radius."""

_HELD = 0.1
"""Part of a ring pin's radius that must stay between lobes and a bore through the pins' centres."""


@dataclass(frozen=True)
class Outline:
    """A closed line of arcs.

    Attributes
    ----------
    layer : str
        Part that it belongs to.
    vertices : ndarray, shape (n, 3)
        x, y [mm] and the bulge of the arc that begins there, the tangent of a quarter of its
        angle, above zero counterclockwise.
    """

    layer: str
    vertices: Reals


@dataclass(frozen=True)
class Circle:
    """A circle on a layer; `marked` with a centre mark."""

    layer: str
    x_mm: float
    y_mm: float
    radius_mm: float
    marked: bool = False


@dataclass(frozen=True)
class Drawing:
    """What DXF and SVG show.

    Attributes
    ----------
    name : str
        The drive's name.
    title : tuple of str
        Lines of the title, the key numbers first.
    parts : tuple of Outline or Circle
        What is made, by layer.
    pitch_circles : tuple of Circle
        Circles on which pins and holes lie.
    radius_mm : float
        Radius about the origin that holds everything but the title [mm].
    facts : dict
        What was checked, for a summary.
    """

    name: str
    title: tuple[str, ...]
    parts: tuple[Outline | Circle, ...]
    pitch_circles: tuple[Circle, ...]
    radius_mm: float
    facts: dict[str, str | float | int | bool | None] = field(default_factory=dict)

    @property
    def layers(self) -> tuple[str, ...]:
        """Layers in the order in which they are drawn."""
        return (*dict.fromkeys(part.layer for part in self.parts), CENTRES, TITLE)

    @property
    def centre_lines(self) -> list[tuple[float, float, float, float]]:
        """Centre marks: x and y of their ends [mm]."""
        lines = []
        for part in self.parts:
            if isinstance(part, Circle) and part.marked:
                x, y, arm = part.x_mm, part.y_mm, part.radius_mm * _OVERHANG
                lines += [(x - arm, y, x + arm, y), (x, y - arm, x, y + arm)]
        return lines

    @property
    def letter_mm(self) -> float:
        """Height of the title's letters [mm]."""
        return self.radius_mm * _LETTER


def drawing(
    drive: Drive,
    disc: int | None = None,
    *,
    chord_error_mm: float = 1e-3,
    modification: bool = True,
    min_wall_mm: float = LEAST_WALL_MM,
    housing_bore_radius_mm: float | None = None,
) -> Drawing:
    """Lay out a disc about its own centre, or every part of the drive with the crank at zero.

    Parameters
    ----------
    drive : Drive
        A drive with ``ring_pin_radius_mm`` and ``disc_width_mm``.
    disc : int, optional
        A disc, from 1; without it the whole drive.
    chord_error_mm : float
        Largest distance of the drawn outline from the profile [mm].
    modification : bool
        Whether profiles are cut back as the drive says.
    min_wall_mm : float
        Least material between holes, profile and bore [mm].
    housing_bore_radius_mm : float, optional
        Radius of the housing's bore [mm]; through the ring pins' centres by default, and where
        lobes would reach that, half way between what they reach and the pins' outside.

    Returns
    -------
    Drawing

    Raises
    ------
    DesignError
        When the drive has no ring geometry or a part cannot be made, with the reason.
    InputError
        For an argument that is out of range.
    """
    checked_chord_error(chord_error_mm)
    numbers = range(1, drive.disc_count + 1) if disc is None else [disc]
    discs = [checked_disc(drive, number, modification, min_wall_mm) for number in numbers]
    arcs, found = arcs_within(discs[0].profile, chord_error_mm)
    parts: list[Outline | Circle] = []
    ring = drive.ring_pin_circle_radius_mm + (drive.ring_circle_enlargement_mm or 0.0)
    if disc is None:
        bore = _housing_bore(drive, ring, discs[0], housing_bore_radius_mm)
        parts += _ring(drive, ring, bore)
    for each in discs:
        at = each.centre_mm if disc is None else (0.0, 0.0)
        parts += _disc_parts(each, arcs, at)
    circles = [Circle(CENTRES, 0.0, 0.0, drive.output_pin_circle_radius_mm)]
    if disc is None:
        parts += _output_and_eccentrics(drive, discs)
        circles.append(Circle(CENTRES, 0.0, 0.0, ring))
    pin = discs[0].profile.pin_radius_mm
    radius = discs[0].profile.tip_radius_mm if disc is not None else ring + 1.5 * pin
    return Drawing(
        name=drive.name,
        title=_title(drive, discs, chord_error_mm, modification),
        parts=tuple(parts),
        pitch_circles=tuple(circles),
        radius_mm=radius,
        facts={
            "drive": drive.name,
            "disc": disc,
            "modification": modification,
            "chord_error_mm": chord_error_mm,
            "chord_error_found_mm": found,
            "arcs_of_a_disc": 2 * drive.ratio * (len(arcs) - 1),
            "convex_radius_min_mm": discs[0].profile.convex_radius_min_mm,
            "concave_radius_min_mm": discs[0].profile.concave_radius_min_mm,
            "ring_pin_radius_mm": drive.ring_pin_radius_mm,
            "wall_min_mm": min(each.wall_mm for each in discs),
            "disc_area_mm2": discs[0].area_mm2,
        },
    )


def _disc_parts(disc: Disc, arcs: Reals, at: tuple[float, float]) -> list[Outline | Circle]:
    """Outline, holes and bore of a disc."""
    layer = f"DISC_{disc.number}"
    points = disc.profile.copies(arcs[:, :2]) + at
    bulges = np.tile(np.concatenate([arcs[:-1, 2], arcs[-2::-1, 2]]), disc.profile.lobes)
    found: list[Outline | Circle] = [Outline(layer, np.column_stack([points, bulges]))]
    for x, y in disc.holes_mm + at:
        found.append(Circle(layer, float(x), float(y), disc.hole_radius_mm, marked=True))
    if disc.bore_radius_mm > 0:
        found.append(Circle(layer, *at, disc.bore_radius_mm, marked=True))
    return found


def _housing_bore(drive: Drive, ring: float, disc: Disc, given: float | None) -> float:
    """Radius of the housing's bore, which clears the lobes and holds the ring pins."""
    pin = drive.ring_pin_radius_mm or 0.0
    reach, outside = disc.profile.tip_radius_mm + drive.eccentricity_mm, ring + pin
    if given is not None:
        if not reach < given < outside:
            raise InputError(
                f"housing_bore_radius_mm: found {given:g}, expected above {reach:.4g}, which the "
                f"lobes reach, and below {outside:.4g}, the ring pins' outside"
            )
        return given
    if reach >= outside:
        raise DesignError(
            f"{drive.name}: no housing bore clears the lobes and holds the ring pins: lobes reach "
            f"{reach:.4g} mm, the pins' outside lies at {outside:.4g} mm"
        )
    return ring if ring - reach >= _HELD * pin else 0.5 * (reach + outside)


def _ring(drive: Drive, ring: float, bore: float) -> list[Outline | Circle]:
    """The housing's bore with the seats of the ring pins, and the pins."""
    count, pin = drive.ratio + 1, drive.ring_pin_radius_mm or 0.0
    pitch = 2 * math.pi / count
    # Half the angle of a seat's mouth, about the drive's axis and about the pin's.
    mouth = math.acos((bore**2 + ring**2 - pin**2) / (2 * bore * ring))
    about_pin = math.atan2(bore * math.sin(mouth), bore * math.cos(mouth) - ring)
    edge = bore * np.array(
        [[math.cos(mouth), -math.sin(mouth)], [math.cos(mouth), math.sin(mouth)]]
    )
    corners = np.concatenate([edge @ turning(pitch * k).T for k in range(count)])
    bulges = np.tile([math.tan(about_pin / 2), math.tan((pitch - 2 * mouth) / 4)], count)
    found: list[Outline | Circle] = [Outline("HOUSING", np.column_stack([corners, bulges]))]
    for number in range(count):
        x, y = ring * math.cos(pitch * number), ring * math.sin(pitch * number)
        found.append(Circle("RING_PINS", x, y, pin, marked=True))
    return found


def _output_and_eccentrics(drive: Drive, discs: list[Disc]) -> list[Outline | Circle]:
    """Output pins with bushes, and the eccentric in each disc's bore."""
    found: list[Outline | Circle] = []
    pin = 0.5 * drive.output_pin_diameter_mm
    for x, y in discs[0].holes_mm:
        at = float(x), float(y)
        found.append(Circle("OUTPUT_PINS", *at, pin, marked=True))
        if drive.output_pin_bore_mm > 0:
            found.append(Circle("OUTPUT_PINS", *at, 0.5 * drive.output_pin_bore_mm))
        if drive.bush_wall_mm > 0:
            found.append(Circle("BUSHES", *at, pin + drive.bush_wall_mm))
    for disc in discs:
        if disc.bore_radius_mm > 0:
            radius = eccentric_radius_mm(drive)
            found.append(Circle(f"ECCENTRIC_{disc.number}", *disc.centre_mm, radius, marked=True))
    return found


def eccentric_radius_mm(drive: Drive) -> float:
    """Radius of the eccentric with its bearing [mm]: the disc's bore less their clearance."""
    return drive.disc_bore_radius_mm - (drive.eccentric_bearing_clearance_mm or 0.0)


def _title(
    drive: Drive, discs: list[Disc], chord_error_mm: float, modification: bool
) -> tuple[str, ...]:
    """The title's lines: key numbers, profile, what the discs have in common, what is assumed."""
    first, pin = discs[0], drive.ring_pin_radius_mm or 0.0
    circle, holes = drive.output_pin_circle_radius_mm, len(first.holes_mm)
    bore = f"bore dia {2 * first.bore_radius_mm:.6g}, " if first.bore_radius_mm > 0 else ""
    disc = f"disc {first.number} of {drive.disc_count}, " if len(discs) < drive.disc_count else ""
    key = (
        f"{drive.name}: {disc}ratio {drive.ratio}, lobes {drive.ratio}, eccentricity "
        f"{drive.eccentricity_mm:.6g}, ring pins {drive.ratio + 1} x dia {2 * pin:.6g} on dia "
        f"{2 * drive.ring_pin_circle_radius_mm:.6g}, holes {holes} x dia "
        f"{2 * first.hole_radius_mm:.6g} on dia {2 * circle:.6g}, {bore}"
        f"width {first.width_mm:.6g}, mm"
    )
    made = "profile without modification"
    if modification:
        made = (
            f"profile modified: {first.profile.pin_radius_mm - pin:.6g} along the normal, radial "
            f"shift {drive.profile_shift_mm or 0.0:.6g}, rotation "
            f"{drive.profile_rotation_deg or 0.0:.6g} deg"
        )
    profile = (
        f"{made}; radii convex {first.profile.convex_radius_min_mm:.4g}, hollow "
        f"{first.profile.concave_radius_min_mm:.4g} or more; wall {first.wall_mm:.4g}; drawn "
        f"within {chord_error_mm:g}; cyclosweep {_core.__version__}"
    )
    lines = [key, profile, *(_phase(drive, each) for each in discs if each.number > 1)]
    marks = {row["key"]: row["mark"] for row in drive.part_table().iter_rows(named=True)}
    marks = {**drive.provenance, **{key: marks[key] for key in _DRAWN if key in marks}}
    assumed = [key for key in _DRAWN if marks.get(key, "").startswith("assumed")]
    if assumed:
        lines.append(f"assumed, not measured: {len(assumed)} of these numbers, see the drive file")
    return tuple(lines)


_DRAWN = (
    "eccentricity_mm", "ring_pin_circle_radius_mm", "ring_pin_radius_mm", "hole_clocking_deg",
    "output_pin_circle_radius_mm", "output_pin_diameter_mm", "bush_wall_mm", "disc_width_mm",
    "disc_bore_radius_mm", "ring_clearance_mm", "hole_clearance_mm", "profile_offset_mm",
    "profile_shift_mm", "profile_rotation_deg",
)  # fmt: skip
"""Inputs that a disc's drawing rests on."""


def _phase(drive: Drive, disc: Disc) -> str:
    """How another disc differs from the first."""
    turn = math.degrees(disc.profile.turned_rad)
    same = "a part of its own"
    if disc.turned_holes is not None:
        angle = 360 * disc.turned_holes / drive.output_pin_count
        same = f"the same part as disc 1 turned by {disc.turned_holes} holes, {angle:.6g} deg"
    return f"disc {disc.number}: profile turned by {turn:.6g} deg against its holes; {same}"
