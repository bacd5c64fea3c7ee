"""Forces and moments of a loaded cycloidal drive out of balance, written anew from the drawing.

Everything is in the house's fixed frame, in newtons and millimetres: positions of pins and holes,
their distances, forces along them, sums of forces and moments about each disc's own centre. It
shares no formula with the core, which works in each disc's frame with the energy's derivatives.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

Reals = npt.NDArray[np.float64]


def force_of_pin(depth: float, contact: float, pin: float) -> float:
    """Force [N] at which a contact (N/mm^(10/9)) and a pin (N/mm) close by ``depth`` [mm]."""
    if depth <= 0:
        return 0.0
    upper = min(contact * depth ** (10 / 9), pin * depth)

    def miss(force: float) -> float:
        return float(force / pin + (force / contact) ** 0.9 - depth)

    return float(brentq(miss, 0.0, upper, xtol=1e-15 * upper, rtol=1e-15))


def residual(unknowns: Reals, drive: dict[str, Any], torque: float, crank: float) -> Reals:
    """Forces [N] and moments over R_OP [N] out of balance.

    Parameters
    ----------
    unknowns : ndarray, shape (1 + 3 discs,)
        Rotation of the flange, then of each disc with its shift in house coordinates; rotations
        times R_OP [mm].
    drive : dict
        What the core says of the drive, in SI.
    torque : float
        Output torque [N mm].
    crank : float
        Angle of the crank [rad].
    """
    e, big_r = drive["eccentricity"] * 1e3, drive["ring_radius"] * 1e3
    r_op = drive["pin_circle_radius"] * 1e3
    lobes, discs, holes = drive["lobes"], drive["discs"], drive["output_pins"]
    to_mm = 1e-3 ** (10 / 9)
    ring_k, hole_k = drive["ring_stiffness"] * to_mm, drive["hole_stiffness"] * to_mm
    flange = unknowns[0] / r_op
    balance = [torque / r_op]
    for disc in range(discs):
        turn = unknowns[1 + 3 * disc] / r_op
        shift = unknowns[2 + 3 * disc : 4 + 3 * disc]
        at = crank + 2 * np.pi * disc / discs
        towards = np.array([np.cos(at), np.sin(at)])
        centre, pitch = e * towards, e * (lobes + 1) * towards
        force, moment = np.zeros(2), 0.0
        for pin in range(lobes + 1):
            angle = 2 * np.pi * pin / (lobes + 1)
            outward = np.array([np.cos(angle), np.sin(angle)])
            normal = pitch - big_r * outward
            normal /= np.hypot(*normal)
            arm = big_r * outward - centre  # any point of the line of force will do
            lever = arm[0] * normal[1] - arm[1] * normal[0]
            gap = drive["ring_gap"] * 1e3 - drive["ring_enlargement"] * 1e3 * (normal @ outward)
            gap += abs(drive["profile_rotation"] * lever)
            if drive["ring_gap_errors"]:
                gap += drive["ring_gap_errors"][pin] * 1e3
            depth = -(normal @ shift) - lever * turn - gap
            if depth > 0:
                push = ring_k * depth ** (10 / 9)
                force += push * normal
                moment += push * lever
        for hole in range(holes):
            # Where output pin and hole stand; both turn backwards as the crank goes on.
            angle = drive["hole_clocking"] + 2 * np.pi * hole / holes - crank / lobes
            pin_at = r_op * np.array([np.cos(angle), np.sin(angle)])
            # Small rotations move a point along its tangent, as the core has it, too.
            tangent = np.array([-np.sin(angle), np.cos(angle)])
            hole_at = pin_at + centre + shift + turn * r_op * tangent
            apart = hole_at - (pin_at + flange * r_op * tangent)
            distance = float(np.hypot(*apart))
            gap = drive["hole_gap"] * 1e3
            if drive["hole_gap_errors"]:
                gap += drive["hole_gap_errors"][hole] * 1e3
            push = force_of_pin(distance - e - gap, hole_k, drive["pin_stiffness"][disc] * 1e-3)
            along = apart / distance
            force -= push * along
            moment -= push * r_op * (along @ tangent)
            balance[0] += push * (along @ tangent)
        away = float(np.hypot(*shift))
        clearance = drive["bearing_clearance"] * 1e3
        if away > clearance:
            force -= drive["bearing_stiffness"] * 1e-3 * (away - clearance) * shift / away
        balance += [moment / r_op, force[0], force[1]]
    return np.array(balance)
