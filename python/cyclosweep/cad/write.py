"""Write a disc or a drive to a file that a shop or a CAD program reads."""

from __future__ import annotations

from pathlib import Path

from cyclosweep.atomic import unfinished
from cyclosweep.cad.disc import LEAST_WALL_MM, checked_disc
from cyclosweep.cad.drawing import drawing
from cyclosweep.cad.dxf import save_dxf
from cyclosweep.cad.fitting import checked_chord_error
from cyclosweep.cad.step import save_step
from cyclosweep.cad.svg import save_svg
from cyclosweep.design.drive import Drive

__all__ = ["write_dxf", "write_points", "write_step", "write_svg"]


def write_dxf(
    drive: Drive,
    path: str | Path,
    *,
    disc: int | None = None,
    chord_error_mm: float = 1e-3,
    modification: bool = True,
    min_wall_mm: float = LEAST_WALL_MM,
    housing_bore_radius_mm: float | None = None,
) -> dict[str, str | float | int | bool | None]:
    """Write a drawing as DXF (R2000, millimetres).

    Each outline is one closed polyline of arcs on its part's layer: ``DISC_1``, ``DISC_2``,
    ``RING_PINS``, ``HOUSING``, ``OUTPUT_PINS``, ``BUSHES``, ``ECCENTRIC_1``; centre marks are on
    ``CENTRES``, the key numbers on ``TITLE``.

    Parameters
    ----------
    drive : Drive
        A drive with ``ring_pin_radius_mm`` and ``disc_width_mm``.
    path : str or Path
        File to write, whole or not at all.
    disc : int, optional
        A disc, from 1, about its own centre; without it the whole drive with the crank at zero.
    chord_error_mm : float
        Largest distance of the drawn outline from the profile [mm].
    modification : bool
        Whether profiles are cut back as the drive says, see :func:`disc_profile`.
    min_wall_mm : float
        Least material between holes, profile and bore [mm].
    housing_bore_radius_mm : float, optional
        Radius of the housing's bore [mm]; through the ring pins' centres where lobes allow it.

    Returns
    -------
    dict
        What was checked: the chord error found, smallest radii, least wall, area of a disc.

    Raises
    ------
    DesignError
        When the drive has no ring geometry or a part cannot be made, with the reason.
    InputError
        For an argument that is out of range, or without ezdxf.
    OSError
        When the file cannot be written.
    """
    drawn = drawing(
        drive,
        disc,
        chord_error_mm=chord_error_mm,
        modification=modification,
        min_wall_mm=min_wall_mm,
        housing_bore_radius_mm=housing_bore_radius_mm,
    )
    save_dxf(drawn, path)
    return drawn.facts


def write_svg(
    drive: Drive,
    path: str | Path,
    *,
    disc: int | None = None,
    chord_error_mm: float = 1e-3,
    modification: bool = True,
    min_wall_mm: float = LEAST_WALL_MM,
    housing_bore_radius_mm: float | None = None,
) -> dict[str, str | float | int | bool | None]:
    """Write a drawing as SVG in millimetres, with the arcs and layers of the DXF.

    Parameters
    ----------
    drive : Drive
        A drive with ``ring_pin_radius_mm`` and ``disc_width_mm``.
    path : str or Path
        File to write, whole or not at all.
    disc : int, optional
        A disc, from 1, about its own centre; without it the whole drive with the crank at zero.
    chord_error_mm : float
        Largest distance of the drawn outline from the profile [mm].
    modification : bool
        Whether profiles are cut back as the drive says, see :func:`disc_profile`.
    min_wall_mm : float
        Least material between holes, profile and bore [mm].
    housing_bore_radius_mm : float, optional
        Radius of the housing's bore [mm]; through the ring pins' centres where lobes allow it.

    Returns
    -------
    dict
        What was checked: the chord error found, smallest radii, least wall, area of a disc.

    Raises
    ------
    DesignError
        When the drive has no ring geometry or a part cannot be made, with the reason.
    InputError
        For an argument that is out of range.
    OSError
        When the file cannot be written.

    Examples
    --------
    >>> import cyclosweep as cs, pathlib, tempfile
    >>> drive = cs.Drive.reference_87().replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     facts = cs.cad.write_svg(drive, pathlib.Path(folder) / "disc.svg", disc=1)
    >>> facts["chord_error_found_mm"] <= 0.001
    True
    """
    drawn = drawing(
        drive,
        disc,
        chord_error_mm=chord_error_mm,
        modification=modification,
        min_wall_mm=min_wall_mm,
        housing_bore_radius_mm=housing_bore_radius_mm,
    )
    save_svg(drawn, path)
    return drawn.facts


