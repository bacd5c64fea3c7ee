"""Points of a disc's profile, the offset of a trochoid inwards by the ring pins' radius."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

__all__ = ["disc_profile", "unit_vectors"]

Reals = npt.NDArray[np.float64]

_SAMPLES = 1025
"""Points of a lobe at which its curvature is looked at before the points of the outline are set."""
_MARGIN = 0.7
"""Share of the chord error that is used: next to a sharp bend curvature changes along a chord."""


def disc_profile(
    lobes: int,
    *,
    ring_pin_circle_radius_mm: float,
    ring_pin_radius_mm: float,
    eccentricity_mm: float,
    chord_error_mm: float = 1e-3,
) -> Reals:
    """Closed outline of a disc in its own frame, without modification.

    Parameters
    ----------
    lobes : int
        Lobes N of the disc, which is the ratio; the ring has N + 1 pins.
    ring_pin_circle_radius_mm, ring_pin_radius_mm, eccentricity_mm : float
        Radius of the ring pins' circle, of a ring pin, and the eccentricity [mm].
    chord_error_mm : float
        Largest distance of the profile from the line between two neighbouring points [mm].

    Returns
    -------
    ndarray, shape (points, 2)
        Along and across the direction of ring pin 0 while the eccentricity points to that pin
        [mm], measured from the disc's centre; the last point is the first. The first one lies at
        the root that ring pin 0 fills.

    Notes
    -----
    Seen from the disc, a ring pin's centre runs along ``R u(s) - e u((N + 1) s)``, s from 0 to
    2 pi; every contact's normal passes through the pitch point, ``e (N + 1) u((N + 1) s)`` from
    the ring's centre. Whether ring pins undercut the profile is not asked here. A chord over a
    length L of curvature kappa is off by kappa L^2 / 8, so points lie at equal steps of the
    integral of sqrt(kappa): close together in the roots, which are hardly wider than the pins.

    Examples
    --------
    >>> outline = disc_profile(
    ...     11, ring_pin_circle_radius_mm=50, ring_pin_radius_mm=4, eccentricity_mm=1.5
    ... )
    >>> float(outline[0, 0])  # root: R - r - e
    44.5
    """
    pins = lobes + 1

    def outline(s: Reals) -> Reals:
        pin = ring_pin_circle_radius_mm * unit_vectors(s)
        to_pitch_point = eccentricity_mm * pins * unit_vectors(pins * s) - pin
        normal = to_pitch_point / np.linalg.norm(to_pitch_point, axis=1, keepdims=True)
        along: Reals = pin - eccentricity_mm * unit_vectors(pins * s) + ring_pin_radius_mm * normal
        return along

    lobe = np.linspace(0.0, math.tau / lobes, _SAMPLES)
    steps = np.diff(outline(lobe), axis=0)
    bends = np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0])))
    lengths = np.hypot(*steps.T)
    # Each bend belongs to the halves of the two steps that meet there; the ends are alike.
    weights = np.sqrt(np.abs(np.r_[bends[0], bends, bends[-1]]))
    weights = 0.5 * (weights[1:] + weights[:-1]) * np.sqrt(lengths)
    passed = np.r_[0.0, np.cumsum(weights)]
    pieces = max(4, math.ceil(passed[-1] / math.sqrt(8 * _MARGIN * chord_error_mm)))
    s = np.interp(np.linspace(0.0, passed[-1], pieces + 1), passed, lobe)[:-1]
    turns = np.arange(lobes) * math.tau / lobes
    around = outline((turns[:, None] + s).ravel())
    return np.vstack([around, around[:1]])


def unit_vectors(angle: Reals) -> Reals:
    """Vectors of length one in the direction of angles, shape (n,) [rad]; shape (n, 2)."""
    return np.column_stack([np.cos(angle), np.sin(angle)])
