"""Where the holes of a disc run, and which of them push a pin."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.active_pins import CRITERIA, ActivePins, Criterion, count_active_pins
from cyclosweep.design.hole_windows import hole_windows
from cyclosweep.design.numbers import finite_number, whole_number
from cyclosweep.design.parts import PartInputs
from cyclosweep.errors import InputError, one_of

__all__ = ["HolePaths"]


class HolePaths(PartInputs):
    """A drive with the paths of its holes."""

    def active_pins(self, criterion: Criterion | None = None) -> ActivePins:
        """Active hole-pin contacts over one turn of the mesh zone.

        Parameters
        ----------
        criterion : {"published-map", "inside", "statics"}, optional
            The rule; this drive's own by default.

        Returns
        -------
        ActivePins

        Raises
        ------
        InputError
            For another criterion.
        DesignError
            When no hole ever crosses the pins' pitch circle.

        Notes
        -----
        ``inside``: the hole's centre lies inside the pitch circle, ``cos(theta (1 + 1/i) - phi)
        < -e / (2 R_OP)``. ``statics``: the hole pushes its pin in the sense of the torque.
        ``published-map`` is *a reconstruction that matches the published map*, not the authors'
        rule: hole angles, positive with the mesh zone's travel, are reduced to (-180, 180] deg, and
        a hole at or below zero belongs to the left half. A left hole's window is
        ``[phi + 90 + delta, phi + 270 - delta] i / (i + 1)`` with
        ``delta = asin(e / (2 R_OP))``; its start is clipped at 0, its end at 180 deg except for the
        hole of that half nearest ring pin 0, which at a low ratio opens a second time
        before the turn ends. The right half follows the same rule on its own holes and is then
        mirrored. One disc's count is multiplied by the number of discs.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> cs.Drive.reference_87().active_pins().minimum
        4
        """
        chosen = self.criterion if criterion is None else criterion
        return count_active_pins(
            one_of("criterion", chosen, CRITERIA),
            ratio=self.ratio,
            disc_count=self.disc_count,
            output_pin_count=self.output_pin_count,
            half_sine=self._half_sine(),
            clocking_deg=self.hole_clocking_deg,
        )

    def hole_windows(self, criterion: Criterion | None = None) -> pl.DataFrame:
        """Stretches of the mesh zone's turn over which each hole counts as active.

        Parameters
        ----------
        criterion : {"published-map", "inside", "statics"}, optional
            The rule, see :meth:`active_pins`; this drive's own by default.

        Returns
        -------
        polars.DataFrame
            ``disc`` from 1; ``hole`` from 1, H1 the hole of the left half nearest ring pin 0, H2
            the next one away from it against the mesh zone's travel; ``index`` of that hole in
            :meth:`hole_locus`; ``half``, left or right; ``start_deg``, ``end_deg`` [deg]. A hole
            that is active in two stretches of the turn has two rows. By ``published-map`` every
            disc has the windows of the first.

        Raises
        ------
        InputError
            For another criterion.
        DesignError
            When no hole ever crosses the pins' pitch circle.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> windows = cs.Drive.reference_87().hole_windows()
        >>> round(windows.row(0, named=True)["start_deg"], 1)  # "almost 66 deg" in print
        65.9
        """
        chosen = self.criterion if criterion is None else criterion
        return hole_windows(
            one_of("criterion", chosen, CRITERIA),
            ratio=self.ratio,
            disc_count=self.disc_count,
            output_pin_count=self.output_pin_count,
            delta_deg=math.degrees(math.asin(self._half_sine())),
            clocking_deg=self.hole_clocking_deg,
        )

    def _half_sine(self) -> float:
        """Eccentricity over the diameter of the pins' circle [1]."""
        half_sine = self.eccentricity_mm / (2 * self.output_pin_circle_radius_mm)
        if half_sine >= 1:
            raise _core.DesignError(f"{self.name}: {self.study().explain(0)}")
        return half_sine

    def hole_locus(self, theta_deg: npt.ArrayLike, hole: int = 0) -> pl.DataFrame:
        """Path of a hole's centre, a hypotrochoid that crosses the pins' pitch circle.

        Parameters
        ----------
        theta_deg : array_like
            Positions of the mesh zone [deg], clockwise from ring pin 0.
        hole : int
            Which hole of disc 1, from 0.

        Returns
        -------
        polars.DataFrame
            ``theta_deg``, ``x_mm``, ``y_mm``, ``radius_mm``.

        Raises
        ------
        InputError
            For a position that is no finite number, or a hole that the disc does not have.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> cs.Drive.reference_87().hole_locus([0.0, 90.0]).height
        2
        """
        try:
            given = np.atleast_1d(theta_deg)
        except ValueError:
            raise InputError(
                f"theta_deg: found {theta_deg!r}, expected a list of numbers"
            ) from None
        theta = np.array([finite_number("theta_deg", each) for each in given])
        hole = whole_number("hole", hole, most=int(self.output_pin_count) - 1)
        angle = math.radians(self.hole_clocking_deg + (hole + 0.5) * 360 / self.output_pin_count)
        centres = _core.hole_locus(
            self.eccentricity_mm,
            self.output_pin_circle_radius_mm,
            self.ratio,
            angle,
            np.radians(theta),
        )
        return pl.DataFrame(
            {
                "theta_deg": theta,
                "x_mm": centres[:, 0],
                "y_mm": centres[:, 1],
                "radius_mm": np.hypot(centres[:, 0], centres[:, 1]),
            }
        )
