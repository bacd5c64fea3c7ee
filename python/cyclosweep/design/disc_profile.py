"""Points of a disc's profile, the offset of a trochoid inwards by the ring pins' radius."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

__all__ = ["disc_profile", "unit_vectors"]

Reals = npt.NDArray[np.float64]


def disc_profile(
    lobes: int,
    *,
    ring_pin_circle_radius_mm: float,
    ring_pin_radius_mm: float,
    eccentricity_mm: float,
    points_per_lobe: int = 48,
) -> Reals:
    """Closed outline of a disc in its own frame, without modification.

    Parameters
    ----------
    lobes : int
        Lobes N of the disc, which is the ratio; the ring has N + 1 pins.
    ring_pin_circle_radius_mm, ring_pin_radius_mm, eccentricity_mm : float
        Radius of the ring pins' circle, of a ring pin, and the eccentricity [mm].
    points_per_lobe : int
        Points on each lobe.

    Returns
    -------
    ndarray, shape (lobes * points_per_lobe + 1, 2)
        Along and across the direction of ring pin 0 while the eccentricity points to that pin
        [mm], measured from the disc's centre; the last point is the first. The first one lies at
        the root that ring pin 0 fills.

    Notes
    -----
    Seen from the disc, a ring pin's centre runs along ``R u(s) - e u((N + 1) s)``, s from 0 to
    2 pi; every contact's normal passes through the pitch point, ``e (N + 1) u((N + 1) s)`` from
    the ring's centre. Whether ring pins undercut the profile is not asked here.

    Examples
    --------
    >>> outline = disc_profile(
    ...     11, ring_pin_circle_radius_mm=50, ring_pin_radius_mm=4, eccentricity_mm=1.5
    ... )
    >>> float(outline[0, 0])  # root: R - r - e
    44.5
    """
    pins = lobes + 1
    s = np.linspace(0.0, math.tau, lobes * points_per_lobe + 1)
    pin = ring_pin_circle_radius_mm * unit_vectors(s)
    to_pitch_point = eccentricity_mm * pins * unit_vectors(pins * s) - pin
    normal = to_pitch_point / np.linalg.norm(to_pitch_point, axis=1, keepdims=True)
    outline = pin - eccentricity_mm * unit_vectors(pins * s) + ring_pin_radius_mm * normal
    closed: Reals = np.vstack([outline[:-1], outline[:1]])
    return closed


def unit_vectors(angle: Reals) -> Reals:
    """Vectors of length one in the direction of angles, shape (n,) [rad]; shape (n, 2)."""
    return np.column_stack([np.cos(angle), np.sin(angle)])
