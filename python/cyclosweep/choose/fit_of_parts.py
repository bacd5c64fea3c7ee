"""What of a drive's parts does not fit together, and no result depends on."""

from __future__ import annotations

from collections.abc import Iterator

from cyclosweep.design.disc_stack import overlaps
from cyclosweep.design.drive import Drive

__all__ = ["misfits"]

SAME_RADIUS = 0.01
"""Difference of two radii of one thing, over the radius, from which they are not the same."""


def misfits(drive: Drive) -> Iterator[str]:
    """Say what of a drive's discs, pins and flange does not fit together.

    Parameters
    ----------
    drive : Drive
        A drive; of one without ring pins or reaches of the discs nothing is said.

    Yields
    ------
    str
        A sentence with the numbers.
    """
    yield from _rim(drive)
    yield from _along_the_axis(drive)


def _rim(drive: Drive) -> Iterator[str]:
    """A root radius beyond the one that the profile has."""
    if drive.ring_pin_radius_mm is None:
        return
    root = drive.ring_pin_circle_radius_mm - drive.ring_pin_radius_mm - drive.eccentricity_mm
    if drive.disc_outer_radius_mm > (1.0 + SAME_RADIUS) * root:
        yield (
            f"disc_outer_radius_mm is {drive.disc_outer_radius_mm:g}, and the roots of the profile "
            f"lie at {root:.4g}: hole_web_mm may count material that is not there"
        )


def _along_the_axis(drive: Drive) -> Iterator[str]:
    """Discs that stand in one another, in the flange, or beyond the ends of the pins."""
    width = drive.disc_width_mm
    reaches = [getattr(drive, f"disc_{k}_reach_mm") for k in range(1, drive.disc_count + 1)]
    if width is None or any(reach is None for reach in reaches):
        return
    for first, second, apart in overlaps(reaches, width):
        yield (
            f"discs {first} and {second}, {width:g} mm wide, stand in one another: their middles "
            f"are {apart:.4g} mm apart"
        )
    if min(reaches) < 0.5 * width:
        yield f"a disc stands in the flange: its middle is {min(reaches):g} mm from it"
    if max(reaches) + 0.5 * width > drive.output_pin_length_mm:
        yield (
            f"output pins of {drive.output_pin_length_mm:g} mm end before the last disc does, at "
            f"{max(reaches) + 0.5 * width:.4g} mm"
        )
