"""One disc of a drive, checked before it is drawn: its profile, holes, bore, walls and place."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cyclosweep.cad.profile import DiscProfile
from cyclosweep.design.drive import Drive
from cyclosweep.errors import DesignError, InputError

__all__ = ["LEAST_WALL_MM", "Disc", "checked_disc", "disc_profile"]

Reals = npt.NDArray[np.float64]

LEAST_WALL_MM = 1.0
"""Least material [mm] between holes, profile and bore where no other number is given: a convention
of this library, not a limit of strength, which the wall's load decides."""

_FLANK_SAMPLES = 65
"""Points of a flank in checks of walls and of crossing; their chords lie within 1e-3 pin radii."""


@dataclass(frozen=True)
class Disc:
    """A disc as it is made, about its own centre, and where it stands with the crank at zero.

    Attributes
    ----------
    number : int
        Which disc of the drive, from 1.
    profile : DiscProfile
        Its outline.
    holes_mm : ndarray, shape (output pins, 2)
        Centres of the holes [mm]; the first lies ``hole_clocking_deg`` from ring pin 0, as in the
        component model.
    hole_radius_mm, bore_radius_mm, width_mm : float
        Radii of holes and bore, width [mm]; a bore of zero is none.
    wall_mm : float
        Least material between holes, profile and bore [mm].
    centre_mm : tuple of float
        Place of the disc's centre in the drive [mm].
    middle_mm : float
        Distance of the disc's middle from the flange [mm].
    turned_holes : int or None
        Holes by which the first disc has to be turned to be this one; None when none will do and
        the disc is a part of its own.
    """

    number: int
    profile: DiscProfile
    holes_mm: Reals
    hole_radius_mm: float
    bore_radius_mm: float
    width_mm: float
    wall_mm: float
    centre_mm: tuple[float, float]
    middle_mm: float
    turned_holes: int | None

    @property
    def area_mm2(self) -> float:
        """Area of the disc's face, holes and bore taken off [mm^2]."""
        holes = len(self.holes_mm) * self.hole_radius_mm**2
        return self.profile.area_mm2 - math.pi * (holes + self.bore_radius_mm**2)


def disc_profile(
    drive: Drive,
    disc: int = 1,
    *,
    modification: bool = True,
    min_wall_mm: float = LEAST_WALL_MM,
) -> DiscProfile:
    """Profile of a disc, checked for undercut, crossing flanks and thin walls.

    Parameters
    ----------
    drive : Drive
        A drive with ``ring_pin_radius_mm`` and ``disc_width_mm``.
    disc : int
        Which disc, from 1; the second one's profile is turned against its holes by its phase.
    modification : bool
        Whether the profile is cut back as the drive says, so that the gaps at the ring pins are
        those of the component model: ``ring_clearance_mm`` and ``profile_offset_mm`` along the
        normal, ``profile_shift_mm`` by the wheel moved inwards, ``profile_rotation_deg`` by both
        flanks turned back. Without it the profile touches every ring pin.
    min_wall_mm : float
        Least material between holes, profile and bore [mm].

    Returns
    -------
    DiscProfile

    Raises
    ------
    DesignError
        When the drive has no ring geometry or the disc cannot be made, with the reason.
    InputError
        For a disc that the drive does not have, or a wall below zero.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> drive = cs.Drive.reference_87().replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
    >>> profile = cs.cad.disc_profile(drive)
    >>> round(profile.convex_radius_min_mm, 2), round(profile.concave_radius_min_mm, 2)
    (0.97, 2.09)
    """
    return checked_disc(drive, disc, modification, min_wall_mm).profile


def checked_disc(drive: Drive, disc: int, modification: bool, min_wall_mm: float) -> Disc:
    """Return a disc that can be made.

    Raises
    ------
    DesignError
        With the reason for which it cannot.
    InputError
        For a disc that the drive does not have, or a wall below zero.
    """
    if not 1 <= disc <= drive.disc_count:
        raise InputError(f"disc: found {disc}, expected 1 to {drive.disc_count} in {drive.name}")
    if not (min_wall_mm >= 0 and math.isfinite(min_wall_mm)):
        raise InputError(f"min_wall_mm: found {min_wall_mm:g}, expected a number not below zero")
    given = _numbers(drive)
    made = _built(drive, given, disc, modification)
    if made.wall_mm < min_wall_mm:
        between = _thinnest(made)
        what = "break through" if made.wall_mm <= 0 else "leave too little of"
        raise DesignError(
            f"{drive.name}: holes {what} the wall {between}: {made.wall_mm:.4g} mm of material, "
            f"expected at least {min_wall_mm:g} mm (min_wall_mm)"
        )
    return made


def _numbers(drive: Drive) -> dict[str, float]:
    """Every number of the component model, defaults put in, of a drive that can be built.

    Raises
    ------
    DesignError
        When the drive has no ring geometry or cannot be built.
    """
    needed = ("ring_pin_radius_mm", "disc_width_mm")
    missing = [name for name in needed if getattr(drive, name) is None]
    if missing:
        raise DesignError(
            f"{drive.name}: a drawing needs {' and '.join(missing)}, which the published model "
            "leaves open: add them to the drive file"
        )
    if (reason := drive.explain()) is not None:
        raise DesignError(f"{drive.name}: {reason}")
    table = drive.part_table()
    return dict(zip(table["key"], table["value"], strict=True))