def write_points(
    drive: Drive,
    path: str | Path,
    *,
    disc: int = 1,
    chord_error_mm: float = 1e-3,
    modification: bool = True,
    min_wall_mm: float = LEAST_WALL_MM,
) -> dict[str, str | float | int | bool | None]:
    """Write points of a disc's profile as CSV: the columns of :meth:`DiscProfile.points`.

    Parameters
    ----------
    drive : Drive
        A drive with ``ring_pin_radius_mm`` and ``disc_width_mm``.
    path : str or Path
        File to write, whole or not at all.
    disc : int
        Which disc, from 1, about its own centre.
    chord_error_mm : float
        Largest distance of the profile from the line between two neighbours [mm].
    modification : bool
        Whether the profile is cut back as the drive says, see :func:`disc_profile`.
    min_wall_mm : float
        Least material between holes, profile and bore [mm].

    Returns
    -------
    dict
        What was checked: points, smallest radii, least wall, area of the disc.

    Raises
    ------
    DesignError
        When the drive has no ring geometry or the disc cannot be made, with the reason.
    InputError
        For an argument that is out of range.
    OSError
        When the file cannot be written.
    """
    checked_chord_error(chord_error_mm)
    made = checked_disc(drive, disc, modification, min_wall_mm)
    points = made.profile.points(chord_error_mm)
    with unfinished(path) as temporary:
        points.write_csv(temporary)
    return {
        "drive": drive.name,
        "disc": disc,
        "modification": modification,
        "chord_error_mm": chord_error_mm,
        "points": points.height,
        "convex_radius_min_mm": made.profile.convex_radius_min_mm,
        "concave_radius_min_mm": made.profile.concave_radius_min_mm,
        "ring_pin_radius_mm": drive.ring_pin_radius_mm,
        "wall_min_mm": made.wall_mm,
        "disc_area_mm2": made.area_mm2,
    }


def write_step(
    drive: Drive,
    path: str | Path,
    *,
    disc: int | None = None,
    chord_error_mm: float = 1e-3,
    modification: bool = True,
    min_wall_mm: float = LEAST_WALL_MM,
) -> dict[str, str | float | int | bool | None]:
    """Write solids as STEP, a named body each: a disc, or discs, pins, bushes and eccentrics.

    The flanks are splines. Along the axis zero is the flange; discs stand at their reach, output
    pins begin at the flange, ring pins are as long as the discs together.

    Parameters
    ----------
    drive : Drive
        A drive with ``ring_pin_radius_mm`` and ``disc_width_mm``.
    path : str or Path
        File to write, whole or not at all.
    disc : int, optional
        A disc, from 1, about its own centre; without it the whole drive with the crank at zero.
    chord_error_mm : float
        Largest distance of the splines from the profile [mm].
    modification : bool
        Whether profiles are cut back as the drive says, see :func:`disc_profile`.
    min_wall_mm : float
        Least material between holes, profile and bore [mm].

    Returns
    -------
    dict
        What was checked, and the volume of a disc [mm^3].

    Raises
    ------
    DesignError
        When the drive has no ring geometry, a part cannot be made, or discs overlap.
    InputError
        For an argument that is out of range, or without build123d.
    OSError
        When the file cannot be written.
    """
    checked_chord_error(chord_error_mm)
    numbers = range(1, drive.disc_count + 1) if disc is None else [disc]
    discs = [checked_disc(drive, number, modification, min_wall_mm) for number in numbers]
    volumes = save_step(drive, discs, disc is None, chord_error_mm, path)
    first = discs[0]
    return {
        "drive": drive.name,
        "disc": disc,
        "modification": modification,
        "chord_error_mm": chord_error_mm,
        "solids": len(volumes),
        "convex_radius_min_mm": first.profile.convex_radius_min_mm,
        "concave_radius_min_mm": first.profile.concave_radius_min_mm,
        "ring_pin_radius_mm": drive.ring_pin_radius_mm,
        "wall_min_mm": min(each.wall_mm for each in discs),
        "disc_area_mm2": first.area_mm2,
        "disc_volume_mm3": volumes[f"disc {first.number}"],
    }
