"""Transients of trains by SciPy's integrator with events, written apart from the package."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

Reals = npt.NDArray[np.float64]


@dataclass
class Oracle:
    """A chain with play and at most one slip element a spring, under constant torques.

    ``contact`` is -1, 0 or 1 a spring; ``slides`` the sense in which its element slides, 0 while
    it holds from the twist ``anchor`` on.
    """

    inertias: list[float]
    stiffnesses: list[float]
    gaps: list[float]
    friction: list[tuple[float, float] | None]
    grounded: bool
    torques: list[float]
    contact: list[int] = field(default_factory=list)
    slides: list[int] = field(default_factory=list)
    anchor: list[float] = field(default_factory=list)

    def twists(self, values: Reals) -> Reals:
        """Differences of neighbours."""
        padded = np.r_[values, 0.0] if self.grounded else values
        return np.asarray(padded[:-1] - padded[1:])

    def carried(self, k: int, twist: float) -> float:
        """Torque of spring k."""
        total = 0.0
        if self.contact[k]:
            total += self.stiffnesses[k] * (twist - self.contact[k] * self.gaps[k])
        element = self.friction[k]
        if element is not None:
            stiffness, limit = element
            held = stiffness * (twist - self.anchor[k])
            total += self.slides[k] * limit if self.slides[k] else held
        return total

    def rates(self, _: float, state: Reals) -> Reals:
        """Speeds and accelerations."""
        n = len(self.inertias)
        torques = np.array(self.torques)
        for k, twist in enumerate(self.twists(state[:n])):
            carried = self.carried(k, float(twist))
            torques[k] -= carried
            if k + 1 < n:
                torques[k + 1] += carried
        return np.concatenate([state[n:], torques / np.array(self.inertias)])

    def conditions(self) -> list[tuple[int, str, Any]]:
        """What may end the branch: spring, name, and a function of the state that falls to zero."""
        found: list[tuple[int, str, Any]] = []
        for k, gap in enumerate(self.gaps):
            if gap > 0 and self.contact[k]:
                found.append((k, "leave", self._falling(k, self.contact[k], gap, leaves=True)))
            elif gap > 0:
                found += [(k, f"meet{s}", self._falling(k, s, gap)) for s in (-1, 1)]
            element = self.friction[k]
            if element is not None and self.slides[k]:
                found.append((k, "stop", self._speed_falling(k, self.slides[k])))
            elif element is not None:
                reach = element[1] / element[0]
                for side in (-1, 1):
                    limit = reach + side * self.anchor[k]
                    found.append((k, f"slide{side}", self._falling(k, side, limit)))
        return found

    def _falling(self, k: int, side: int, limit: float, leaves: bool = False) -> Any:
        """Distance of a twist from a limit on one side, from within or, where it leaves, beyond."""
        n = len(self.inertias)

        def distance(_: float, state: Reals) -> float:
            beyond = side * float(self.twists(state[:n])[k]) - limit
            return beyond if leaves else -beyond

        return _ends(distance)

    def _speed_falling(self, k: int, side: int) -> Any:
        n = len(self.inertias)
        return _ends(lambda _, state: side * float(self.twists(state[n:])[k]))

    def run(self, angles: Reals, speeds: Reals, duration: float) -> tuple[Reals, int]:
        """State at the end, and the number of events."""
        n = len(self.inertias)
        start = self.twists(angles)
        self.contact = [
            int(np.sign(t)) if g == 0 or abs(t) > g else 0
            for t, g in zip(start, self.gaps, strict=True)
        ]
        self.contact = [
            c or (1 if g == 0 else 0) for c, g in zip(self.contact, self.gaps, strict=True)
        ]
        self.slides = [0] * len(start)
        self.anchor = [float(t) for t in start]
        state, now, count = np.r_[angles, speeds], 0.0, 0
        while now < duration:
            conditions = self.conditions()
            solved = solve_ivp(
                self.rates, (now, duration), state, method="DOP853", rtol=1e-12, atol=1e-13,
                max_step=1e-4, events=[function for _, _, function in conditions],
            )  # fmt: skip
            state, now = solved.y[:, -1], float(solved.t[-1])
            if solved.status != 1:
                break
            count += 1
            assert solved.t_events is not None
            happened = [
                c for c, times in zip(conditions, solved.t_events, strict=True) if len(times)
            ]
            k, name, _ = happened[0]
            twist = float(self.twists(state[:n])[k])
            if name == "leave":
                self.contact[k] = 0
            elif name.startswith("meet"):
                self.contact[k] = int(name[4:])
            elif name.startswith("slide"):
                self.slides[k] = int(name[5:])
            else:
                element = self.friction[k]
                assert element is not None
                self.anchor[k] = twist - self.slides[k] * element[1] / element[0]
                self.slides[k] = 0
        return state, count


def _ends(function: Any) -> Any:
    function.terminal = True
    function.direction = -1
    return function
