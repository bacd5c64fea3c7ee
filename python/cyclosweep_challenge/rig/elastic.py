"""The elastic path from input to locked output: shaft, joint and pins in series."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.specimen import Specimen

Array = NDArray[np.float64]

NODES = 3000


class ElasticLaw:
    """Twist past the dead zone against transmitted torque, tabulated at one mesh position.

    The table runs over the pins' travel, in which their load is explicit; shaft and joint are
    added in series. Between nodes the law is linear, and beyond the last node it goes on with
    the last slope.

    Parameters
    ----------
    specimen : Specimen
        The drive.
    amplitudes : dict
        Amplitudes of the causes, by name.
    phase : float
        Factor on the pins' stiffness at this mesh position [-].
    largest_nm : float
        Torque the table has to reach [N m].
    """

    def __init__(
        self, specimen: Specimen, amplitudes: dict[str, float], phase: float, largest_nm: float
    ) -> None:
        take_up = amplitudes.get("clearance_takeup", 0.0)
        hertz = amplitudes.get("contact_stiffening", 0.0)
        opening = amplitudes.get("overload_softening", 0.0)
        total = specimen.compliance_deg_per_nm
        in_pins = total * specimen.pins.compliance_share
        in_shaft = total - in_pins
        self.linear = total if not (take_up or hertz or opening) and phase == 1.0 else None
        if self.linear is not None:
            reach = in_pins * largest_nm
            travel = np.array([0.0, reach])
        else:
            reach = self._reach(specimen, in_pins, take_up, hertz, phase, largest_nm)
            travel = reach * np.linspace(0.0, 1.0, NODES) ** 2
        self.torque_nm: Array = specimen.pins.torque_of_travel(
            travel, in_pins, take_up, hertz, phase
        )
        self.twist_deg: Array = (
            travel + in_shaft * self.torque_nm + specimen.joint.twist(self.torque_nm, opening)
        )

    @staticmethod
    def _reach(
        specimen: Specimen,
        in_pins: float,
        take_up: float,
        hertz: float,
        phase: float,
        largest_nm: float,
    ) -> float:
        """Travel of the pins at which they carry the largest torque [deg]."""
        reach = in_pins * largest_nm
        for _ in range(60):
            carried = specimen.pins.torque_of_travel(
                np.array([reach]), in_pins, take_up, hertz, phase
            )
            if carried[0] >= largest_nm:
                return reach
            reach *= 1.3
        raise ValueError("the pins never carry the largest torque: an amplitude is not physical")

    def twist(self, torque_nm: Array) -> Array:
        """Twist [deg] for transmitted torques not below zero [N m]."""
        if self.linear is not None:
            return self.linear * torque_nm
        return np.interp(torque_nm, self.torque_nm, self.twist_deg)
