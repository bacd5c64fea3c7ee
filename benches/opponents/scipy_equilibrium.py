"""The component model's equilibria as people write them: a residual in NumPy, solved by SciPy.

Everything in the house's frame, N and mm; all contacts of a disc at once, warm started from the
last position of the crank.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import root

__all__ = ["twists"]

Reals = npt.NDArray[np.float64]
POSITIONS = 8
SHARES = (1.0, 0.5, 0.03)


def _pin_force(depth: Reals, hole: float, pin: float) -> Reals:
    """Force at which a hole's contact and a pin in series close by ``depth``: Newton's steps."""
    depth = np.maximum(depth, 0.0)
    s = depth / (1.0 + hole / pin * depth ** (1 / 9))
    for _ in range(6):
        slope = 1.0 + 10 / 9 * hole / pin * s ** (1 / 9)
        s = s - (s + hole / pin * s ** (10 / 9) - depth) / slope
    return hole * np.maximum(s, 0.0) ** (10 / 9)


class _Drive:
    def __init__(self, core: dict[str, Any]) -> None:
        to_mm = 1e-3 ** (10 / 9)
        self.e, self.ring = core["eccentricity"] * 1e3, core["ring_radius"] * 1e3
        self.circle, self.lobes = core["pin_circle_radius"] * 1e3, core["lobes"]
        self.discs, self.pins = core["discs"], core["output_pins"]
        self.ring_k, self.hole_k = core["ring_stiffness"] * to_mm, core["hole_stiffness"] * to_mm
        self.pin_k = [value * 1e-3 for value in core["pin_stiffness"]]
        self.ring_gap, self.hole_gap = core["ring_gap"] * 1e3, core["hole_gap"] * 1e3
        self.bearing = core["bearing_stiffness"] * 1e-3
        angles = 2 * np.pi * np.arange(self.lobes + 1) / (self.lobes + 1)
        self.ring_pins = self.ring * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        angles = 2 * np.pi * np.arange(self.pins) / self.pins
        self.holes = np.stack([np.cos(angles), np.sin(angles)], axis=1)

    def residual(self, unknowns: Reals, torque: float, crank: float) -> Reals:
        out = [torque / self.circle]
        for disc in range(self.discs):
            turn = unknowns[1 + 3 * disc] / self.circle
            shift = unknowns[2 + 3 * disc : 4 + 3 * disc]
            at = crank + 2 * np.pi * disc / self.discs
            u = np.array([np.cos(at), np.sin(at)])
            to_pitch = self.e * (self.lobes + 1) * u - self.ring_pins
            normal = to_pitch / np.hypot(to_pitch[:, 0], to_pitch[:, 1])[:, None]
            arm = self.e * self.lobes * (u[0] * normal[:, 1] - u[1] * normal[:, 0])
            depth = -normal @ shift - arm * turn - self.ring_gap
            ring = self.ring_k * np.maximum(depth, 0.0) ** (10 / 9)
            carried = crank * -1.0 / self.lobes
            c, s = np.cos(carried), np.sin(carried)
            arm_u = self.circle * self.holes @ np.array([[c, s], [-s, c]])
            across = np.stack([-arm_u[:, 1], arm_u[:, 0]], axis=1)
            relative = turn - unknowns[0] / self.circle
            apart = self.e * u + shift + relative * across
            distance = np.hypot(apart[:, 0], apart[:, 1])
            force = _pin_force(distance - self.e - self.hole_gap, self.hole_k, self.pin_k[disc])
            pull = force[:, None] * apart / distance[:, None]
            moment = float((pull * across).sum()) / self.circle
            balance = (ring[:, None] * normal).sum(0) - pull.sum(0) - self.bearing * shift
            out[0] += moment
            out += [float(ring @ arm) / self.circle - moment, *balance]
        return np.array(out)


def twists(core: dict[str, Any], torque_nm: float) -> tuple[Reals, int]:
    """Mean twist [arcmin] of the flange at each load, and how many equilibria were not found.

    Parameters
    ----------
    core : dict
        Geometry and stiffnesses of one drive, SI, as the core tells them.
    torque_nm : float
        Rated torque [N m].
    """
    drive = _Drive(core)
    period = 2 * np.pi / drive.pins * drive.lobes / (drive.lobes + 1)
    cranks = period * np.arange(POSITIONS) / POSITIONS
    means, missed = [], 0
    start = np.zeros(1 + 3 * drive.discs)
    free = (drive.hole_gap + drive.ring_gap * drive.circle / (drive.e * drive.lobes)) + 0.02
    start[0], start[1::3] = 2 * free, free
    for share in SHARES:
        guess, sum_of_twists = start, 0.0
        for crank in cranks:
            torque = torque_nm * 1e3 * share
            found = root(drive.residual, guess, args=(torque, crank), method="hybr")
            missed += int(np.abs(found.fun).max() > 1e-6 * torque / drive.circle)
            guess = found.x
            sum_of_twists += found.x[0]
        means.append(sum_of_twists / POSITIONS / drive.circle * 10800 / np.pi)
    return np.array(means), missed
