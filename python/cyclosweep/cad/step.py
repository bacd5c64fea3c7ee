"""Discs, pins and eccentrics as solids in a STEP file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from cyclosweep.atomic import unfinished
from cyclosweep.cad.disc import Disc
from cyclosweep.cad.drawing import eccentric_radius_mm
from cyclosweep.cad.fitting import splines_within
from cyclosweep.cad.profile import DiscProfile, turning
from cyclosweep.design.disc_stack import overlaps
from cyclosweep.design.drive import Drive
from cyclosweep.errors import DesignError, InputError

__all__ = ["save_step"]

Reals = npt.NDArray[np.float64]


def save_step(
    drive: Drive, discs: list[Disc], whole: bool, chord_error_mm: float, path: str | Path
) -> dict[str, float]:
    """Write the solids of discs, or of all parts that the drive's numbers describe.

    Parameters
    ----------
    drive : Drive
        The drive.
    discs : list of Disc
        Its checked discs.
    whole : bool
        Whether discs stand where they stand in the drive, with ring pins, output pins and
        eccentrics; otherwise a disc lies about its own centre.
    chord_error_mm : float
        Largest distance of the splines from the profile [mm].
    path : str or Path
        File to write, whole or not at all.

    Returns
    -------
    dict
        Volume [mm^3] of each solid by its name.

    Raises
    ------
    InputError
        Without build123d.
    DesignError
        When discs overlap along the axis.
    OSError
        When the file cannot be written.
    """
    try:
        import build123d as b3d
    except ImportError:
        raise InputError("STEP needs build123d: pip install 'cyclosweep[step]'") from None
    if whole:
        _check_overlap(drive.name, discs)
    flank = splines_within(discs[0].profile, chord_error_mm)
    solids = {}
    for disc in discs:
        x, y = disc.centre_mm if whole else (0.0, 0.0)
        low = disc.middle_mm - 0.5 * disc.width_mm if whole else 0.0
        solids[f"disc {disc.number}"] = b3d.Pos(x, y, low) * _disc(b3d, disc, flank)
    if whole:
        solids |= _pins(b3d, drive, discs)
    for name, solid in solids.items():
        solid.label = name
    shape = b3d.Compound(label=drive.name, children=list(solids.values()))
    with unfinished(path) as temporary:
        if not b3d.export_step(shape, temporary, unit=b3d.Unit.MM):
            raise OSError(f"{path}: the STEP file could not be written")
    return {name: float(solid.volume) for name, solid in solids.items()}


def _check_overlap(name: str, discs: list[Disc]) -> None:
    """Refuse discs that stand in one another along the axis."""
    width = discs[0].width_mm
    for first, second, apart in overlaps([disc.middle_mm for disc in discs], width):
        raise DesignError(
            f"{name}: discs {first} and {second} overlap: their middles are {apart:.6g} mm apart "
            f"(disc_{first}_reach_mm, disc_{second}_reach_mm), expected at least their width, "
            f"{width:.6g}"
        )


def _spline(b3d: Any, profile: DiscProfile, piece: tuple[Reals, Reals], turn: Reals) -> Any:
    """A piece of a flank with the profile's directions at its ends, turned or mirrored."""
    psi, length = piece
    points = profile.flank(psi)
    position, tangent = points.position_mm @ turn.T, points.tangent[[0, -1]] @ turn.T
    return b3d.Edge.make_spline(
        [b3d.Vector(x, y) for x, y in position],
        tangents=[b3d.Vector(x, y) for x, y in tangent],
        parameters=length.tolist(),
        scale=False,
    )


def _disc(b3d: Any, disc: Disc, flank: list[tuple[Reals, Reals]]) -> Any:
    """A disc about its own centre, its lower face at height zero."""
    profile = disc.profile
    axis = 2 * math.pi / profile.lobes
    edges = []
    for lobe in range(profile.lobes):
        for mirror in (1.0, -1.0):
            turn = turning(profile.turned_rad + axis * lobe) @ np.diag([1.0, mirror])
            edges += [_spline(b3d, profile, piece, turn) for piece in flank]
    holes = [
        b3d.Wire.make_circle(disc.hole_radius_mm, b3d.Plane((float(x), float(y), 0.0)))
        for x, y in disc.holes_mm
    ]
    if disc.bore_radius_mm > 0:
        holes.append(b3d.Wire.make_circle(disc.bore_radius_mm))
    face = b3d.Face(b3d.Wire.combine(edges)[0], holes)
    return b3d.Solid.extrude(face, b3d.Vector(0, 0, disc.width_mm))


def _pins(b3d: Any, drive: Drive, discs: list[Disc]) -> dict[str, Any]:
    """Ring pins, output pins with their bushes, and eccentrics with their bearings."""
    width = discs[0].width_mm
    ends = [disc.middle_mm - 0.5 * width for disc in discs]
    low, high = min(ends), max(ends) + width
    found = {}
    ring = drive.ring_pin_circle_radius_mm + (drive.ring_circle_enlargement_mm or 0.0)
    for number in range(drive.ratio + 1):
        angle = 2 * math.pi * number / (drive.ratio + 1)
        at = b3d.Pos(ring * math.cos(angle), ring * math.sin(angle), low)
        made = b3d.Solid.make_cylinder(drive.ring_pin_radius_mm, high - low)
        found[f"ring pin {number}"] = at * made
    pin, length = 0.5 * drive.output_pin_diameter_mm, drive.output_pin_length_mm
    for number, (x, y) in enumerate(discs[0].holes_mm):
        at = b3d.Pos(float(x), float(y), 0.0)
        made = b3d.Solid.make_cylinder(pin, length)
        if drive.output_pin_bore_mm > 0:
            made = made - b3d.Solid.make_cylinder(0.5 * drive.output_pin_bore_mm, length)
        found[f"output pin {number}"] = at * made
        if drive.bush_wall_mm > 0:
            bush = b3d.Solid.make_cylinder(pin + drive.bush_wall_mm, high - low)
            found[f"bush {number}"] = b3d.Pos(float(x), float(y), low) * (
                bush - b3d.Solid.make_cylinder(pin, high - low)
            )
    for disc in discs:
        if disc.bore_radius_mm > 0:
            at = b3d.Pos(*disc.centre_mm, disc.middle_mm - 0.5 * width)
            made = b3d.Solid.make_cylinder(eccentric_radius_mm(drive), width)
            found[f"eccentric {disc.number} with bearing"] = at * made
    return found
