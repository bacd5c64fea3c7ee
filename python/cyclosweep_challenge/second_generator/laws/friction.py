"""Friction laws of the torque balance, solved in small increments of twist and time.

Each law holds its state, answers with the resisting torque at the end of a trial increment and the
slope of that torque by twist, and keeps the increment when told so. Torque and twist are in rated
torques, speed in rated torques a second.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping

Parameters = Mapping[str, float]


class Resistance(ABC):
    """A resisting torque with memory.

    Attributes
    ----------
    torque : float
        Resisting torque after the last kept increment [rated torques].
    """

    def __init__(self, limit: float, shape: Parameters) -> None:
        self.limit = limit
        self.shape = shape
        self.torque = 0.0

    @abstractmethod
    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """Resisting torque after a step of twist that ends at ``twist``, and its slope."""

    def keep(self, twist: float, step: float, dt: float) -> None:
        """Accept the increment."""
        self.torque = self.trial(twist, step, dt)[0]

    def saturate(self, direction: float) -> None:
        """Let the shaft travel through the free play: everything slides one way."""
        self.torque = direction * self.limit

    def rest(self) -> None:
        """Forget everything: a new run begins."""
        self.torque = 0.0


class Jenkins(Resistance):
    """Parallel Jenkins elements with a uniform spread of yield (Iwan's distributed model).

    References
    ----------
    W. D. Iwan, "A distributed-element model for hysteresis and its steady-state dynamic
    response", J. Appl. Mech., vol. 33, pp. 893-900, 1966.
    """

    count = 6

    def __init__(self, limit: float, shape: Parameters) -> None:
        super().__init__(limit, shape)
        reach = shape["reach"]
        spread = shape["spread"]
        n = self.count
        self.reaches = [reach * (1.0 + spread * (2.0 * (k + 0.5) / n - 1.0)) for k in range(n)]
        self.bent = [0.0] * n

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        total, slope = 0.0, 0.0
        for reach, bent in zip(self.reaches, self.bent, strict=True):
            new = bent + step
            if new > reach:
                total += 1.0
            elif new < -reach:
                total -= 1.0
            else:
                total += new / reach
                slope += 1.0 / reach
        share = self.limit / self.count
        return share * total, share * slope

    def keep(self, twist: float, step: float, dt: float) -> None:
        """See `Resistance.keep`."""
        self.torque = self.trial(twist, step, dt)[0]
        self.bent = [
            min(max(bent + step, -reach), reach)
            for reach, bent in zip(self.reaches, self.bent, strict=True)
        ]

    def saturate(self, direction: float) -> None:
        """See `Resistance.saturate`."""
        super().saturate(direction)
        self.bent = [direction * reach for reach in self.reaches]

    def rest(self) -> None:
        """See `Resistance.rest`."""
        super().rest()
        self.bent = [0.0] * self.count


class Dahl(Resistance):
    """Dahl's law with an exponent other than one, integrated exactly over each increment.

    dF/dx = sigma (1 - sgn(v) F / F_c)^i with i between 0.5 and 2.

    References
    ----------
    P. R. Dahl, "A solid friction model", Aerospace Corp. report TOR-0158(3107-18)-1, 1968;
    "Solid friction damping of mechanical vibrations", AIAA J., vol. 14, pp. 1675-1682, 1976.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        return dahl_step(self.torque, self.limit, step, self.shape["reach"], self.shape["power"])


def dahl_step(
    torque: float, limit: float, step: float, reach: float, power: float
) -> tuple[float, float]:
    """Torque and slope after one increment of Dahl's law.

    Parameters
    ----------
    torque, limit : float
        Torque before the increment and its limit [rated torques].
    step, reach : float
        Increment, and limit over initial slope [rated torques].
    power : float
        Dahl's exponent [-].
    """
    if limit <= 0.0:
        return 0.0, 0.0
    way = 1.0 if step >= 0.0 else -1.0
    left = max(1.0 - way * torque / limit, 0.0)
    travel = abs(step) / reach
    if abs(power - 1.0) < 1e-6:
        left *= math.exp(-travel)
    elif left > 0.0:
        base = left ** (1.0 - power) - (1.0 - power) * travel
        left = base ** (1.0 / (1.0 - power)) if base > 0.0 else 0.0
    return way * limit * (1.0 - left), limit / reach * left**power


class BoucWen(Resistance):
    """Bouc-Wen hysteresis, whose loop need not be that of any set of sliders.

    dz/dx = [1 - |z|^n (beta sgn(dx z) + 1 - beta)] / reach, by the midpoint rule.

    References
    ----------
    R. Bouc, "Forced vibration of mechanical systems with hysteresis", Proc. 4th Conf. Nonlinear
    Oscillation, Prague, 1967; Y.-K. Wen, "Method for random vibration of hysteretic systems",
    J. Eng. Mech. Div. ASCE, vol. 102, pp. 249-263, 1976.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        if self.limit <= 0.0:
            return 0.0, 0.0
        z, slope = bouc_wen_step(self.torque / self.limit, step, self.shape)
        return self.limit * z, self.limit * slope


def bouc_wen_step(z: float, step: float, shape: Parameters) -> tuple[float, float]:
    """Bouc-Wen variable after an increment, and its slope by twist.

    Parameters
    ----------
    z : float
        Variable before, between -1 and 1 [-].
    step : float
        Increment of twist [rated torques].
    shape : mapping
        ``reach`` [rated torques], ``power`` and ``beta`` [-].
    """
    reach, power, beta = shape["reach"], shape["power"], shape["beta"]
    way = 1.0 if step >= 0.0 else -1.0

    def rate(value: float) -> float:
        with_motion = 1.0 if value * way > 0.0 else -1.0
        return float(1.0 - abs(value) ** power * (beta * with_motion + 1.0 - beta)) / reach

    middle = min(max(z + 0.5 * step * rate(z), -1.0), 1.0)
    slope = max(rate(middle), 0.0)
    return min(max(z + step * slope, -1.0), 1.0), slope


class LuGre(Resistance):
    """LuGre bristles with velocity weakening, by implicit steps in time.

    z' = v - |v| z / (reach g(v)), g(v) = 1 + weakening exp(-(v / v_s)^2), F = F_c z / reach.

    References
    ----------
    C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, "A new model for control of systems
    with friction", IEEE Trans. Autom. Control, vol. 40, pp. 419-425, 1995,
    doi:10.1109/9.376053.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        reach = self.shape["reach"]
        top = stribeck(abs(step) / dt, self.shape)
        bristle = self.torque / self.limit if self.limit > 0.0 else 0.0
        travel = abs(step) / (reach * top)
        fade = math.exp(-travel)
        way = 1.0 if step >= 0.0 else -1.0
        new = way * top + (bristle - way * top) * fade
        return self.limit * new, self.limit * (1.0 - way * bristle / top) * fade / reach


def stribeck(speed: float, shape: Parameters) -> float:
    """Stribeck curve over its value at high speed: one plus a part that dies out with speed [-].

    Parameters
    ----------
    speed : float
        Magnitude of the speed [rated torques/s].
    shape : mapping
        ``weakening`` [-] and ``stribeck_speed`` [rated torques/s].
    """
    ratio = speed / shape["stribeck_speed"]
    return 1.0 + shape["weakening"] * math.exp(-min(ratio * ratio, 700.0))


class GeneralisedMaxwell(Jenkins):
    """Generalised Maxwell-slip: sliding elements follow the Stribeck curve with a lag.

    While an element slides, F_i' = sgn(v) C (share - F_i / s(v)); else it is a spring.

    References
    ----------
    F. Al-Bender, V. Lampaert, J. Swevers, "The generalized Maxwell-slip model: a novel model for
    friction simulation and compensation", IEEE Trans. Autom. Control, vol. 50, pp. 1883-1887,
    2005, doi:10.1109/TAC.2005.858676.
    """

    def __init__(self, limit: float, shape: Parameters) -> None:
        super().__init__(limit, shape)
        self.top = 1.0

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        top = self._top(step, dt)
        total, slope = 0.0, 0.0
        for reach, bent in zip(self.reaches, self.bent, strict=True):
            new, edge = bent + step, reach * top
            if new > edge:
                total += top
            elif new < -edge:
                total -= top
            else:
                total += new / reach
                slope += 1.0 / reach
        share = self.limit / self.count
        return share * total, share * slope

    def _top(self, step: float, dt: float) -> float:
        """Limit over its value at high speed, with the lag of sliding contacts."""
        target = stribeck(abs(step) / dt, self.shape)
        lag = 1.0 - math.exp(-abs(step) / self.shape["attraction"])
        return self.top + (target - self.top) * lag

    def keep(self, twist: float, step: float, dt: float) -> None:
        """See `Resistance.keep`."""
        self.torque = self.trial(twist, step, dt)[0]
        self.top = self._top(step, dt)
        self.bent = [
            min(max(bent + step, -reach * self.top), reach * self.top)
            for reach, bent in zip(self.reaches, self.bent, strict=True)
        ]


class Stribeck(Resistance):
    """Coulomb slider behind a spring whose limit falls with speed.

    References
    ----------
    R. Stribeck, "Die wesentlichen Eigenschaften der Gleit- und Rollenlager", Z. VDI, vol. 46,
    1902; form of L. C. Bo and D. Pavelescu, "The friction-speed relation and its influence on
    the critical velocity of stick-slip motion", Wear, vol. 82, pp. 277-289, 1982.
    """

    def trial(self, twist: float, step: float, dt: float) -> tuple[float, float]:
        """See `Resistance.trial`."""
        edge = self.limit * stribeck(abs(step) / dt, self.shape)
        stiffness = self.limit / self.shape["reach"]
        new = self.torque + stiffness * step
        if abs(new) > edge:
            return math.copysign(edge, new), 0.0
        return new, stiffness
