"""Twist of the elastic parts over their torque, point by point."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.simulation.effects.corners import Floats


@dataclass(frozen=True, slots=True)
class ElasticLaw:
    """Twist beyond the dead zone over the elastic torque, point by point.

    Attributes
    ----------
    torque_nm : ndarray, shape (n,)
        Elastic torque, rising [N m].
    twist_deg : ndarray, shape (n,)
        Twist at that torque [deg].
    line_deg_per_nm : float
        Compliance of the straight line from which the law was bent [deg/(N m)].
    """

    torque_nm: Floats
    twist_deg: Floats
    line_deg_per_nm: float

    def twist_at(self, torque_nm: Floats) -> Floats:
        """Twist at elastic torques [deg], shape as ``torque_nm`` [N m]."""
        return np.interp(torque_nm, self.torque_nm, self.twist_deg)

    def line_equivalent_nm(self, torque_nm: Floats) -> Floats:
        """Torques that twist the straight line as far as these do the law [N m].

        Parameters
        ----------
        torque_nm : ndarray
            Elastic torques [N m].

        Returns
        -------
        ndarray
            In the same shape; the torques themselves where the line does not yield.
        """
        if self.line_deg_per_nm <= 0.0:
            return torque_nm
        return self.twist_at(torque_nm) / self.line_deg_per_nm
