"""All laws by effect, and how those of the torque balance are made."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from cyclosweep_challenge.second_generator.laws import delay, elastic, position, zero
from cyclosweep_challenge.second_generator.laws.friction import (
    BoucWen,
    Dahl,
    GeneralisedMaxwell,
    Jenkins,
    LuGre,
    Resistance,
    Stribeck,
)
from cyclosweep_challenge.second_generator.laws.law import Cause, Draw, Law, Parameters
from cyclosweep_challenge.second_generator.laws.load_friction import (
    Eyring,
    LinearDrag,
    LoadedBoucWen,
    LoadedDahl,
    PowerDrag,
    Wedge,
)

STRIBECK_SPEEDS = (0.01, 0.3)
"""Speeds over which velocity weakening dies out [rated torques/s]: within those of a programme."""


def _drawn(reaches: tuple[float, float], **ranges: tuple[float, float]) -> Draw:
    def draw(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
        drawn = {k: float(rng.uniform(*v)) for k, v in ranges.items()}
        reach = float(np.exp(rng.uniform(*np.log(reaches))))
        slow, fast = np.log(STRIBECK_SPEEDS)
        speed = float(np.exp(rng.uniform(slow, fast)))
        return {"top": top, "reach": reach, "stribeck_speed": speed, "speed": 0.3} | drawn

    return draw


WEAK = (0.1, 0.5)
REACH = (0.04, 0.4)
CLOCK = frozenset({"clock"})
Maker = Callable[[float, dict[str, float]], Resistance]
_BALANCE: tuple[tuple[Law, Maker], ...] = (
    (
        Law(
            "friction_hysteresis",
            "jenkins",
            (Jenkins.__doc__ or ""),
            _drawn(REACH, spread=(0.0, 0.9)),
        ),
        Jenkins,
    ),
    (
        Law("friction_hysteresis", "dahl", (Dahl.__doc__ or ""), _drawn(REACH, power=(0.5, 2.0))),
        Dahl,
    ),
    (
        Law(
            "friction_hysteresis",
            "bouc-wen",
            (BoucWen.__doc__ or ""),
            _drawn(REACH, power=(1.0, 3.0), beta=(0.3, 0.9)),
        ),
        BoucWen,
    ),
    (
        Law(
            "friction_hysteresis",
            "lugre",
            (LuGre.__doc__ or ""),
            _drawn(REACH, weakening=WEAK),
            needs=CLOCK,
        ),
        LuGre,
    ),
    (
        Law(
            "friction_hysteresis",
            "generalised-maxwell",
            (GeneralisedMaxwell.__doc__ or ""),
            _drawn(REACH, spread=(0.2, 0.9), weakening=WEAK, attraction=(0.02, 0.2)),
            needs=CLOCK,
        ),
        GeneralisedMaxwell,
    ),
    (
        Law(
            "friction_hysteresis",
            "stribeck",
            (Stribeck.__doc__ or ""),
            _drawn(REACH, weakening=WEAK),
            needs=CLOCK,
        ),
        Stribeck,
    ),
    (
        Law("load_dependent_friction", "coulomb-dahl", (LoadedDahl.__doc__ or ""), _drawn(REACH)),
        LoadedDahl,
    ),
    (
        Law(
            "load_dependent_friction",
            "wedge",
            (Wedge.__doc__ or ""),
            _drawn(REACH, lowering=(0.5, 0.95)),
        ),
        Wedge,
    ),
    (
        Law(
            "load_dependent_friction",
            "coulomb-slider",
            (Wedge.__doc__ or ""),
            _drawn(REACH, lowering=(1.0, 1.0)),
        ),
        Wedge,
    ),
    (
        Law(
            "load_dependent_friction",
            "bouc-wen",
            (LoadedBoucWen.__doc__ or ""),
            _drawn(REACH, power=(1.0, 2.0), beta=(0.3, 0.9), load_power=(0.8, 1.2)),
        ),
        LoadedBoucWen,
    ),
    (
        Law("viscous_drag", "linear", (LinearDrag.__doc__ or ""), _drawn(REACH), needs=CLOCK),
        LinearDrag,
    ),
    (
        Law(
            "viscous_drag",
            "eyring",
            (Eyring.__doc__ or ""),
            _drawn(REACH, knee=(0.05, 0.5)),
            needs=CLOCK,
        ),
        Eyring,
    ),
    (
        Law(
            "viscous_drag",
            "power",
            (PowerDrag.__doc__ or ""),
            _drawn(REACH, power=(0.4, 0.8)),
            needs=CLOCK,
        ),
        PowerDrag,
    ),
)

LAWS: tuple[Law, ...] = (
    *(law for law, _ in _BALANCE),
    *elastic.LAWS,
    *zero.LAWS,
    *delay.LAWS,
    *position.LAWS,
)
MAKERS = {(law.effect, law.name): maker for law, maker in _BALANCE}
VOCABULARY = tuple(dict.fromkeys(law.effect for law in LAWS))
"""Effects, in the order of the table of laws."""
LIBRARY_LIKE = ("jenkins", "coulomb-slider")
"""Friction laws of sliders behind springs, which is the library's family."""
EITHER_SIGN = frozenset(
    {
        "datum_drift",
        "transmission_error",
        "phase_dependent_compliance",
        "thermal_drift",
        "load_asymmetry",
        "dial_eccentricity",
    }
)
"""Effects that may turn the shaft either way."""


def laws_of(effect: str) -> tuple[Law, ...]:
    """Laws of one effect.

    Raises
    ------
    ValueError
        If the vocabulary has no such effect.
    """
    found = tuple(law for law in LAWS if law.effect == effect)
    if not found:
        raise ValueError(f"effect: found {effect!r}, expected one of {', '.join(VOCABULARY)}")
    return found


def resistance(cause: Cause, top: float) -> Resistance:
    """Resisting torque of a cause whose law is one of the torque balance.

    Parameters
    ----------
    cause : Cause
        The cause; its size is a share of the largest torque.
    top : float
        Largest torque [rated torques].
    """
    law = cause.law
    share = cause.size if law.effect == "load_dependent_friction" else cause.size * top
    return MAKERS[law.effect, law.name](share, dict(cause.shape))


def reach(shape: Parameters) -> float:
    """Presliding travel by which the increments of the balance are chosen [rated torques]."""
    return float(shape["reach"])
