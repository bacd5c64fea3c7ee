"""How friction meets the play: where its elements are anchored, and what they slide by."""

import numpy as np

from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.parameters import Shape

STATES: tuple[Shape, ...] = ({"slack": 0.0}, {"slack": 1.0}, {"behind_play": 1.0})
"""How friction meets the play: it slides through it and starts on the first flank, or in the
middle; or it lies behind the play, which then does not move it."""


def state_of(shape: Shape) -> Shape | None:
    """Which of `STATES` a shape is in; None for one that does not say."""
    return next((each for each in STATES if each.items() <= dict(shape).items()), None)


def in_other_state(shape: Shape, state: Shape) -> Shape:
    """Shape of a friction that meets the play in another way.

    Parameters
    ----------
    shape : mapping
        Shape of a friction.
    state : mapping
        One of `STATES`.

    Returns
    -------
    mapping
    """
    kept = {name: v for name, v in shape.items() if name not in ("slack", "behind_play")}
    return {**kept, **state}


def lies_behind_play(shape: Shape) -> bool:
    """Whether friction slides with the elastic twist alone and stands while play is crossed."""
    return bool(shape.get("behind_play", 0.0))


def start_of(history: History, shape: Shape) -> Floats:
    """Angle at which fresh elements are anchored.

    Parameters
    ----------
    history : History
        Load history of n samples.
    shape : mapping
        `slack` 0: unloaded contact on the first flank; 1: the middle of the dead zone, so that the
        elements have slipped before the flank is reached. Friction behind the play starts unloaded.

    Returns
    -------
    ndarray, shape (n,)
        Angle [deg].
    """
    if lies_behind_play(shape):
        return np.full(len(history), history.datum_deg)
    contact = history.start_angle_deg
    return contact - float(shape.get("slack", 0.0)) * history.side * history.free_play_deg


def crossed_play(history: History, shape: Shape) -> Floats | float:
    """Part of the angle by which friction does not slide because it lies behind the play.

    Parameters
    ----------
    history : History
        Load history of n samples.
    shape : mapping
        Shape of a friction.

    Returns
    -------
    ndarray, shape (n,), or float
        In deg; zero for friction that slides through the play.
    """
    return history.side * history.free_play_deg if lies_behind_play(shape) else 0.0
