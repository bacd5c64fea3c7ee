"""The outline of a cycloid disc as the ring pins cut it: points, normals, curvature, area."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import polars as pl
from scipy.optimize import brentq

from cyclosweep.cad.fitting import checked_chord_error, points_within
from cyclosweep.design.disc_profile import unit_vectors

__all__ = ["DiscProfile", "FlankPoints"]

Reals = npt.NDArray[np.float64]

_AREA_POINTS = 64
"""Points of Gauss's rule on a flank: 32 give the area to 1e-12 already, with K1 up to 0.95."""


@dataclass(frozen=True)
class FlankPoints:
    """Points of a profile with what a machine needs there.

    Attributes
    ----------
    position_mm : ndarray, shape (n, 2)
        The points [mm].
    tangent : ndarray, shape (n, 2)
        Unit vectors along the outline, counterclockwise.
    curvature_per_mm : ndarray, shape (n,)
        Curvature [1/mm], above zero where the lobe is convex.
    """

    position_mm: Reals
    tangent: Reals
    curvature_per_mm: Reals


@dataclass(frozen=True)
class DiscProfile:
    """Profile of a disc about its own centre, the ring pins' path offset inwards by their radius.

    With the angle ``psi`` of the ring pin seen from the disc its centre runs along
    ``R (cos psi, sin psi) - e (cos (N + 1) psi, sin (N + 1) psi)``; the profile lies a pin's
    radius inside. A flank goes from a root at ``psi = 0`` to a tip at ``psi = pi / N``; every other
    flank is a mirrored or turned copy.

    Attributes
    ----------
    lobes : int
        Lobes N, the drive's ratio.
    ring_radius_mm : float
        Radius R of the circle on which the cutting pin runs [mm]: the ring pins' circle less the
        radial shift.
    pin_radius_mm : float
        Radius of the cutting pin [mm]: a ring pin and what is taken off along the normal.
    eccentricity_mm : float
        Eccentricity e [mm].
    rotation_rad : float
        Angle by which both flanks are turned back towards their lobe's tip [rad]. The outline then
        has an edge at every tip and root.
    turned_rad : float
        Turn of the whole profile against the holes [rad]: the phase of the disc.
    """

    lobes: int
    ring_radius_mm: float
    pin_radius_mm: float
    eccentricity_mm: float
    rotation_rad: float = 0.0
    turned_rad: float = 0.0

    @property
    def short_width_coefficient(self) -> float:
        """K1 = e (N + 1) / R [1]."""
        return self.eccentricity_mm * (self.lobes + 1) / self.ring_radius_mm

    @property
    def path_radius_min_mm(self) -> float:
        """Smallest convex radius of curvature of the path of the cutting pin's centre [mm]."""
        k, z = self.short_width_coefficient, self.lobes + 1
        cosine = ((2 - z) + k * k * (2 * z - 1)) / (k * (1 + z))
        return 1 / float(self._path_curvature(np.array(min(max(cosine, -1.0), 1.0))))

    @property
    def convex_radius_min_mm(self) -> float:
        """Smallest convex radius of curvature [mm]; not above zero where pins undercut it."""
        return self.path_radius_min_mm - self.pin_radius_mm

    @property
    def concave_radius_min_mm(self) -> float:
        """Smallest hollow radius of curvature [mm], that of the roots; infinite without any."""
        curvature = float(self._path_curvature(np.array(1.0)))
        return self.pin_radius_mm - 1 / curvature if curvature < 0 else math.inf

    @property
    def root_radius_mm(self) -> float:
        """Radius of the roots from the disc's centre [mm]."""
        return float(np.hypot(*self.flank(np.array([self.flank_range[0]])).position_mm[0]))

    @property
    def tip_radius_mm(self) -> float:
        """Radius of the tips from the disc's centre [mm]."""
        return float(np.hypot(*self.flank(np.array([self.flank_range[1]])).position_mm[0]))

    @property
    def area_mm2(self) -> float:
        """Area inside the outline, holes and bore not taken off [mm^2], by a line integral."""
        nodes, weights = np.polynomial.legendre.leggauss(_AREA_POINTS)
        first, last = self.flank_range
        psi = 0.5 * (last - first) * nodes + 0.5 * (last + first)
        points = self.flank(psi)
        x, y = points.position_mm.T
        along, up = points.tangent.T
        path = self._path_curvature(np.cos(self.lobes * psi))
        speed = self._path_speed(psi) * (1 - self.pin_radius_mm * path)
        swept = 0.5 * (x * up - y * along) * speed
        return float(2 * self.lobes * 0.5 * (last - first) * (weights @ swept))

    @cached_property
    def flank_range(self) -> tuple[float, float]:
        """Angles psi of the first flank's root and tip [rad]."""
        end = math.pi / self.lobes
        if self.rotation_rad == 0:
            return 0.0, end

        def polar(psi: float) -> float:
            x, y = self._unturned(np.array([psi])).position_mm[0]
            return math.atan2(y, x) + self.rotation_rad

        first = brentq(polar, -end, 0.0, xtol=1e-15)
        return float(first), float(brentq(lambda psi: polar(psi) - end, 0.0, end, xtol=1e-15))

    def flank(self, psi: Reals) -> FlankPoints:
        """Points of the first flank, the root at the angle zero.

        Parameters
        ----------
        psi : ndarray, shape (n,)
            Angles of the cutting pin [rad], within :attr:`flank_range`.

        Returns
        -------
        FlankPoints
        """
        points = self._unturned(psi)
        turn = turning(self.rotation_rad)
        return FlankPoints(
            points.position_mm @ turn.T, points.tangent @ turn.T, points.curvature_per_mm
        )

    def copies(self, flank: Reals, *, vectors: bool = False) -> Reals:
        """Every flank of the outline in order, counterclockwise from the first root.

        Parameters
        ----------
        flank : ndarray, shape (n, 2)
            Points of the first flank from root to tip, or vectors there.
        vectors : bool
            Whether they are normals; a mirrored outline's normals are mirrored as they are.

        Returns
        -------
        ndarray, shape (2 N (n - 1), 2)
            The closed outline, no point twice; for `vectors` those at the same points.
        """
        axis = 2 * math.pi / self.lobes
        mirror = turning(axis) @ np.diag([1.0, -1.0])
        lobe = np.concatenate([flank[:-1], (flank @ mirror.T)[:0:-1]])
        if vectors:  # one normal at a tip stands for both flanks, the mean where they differ
            at_tip = flank[-1] + mirror @ flank[-1]
            lobe[len(flank) - 1] = at_tip / np.hypot(*at_tip)
            at_root = flank[0] + np.diag([1.0, -1.0]) @ flank[0]
            lobe[0] = at_root / np.hypot(*at_root)
        turns = [turning(self.turned_rad + axis * number) for number in range(self.lobes)]
        return np.concatenate([lobe @ turn.T for turn in turns])

    def points(self, chord_error_mm: float = 1e-3) -> pl.DataFrame:
        """Points of the whole outline, so close that straight lines between them will do.

        Parameters
        ----------
        chord_error_mm : float
            Largest distance of the profile from the line between two neighbours [mm].

        Returns
        -------
        polars.DataFrame
            ``x_mm`` and ``y_mm`` about the disc's centre, counterclockwise; the last point is
            joined to the first. ``curvature_radius_mm`` [mm], above zero where the lobe is convex
            and below zero where it is hollow; ``normal_x`` and ``normal_y``, unit vector outwards.

        Raises
        ------
        InputError
            For a chord error that is not between 1e-6 and 1 mm.

        Examples
        --------
        >>> profile = DiscProfile(9, 40.0, 4.0, 1.5)
        >>> profile.points(0.01).columns
        ['x_mm', 'y_mm', 'curvature_radius_mm', 'normal_x', 'normal_y']
        """
        psi = points_within(self, checked_chord_error(chord_error_mm))
        flank = self.flank(psi)
        outward = np.column_stack([flank.tangent[:, 1], -flank.tangent[:, 0]])
        with np.errstate(divide="ignore"):
            radius = 1 / flank.curvature_per_mm
        x, y = self.copies(flank.position_mm).T
        normal_x, normal_y = self.copies(outward, vectors=True).T
        return pl.DataFrame(
            {
                "x_mm": x,
                "y_mm": y,
                "curvature_radius_mm": np.tile(
                    np.concatenate([radius[:-1], radius[:0:-1]]), self.lobes
                ),
                "normal_x": normal_x,
                "normal_y": normal_y,
            }
        )

    def _path_curvature(self, cosine: Reals) -> Reals:
        """Curvature [1/mm] of the path of the cutting pin's centre."""
        k, z = self.short_width_coefficient, self.lobes + 1
        square = 1 + k * k - 2 * k * cosine
        bend: Reals = (1 + z * k * k - k * (1 + z) * cosine) / (self.ring_radius_mm * square**1.5)
        return bend

    def _path_speed(self, psi: Reals) -> Reals:
        """Length of the path over psi [mm/rad]."""
        k = self.short_width_coefficient
        speed: Reals = self.ring_radius_mm * np.sqrt(1 + k * k - 2 * k * np.cos(self.lobes * psi))
        return speed

    def _unturned(self, psi: Reals) -> FlankPoints:
        """The profile without the turn of its flanks."""
        many = self.lobes + 1
        pin, crank = unit_vectors(psi), unit_vectors(many * psi)
        path = self.ring_radius_mm * pin - self.eccentricity_mm * crank
        slope = self.ring_radius_mm * _across(pin) - self.eccentricity_mm * many * _across(crank)
        tangent = slope / self._path_speed(psi)[:, None]
        bend = self._path_curvature(np.cos(self.lobes * psi))
        position = path + self.pin_radius_mm * _across(tangent)
        return FlankPoints(position, tangent, bend / (1 - self.pin_radius_mm * bend))


def turning(angle: float) -> Reals:
    """Matrix that turns vectors by an angle [rad]."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def _across(vectors: Reals) -> Reals:
    """Vectors turned by 90 deg counterclockwise."""
    return np.column_stack([-vectors[:, 1], vectors[:, 0]])
