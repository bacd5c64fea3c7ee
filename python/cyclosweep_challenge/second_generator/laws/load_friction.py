"""Friction in proportion to the transmitted torque, and drag of the lubricant."""

from __future__ import annotations

import math

from cyclosweep_challenge.second_generator.laws.friction import (
    Parameters,
    Resistance,
    bouc_wen_step,
    dahl_step,
)


class LoadedDahl(Resistance):
    """Coulomb's law with the transmitted torque as normal load, and Dahl's rounding.

    References
    ----------
    C. A. Coulomb, "Theorie des machines simples", 1785; P. R. Dahl, AIAA J., vol. 14,
    pp. 1675-1682, 1976; losses in proportion to the load in cycloidal drives: S. K. Malhotra,
    M. A. Parameswaran, Mech. Mach. Theory, vol. 18, pp. 491-499, 1983.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        limit = self.limit * abs(twist)
        held = min(max(self.torque, -limit), limit)
        return dahl_step(held, limit, step, self.shape["reach"], 1.0)

    def saturate(self, direction: float) -> None:
        """See `Resistance.saturate`: without load there is no friction."""
        self.torque = 0.0


class Wedge(Resistance):
    """Wedge or screw flank: losses differ between raising and lowering the load.

    A flank of lead angle a and friction angle r needs tan(a + r) / tan(a) of the ideal torque to
    raise a load and tan(a - r) / tan(a) to lower it, so lowering loses less than raising.

    References
    ----------
    R. G. Budynas, J. K. Nisbett, Shigley's Mechanical Engineering Design, 10th ed., sec. 8-2.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        raising = step * twist >= 0.0
        limit = self.limit * abs(twist) * (1.0 if raising else self.shape["lowering"])
        stiffness = self.limit / self.shape["reach"]
        new = self.torque + stiffness * step
        if abs(new) > limit:
            return math.copysign(limit, new), 0.0
        return new, stiffness

    def saturate(self, direction: float) -> None:
        """See `Resistance.saturate`: without load there is no friction."""
        self.torque = 0.0


class LoadedBoucWen(Resistance):
    """Bouc-Wen hysteresis whose limit follows a power of the load.

    References
    ----------
    Y.-K. Wen, J. Eng. Mech. Div. ASCE, vol. 102, pp. 249-263, 1976; limit by normal load as in
    M. C. Constantinou, A. Mokha, A. Reinhorn, "Teflon bearings in base isolation II: modeling",
    J. Struct. Eng., vol. 116, pp. 455-474, 1990.
    """

    def __init__(self, limit: float, shape: Parameters) -> None:
        super().__init__(limit, shape)
        self.z = 0.0

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        limit = self.limit * abs(twist) ** self.shape["load_power"]
        z, slope = bouc_wen_step(self.z, step, self.shape)
        return limit * z, limit * slope

    def keep(self, twist: float, step: float, dt: float) -> None:
        """See `Resistance.keep`."""
        self.torque = self.trial(twist, step, dt)[0]
        self.z = bouc_wen_step(self.z, step, self.shape)[0]

    def saturate(self, direction: float) -> None:
        """See `Resistance.saturate`."""
        self.torque, self.z = 0.0, direction

    def rest(self) -> None:
        """See `Resistance.rest`."""
        self.torque, self.z = 0.0, 0.0


class LinearDrag(Resistance):
    """Newtonian drag: torque in proportion to the rate of twist.

    References
    ----------
    N. Petrov, "Friction in machines and the effect of the lubricant", Inzh. Zh., 1883.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        factor = self.limit / self.shape["speed"]
        return factor * step / dt, factor / dt

    def saturate(self, direction: float) -> None:
        """See `Resistance.saturate`: drag has no memory."""
        self.torque = 0.0


class Eyring(LinearDrag):
    """Thermally activated shear: torque as the inverse hyperbolic sine of speed.

    References
    ----------
    H. Eyring, J. Chem. Phys., vol. 4, pp. 283-291, 1936, doi:10.1063/1.1749836; K. L. Johnson,
    J. L. Tevaarwerk, Proc. R. Soc. A, vol. 356, pp. 215-236, 1977.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        scale = self.shape["speed"] * self.shape["knee"]
        speed = step / dt / scale
        factor = self.limit / math.asinh(1.0 / self.shape["knee"])
        return factor * math.asinh(speed), factor / (scale * dt * math.hypot(1.0, speed))


class PowerDrag(LinearDrag):
    """Shear-thinning grease: torque as a power of speed below one.

    References
    ----------
    W. Ostwald, Kolloid-Z., vol. 36, pp. 99-117, 1925; W. H. Herschel, R. Bulkley, Kolloid-Z.,
    vol. 39, pp. 291-300, 1926.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        power, soft = self.shape["power"], 0.02
        speed = step / dt / self.shape["speed"]
        root = (speed * speed + soft * soft) ** (0.5 * (power - 1.0))
        slope = root * (1.0 + (power - 1.0) * speed * speed / (speed * speed + soft * soft))
        return self.limit * speed * root, self.limit * slope / (dt * self.shape["speed"])
