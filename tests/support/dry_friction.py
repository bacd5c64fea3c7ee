"""Twist of a drive with play and dry friction that sticks without any give."""

import numpy as np
from numpy.typing import NDArray


def twist_with_friction(
    torque_nm: NDArray[np.float64], friction_nm: float, compliance_deg_per_nm: float
) -> NDArray[np.float64]:
    """Twist [deg] beyond a play of 28 deg each side, where friction takes up to so much torque."""
    carried = np.zeros(len(torque_nm))
    for row in range(1, len(torque_nm)):
        moved = carried[row - 1] + torque_nm[row] - torque_nm[row - 1]
        carried[row] = np.clip(moved, -friction_nm, friction_nm)
    elastic = torque_nm - carried
    return np.asarray(28.0 * np.sign(elastic) + compliance_deg_per_nm * elastic)


def friction_that_builds_up(torque: NDArray[np.float64], friction_nm: float) -> NDArray[np.float64]:
    """Torque that friction takes: four parallel contacts that slip one after another."""
    limits = friction_nm * np.array([0.5, 0.8, 1.2, 1.5])
    taken, carried = np.zeros(len(torque)), np.zeros(4)
    for row in range(1, len(torque)):
        carried = np.clip(carried + torque[row] - torque[row - 1], -limits, limits)
        taken[row] = carried.mean()
    return taken
