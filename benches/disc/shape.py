"""One cycloidal disc in the plane: profile, holes, bore, and where pins and eccentric push it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cyclosweep import Drive

__all__ = ["Contacts", "Outline", "contacts", "outline"]

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Contacts:
    """Where a disc is touched, in a frame that stands still with the disc.

    Attributes
    ----------
    points : ndarray, shape (contacts, 2)
        Ring pins first, then output pins [mm].
    directions : ndarray, shape (contacts, 2)
        Unit vector of the force on the disc.
    along, across : ndarray, shape (2,)
        Direction of the eccentricity, and the one square to it.
    radii : ndarray, shape (contacts,)
        Radius of the disc's surface [mm], a hollow one below zero.
    """

    points: Reals
    directions: Reals
    along: Reals
    across: Reals
    radii: Reals


@dataclass(frozen=True)
class Outline:
    """Closed curves of a disc, each with a vertex at every contact.

    Attributes
    ----------
    profile : ndarray, shape (points, 2)
        The profile [mm].
    profile_sizes : ndarray, shape (points,)
        Wanted length of elements there [mm].
    holes : list of (ndarray, ndarray)
        The same for each hole.
    bore_radius : float
        Radius of the bore [mm].
    """

    profile: Reals
    profile_sizes: Reals
    holes: list[tuple[Reals, Reals]]
    bore_radius: float


def _unit(angle: Reals | float) -> Reals:
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _profile(drive: Drive, t: Reals) -> tuple[Reals, Reals]:
    """Points of the profile and normals into the disc, over the parameter t."""
    e, lobes = drive.eccentricity_mm, drive.ratio
    centres = drive.ring_pin_circle_radius_mm * _unit(t) - e * _unit((lobes + 1) * t)
    normals = e * lobes * _unit((lobes + 1) * t) - centres
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    assert drive.ring_pin_radius_mm is not None
    return centres + drive.ring_pin_radius_mm * normals, normals


def _hole_radius(drive: Drive) -> float:
    return drive.output_pin_diameter_mm / 2 + drive.bush_wall_mm + drive.eccentricity_mm


def contacts(drive: Drive, crank: float) -> Contacts:
    """Where the ring pins and the output pins push the first disc.

    Parameters
    ----------
    drive : Drive
        The drive.
    crank : float
        Angle of its crank [rad].
    """
    lobes, pins = drive.ratio, drive.output_pin_count
    t = 2 * math.pi * np.arange(lobes + 1) / (lobes + 1) + crank / lobes
    points, normals = _profile(drive, t)
    step = 1e-5
    nearby = [_profile(drive, t + d)[0] for d in (-step, 0.0, step)]
    first, second = (nearby[2] - nearby[0]) / (2 * step), (nearby[2] - 2 * nearby[1] + nearby[0])
    second = second / step**2
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    radii = np.linalg.norm(first, axis=1) ** 3 / cross
    along = _unit(crank * (1 + 1 / lobes))
    holes = math.radians(drive.hole_clocking_deg) + 2 * math.pi * np.arange(pins) / pins
    centres = drive.output_pin_circle_radius_mm * _unit(holes)
    radius = _hole_radius(drive)
    return Contacts(
        np.vstack([points, centres - radius * along]),
        np.vstack([normals, np.tile(-along, (pins, 1))]),
        along,
        np.array([-along[1], along[0]]),
        np.concatenate([radii, np.full(pins, -radius)]),
    )


def outline(drive: Drive, crank: float, patches: Reals, fine: float, coarse: float) -> Outline:
    """Curves of the disc with small elements where it is touched.

    Parameters
    ----------
    drive : Drive
        The drive.
    crank : float
        Angle of its crank [rad].
    patches : ndarray, shape (contacts,)
        Half widths of the loaded strips [mm].
    fine : float
        Elements to a half width.
    coarse : float
        Length of elements on the profile away from contacts [mm].
    """
    lobes, pins = drive.ratio, drive.output_pin_count
    t = 2 * math.pi * np.arange(lobes + 1) / (lobes + 1) + crank / lobes
    near = _profile(drive, t + 1e-6)[0] - _profile(drive, t - 1e-6)[0]
    speed = np.linalg.norm(near, axis=1) / 2e-6
    places, sizes = [], []
    for at, pace, half in zip(t, speed, patches[: lobes + 1], strict=True):
        offsets, lengths = _graded(half, fine, 0.4 * 2 * math.pi / (lobes + 1) * pace, coarse)
        places.append(at + offsets / pace)
        sizes.append(lengths)
    profile_t, order = np.unique(np.concatenate(places) % (2 * math.pi), return_index=True)
    lengths = np.concatenate(sizes)[order]
    holes = []
    radius = _hole_radius(drive)
    clocking = math.radians(drive.hole_clocking_deg)
    toward = crank * (1 + 1 / lobes) + math.pi
    for number, half in enumerate(patches[lobes + 1 :]):
        centre = drive.output_pin_circle_radius_mm * _unit(clocking + 2 * math.pi * number / pins)
        offsets, size = _graded(float(half), fine, math.pi * radius * 0.97, 4 * coarse)
        holes.append((centre + radius * _unit(toward + offsets / radius), size))
    return Outline(_profile(drive, profile_t)[0], lengths, holes, drive.disc_bore_radius_mm)


def _graded(half: float, fine: float, reach: float, coarse: float) -> tuple[Reals, Reals]:
    """Distances from a contact, close together on its strip and further apart beyond."""
    step = half / fine
    distances = list(np.arange(0, 2 * fine + 1) * step)
    while distances[-1] < reach:
        step = min(1.25 * step, coarse)
        distances.append(distances[-1] + step)
    kept = np.array(distances[:-1] if distances[-1] > reach else distances)
    offsets = np.concatenate([-kept[:0:-1], kept])
    lengths = np.abs(np.gradient(offsets))
    return offsets, lengths
