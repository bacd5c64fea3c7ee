"""The menu of load programmes, and which of them shows which effect."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from cyclosweep.simulation.effects.history import Floats

Varied = Literal["loads", "rates", "dwells", "positions", "temperature"]
"""What a programme changes; a rig has to be able to."""
Load = tuple[Floats, Floats, Floats, Floats]
"""Torque [N m], run, position [deg] and temperature [degC]."""

STEP_S = 1.0


@dataclass(frozen=True, slots=True)
class Plan:
    """A load programme in words and the history it makes, for a largest torque.

    Attributes
    ----------
    words : str
        What to do.
    make : callable
        History of a largest torque [N m].
    shares : tuple of float
        Torques between which one run is ramped, or all runs where they differ, over the largest
        torque.
    varies : str
        What it changes.
    once_more : str
        What to do where a recording shows this programme already; empty where that is not asked.
    """

    words: str
    make: Callable[[float], Load]
    shares: tuple[float, ...]
    varies: Varied = "loads"
    once_more: str = ""


def _line(points: Sequence[float], seconds: float) -> Floats:
    """Torque along straight ramps of equal duration.

    Parameters
    ----------
    points : sequence of float
        Torques at the ends of the ramps [N m].
    seconds : float
        Duration of all ramps [s].

    Returns
    -------
    ndarray, shape (n,)
        In N m.
    """
    count = max(int(seconds / STEP_S / max(len(points) - 1, 1)), 4)
    parts = [np.linspace(a, b, count, endpoint=False) for a, b in pairwise(points)]
    return np.concatenate([*parts, [points[-1]]])


def _runs(torques: Sequence[Floats], cranks: Sequence[float], warm: float = 0.0) -> Load:
    """Torque, run, position and temperature of consecutive runs.

    Parameters
    ----------
    torques : sequence of ndarray
        Torque of each run [N m].
    cranks : sequence of float
        Position of the mesh in each run [deg].
    warm : float
        Rise of temperature over all runs [K].

    Returns
    -------
    Load
    """
    run = np.concatenate([np.full(len(t), k, dtype=np.float64) for k, t in enumerate(torques)])
    crank = np.concatenate([np.full(len(t), c) for t, c in zip(torques, cranks, strict=True)])
    share = np.arange(len(run)) / max(len(run) - 1, 1)
    return np.concatenate(torques), run, crank, 20.0 + warm * share


LOOP = (0.0, 1.0, -1.0, 0.0)
"""Ends of the ramps of a loop, over the largest torque."""
NESTED = (0.0, 1.0, -1.0, 0.6, -0.4, 1.0, 0.4, 0.8, 0.0)
"""Ends of the ramps of nested loops, over the largest torque."""
LADDER = (0.2, 0.4, 0.7, 1.0, 1.2, 0.3)
"""Amplitudes of a ladder of loops, over the largest torque."""


def _nested(top: float) -> Load:
    """Nested and biased loops, twice."""
    points = [share * top for share in NESTED]
    return _runs([_line(points, 500), _line(points, 500)], [0, 0])


def _rates(top: float) -> Load:
    """The same loop at three rates."""
    points = [share * top for share in LOOP]
    return _runs([_line(points, s) for s in (60, 200, 700)], [0, 0, 0])


def _holds(top: float) -> Load:
    """Holds at full load and without load, both directions."""
    up, down = _line([0, top], 40), _line([top, 0], 40)
    path = np.concatenate([up, np.full(300, top), down, np.full(200, 0.02 * top)])
    return _runs([path, -path], [0, 0])


def _places(top: float) -> Load:
    """The same loop at eight positions of the mesh."""
    points = [share * top for share in LOOP]
    spots = [0, 45, 90, 135, 180, 225, 270, 315]
    return _runs([_line(points, 120) for _ in spots], spots)


def _returns(top: float) -> Load:
    """Small loops returning to three positions while the rig warms up by 4 K."""
    points = [0, 0.5 * top, -0.5 * top, 0]
    spots = [0, 120, 240, 0, 120, 240, 0, 120]
    return _runs([_line(points, 120) for _ in spots], spots, warm=4.0)


def _soak(top: float) -> Load:
    """Small loops at one position while the rig warms up by 10 K."""
    points = [0, 0.3 * top, -0.3 * top, 0]
    return _runs([_line(points, 120) for _ in range(8)], [0] * 8, warm=10.0)


def _ladder(top: float) -> Load:
    """Loops of growing amplitude, then a small one."""
    return _runs([_line([0, s * top, -s * top, 0], 150) for s in LADDER], [0] * len(LADDER))


def _wide(top: float) -> Load:
    """Two loops to 1.4 times the largest torque."""
    return _runs([_line([0, 1.4 * top, -1.4 * top, 0], 600) for _ in range(2)], [0, 0])


MENU: tuple[Plan, ...] = (
    Plan("nested and biased loops to the largest torque, twice", _nested, NESTED),
    Plan(
        "the same loop at three rates, one to ten",
        _rates,
        LOOP,
        "rates",
        "the same loop at three more rates, between those recorded and beyond them",
    ),
    Plan(
        "holds of five minutes at full load and without load, both directions",
        _holds,
        (0.0, 1.0, 0.0, -1.0, 0.0),
        "dwells",
    ),
    Plan(
        "the same loop at eight positions of the mesh zone",
        _places,
        LOOP,
        "positions",
        "the same loop at eight more positions of the mesh zone, between those recorded",
    ),
    Plan(
        "small loops returning to three positions while the rig warms up by 4 K",
        _returns,
        tuple(0.5 * share for share in LOOP),
        "temperature",
    ),
    Plan(
        "small loops at one position while the rig warms up by 10 K",
        _soak,
        tuple(0.3 * share for share in LOOP),
        "temperature",
    ),
    Plan(
        "loops of growing amplitude, then a small one again, each a run of its own, without "
        "zeroing the angle reading between them",
        _ladder,
        (0.0, *(part * share for share in LADDER for part in (1.0, -1.0, 0.0))),
    ),
    Plan(
        "two loops to 1.4 times the largest torque, if the drive may be loaded so far",
        _wide,
        tuple(1.4 * share for share in LOOP),
    ),
)

LOOPS = (_nested, _ladder)
"""Programmes whose loops show friction and the curve of the torque."""
SHOWN_BY: dict[str, tuple[Callable[[float], Load], ...]] = {
    "friction_hysteresis": LOOPS,
    "load_dependent_friction": LOOPS,
    "contact_stiffening": LOOPS,
    "clearance_takeup": LOOPS,
    "load_asymmetry": LOOPS,
    "dial_eccentricity": LOOPS,
    "viscous_drag": (_rates,),
    "creep": (_holds,),
    "transmission_error": (_places,),
    "phase_dependent_compliance": (_places,),
    "thermal_drift": (_soak,),
    "datum_drift": (_ladder,),
    "overload_softening": (_wide,),
}
"""Programmes that change what an effect follows, by the name of the effect. Others may hold more
readings, but something else would look the same in them."""


def able_to_show(names: Sequence[str]) -> tuple[Plan, ...]:
    """Programmes that show one of some effects; the whole menu for effects of users.

    Parameters
    ----------
    names : sequence of str
        Names of effects.

    Returns
    -------
    tuple of Plan
    """
    if any(name not in SHOWN_BY for name in names):
        return MENU
    able = {make for name in names for make in SHOWN_BY[name]}
    return tuple(plan for plan in MENU if plan.make in able)
