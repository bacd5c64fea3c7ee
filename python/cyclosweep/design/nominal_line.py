"""The published model as a test engineer sees it: a dead zone and a straight line."""

from __future__ import annotations

from typing import Literal, NamedTuple

__all__ = ["NominalLine", "Side"]

Side = Literal["input", "output"]


class NominalLine(NamedTuple):
    """The published model as a test engineer sees it: a dead zone and a straight line.

    Attributes
    ----------
    free_play_deg : float
        Half width of the dead zone [deg] at the side asked for.
    compliance_deg_per_nm : float
        Slope beyond it [deg/(N m)], torque transfer efficiency included.
    """

    free_play_deg: float
    compliance_deg_per_nm: float

    def at(self, side: Side, ratio: int) -> NominalLine:
        """Return a line at the input as it is at one of the shafts.

        Parameters
        ----------
        side : {"input", "output"}
            Shaft at which torque and angle are meant.
        ratio : int
            Reduction ratio [1].

        Returns
        -------
        NominalLine
        """
        if side == "input":
            return self
        return NominalLine(self.free_play_deg / ratio, self.compliance_deg_per_nm / ratio**2)