def _built(drive: Drive, given: dict[str, float], disc: int, modification: bool) -> Disc:
    """Return a disc, its walls measured but not judged."""
    phase = 2 * math.pi * (disc - 1) / drive.disc_count
    nominal = DiscProfile(
        drive.ratio,
        drive.ring_pin_circle_radius_mm,
        given["ring_pin_radius_mm"],
        drive.eccentricity_mm,
        turned_rad=-phase / drive.ratio,
    )
    profile = nominal
    if modification:
        taken_off = given["ring_clearance_mm"] + given["profile_offset_mm"]
        profile = DiscProfile(
            nominal.lobes,
            nominal.ring_radius_mm - given["profile_shift_mm"],
            nominal.pin_radius_mm + taken_off,
            nominal.eccentricity_mm,
            math.radians(given["profile_rotation_deg"]),
            nominal.turned_rad,
        )
    _check_curvature(drive.name, profile, given["ring_pin_radius_mm"])
    # What is left: ring pins that overlap, holes that meet, lobes that pass the ring pins.
    drive.accepted("full")
    _check_crossing(drive.name, profile)
    count, circle = drive.output_pin_count, drive.output_pin_circle_radius_mm
    angles = math.radians(drive.hole_clocking_deg) + 2 * math.pi * np.arange(count) / count
    holes = circle * np.column_stack([np.cos(angles), np.sin(angles)])
    pin = 0.5 * drive.output_pin_diameter_mm + drive.bush_wall_mm
    hole = pin + drive.eccentricity_mm + given["hole_clearance_mm"]
    walls = _walls(profile, holes, hole, drive.disc_bore_radius_mm)
    return Disc(
        number=disc,
        profile=profile,
        holes_mm=holes,
        hole_radius_mm=hole,
        bore_radius_mm=drive.disc_bore_radius_mm,
        width_mm=given["disc_width_mm"],
        wall_mm=min(walls.values()),
        centre_mm=(
            drive.eccentricity_mm * math.cos(phase),
            drive.eccentricity_mm * math.sin(phase),
        ),
        middle_mm=given[f"disc_{disc}_reach_mm"],
        turned_holes=_turned_holes(drive, disc),
    )


def _check_curvature(name: str, profile: DiscProfile, ring_pin: float) -> None:
    """Refuse a profile that its cutting pin undercuts, or whose roots a ring pin does not enter."""
    if not (profile.ring_radius_mm > 0 and profile.short_width_coefficient < 1):
        raise DesignError(
            f"{name}: profile_shift_mm leaves K1 = e (N + 1) / R at "
            f"{profile.short_width_coefficient:.4g}, expected below 1"
        )
    bend, pin = profile.path_radius_min_mm, profile.pin_radius_mm
    if pin <= 0:
        raise DesignError(
            f"{name}: ring_clearance_mm and profile_offset_mm leave a cutting pin of "
            f"{pin:.4g} mm radius, expected above zero"
        )
    if profile.convex_radius_min_mm <= 0:
        raise DesignError(
            f"{name}: undercut: the ring pin's path bends at {bend:.4g} mm where lobes are convex, "
            f"the pin that cuts them has {pin:.4g} mm radius, expected less; smaller ring pins, a "
            "larger ring or a smaller eccentricity mend it"
        )
    if profile.concave_radius_min_mm < ring_pin:
        raise DesignError(
            f"{name}: roots of {profile.concave_radius_min_mm:.4g} mm radius are narrower than the "
            f"ring pins' {ring_pin:.4g} mm"
        )


def _check_crossing(name: str, profile: DiscProfile) -> None:
    """Refuse flanks that cross their neighbours, or that turning back has used up."""
    pitch = math.pi / profile.lobes
    if profile.rotation_rad >= pitch:
        raise DesignError(
            f"{name}: profile_rotation_deg is {math.degrees(profile.rotation_rad):.4g}, expected "
            f"below half a lobe's pitch, {math.degrees(pitch):.4g}"
        )
    first, last = profile.flank_range
    flank = profile.flank(np.linspace(first, last, _FLANK_SAMPLES)).position_mm
    angle = np.arctan2(flank[:, 1], flank[:, 0])
    rounding = 1e-9
    if last <= first or angle.min() < -rounding or angle.max() > pitch + rounding:
        raise DesignError(f"{name}: neighbouring flanks of the disc cross each other")


def _walls(profile: DiscProfile, holes: Reals, radius: float, bore: float) -> dict[str, float]:
    """Material [mm] between holes and profile, bore, and one another; below zero they meet."""
    first, last = profile.flank_range
    flank = profile.flank(np.linspace(first, last, _FLANK_SAMPLES)).position_mm
    outline = profile.copies(flank)
    to_profile = min(float(np.hypot(*(outline - hole).T).min()) for hole in holes)
    circle = float(np.hypot(*holes[0]))
    # A hole beyond the roots is outside the disc, however far its centre is from the profile.
    inside = circle < profile.root_radius_mm
    pitch = 2 * circle * math.sin(math.pi / len(holes))
    walls = {
        "between hole and profile": (to_profile if inside else -to_profile) - radius,
        "between neighbouring holes": pitch - 2 * radius,
    }
    return {**walls, "between hole and bore": circle - radius - bore} if bore > 0 else walls


def _thinnest(disc: Disc) -> str:
    """Where a disc is thinnest."""
    walls = _walls(disc.profile, disc.holes_mm, disc.hole_radius_mm, disc.bore_radius_mm)
    return min(walls, key=lambda name: walls[name])


def _turned_holes(drive: Drive, disc: int) -> int | None:
    """Hole pitches by which the first disc must be turned to be another one, the fewest."""
    # Turned by m holes the profile goes on by m N / Z pitches of its lobes, and has to arrive at
    # -k / n; all in whole parts of a pitch over Z n.
    holes, discs, lobes = drive.output_pin_count, drive.disc_count, drive.ratio
    behind = (disc - 1) * holes
    turns = (m for m in range(holes) if (m * lobes * discs + behind) % (holes * discs) == 0)
    return next(turns, None)
