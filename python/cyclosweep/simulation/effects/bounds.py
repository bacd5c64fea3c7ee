"""Bounds of an effect's parameters, as narrow as a recording allows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.simulation.effects.history import History
from cyclosweep.simulation.effects.parameters import Parameter

FEWEST_STEPS = 3.0
"""Steps between samples below which a delay cannot be told from drag."""
MOST_FRICTION = 0.95
"""Largest share of the transmitted torque that friction may take."""


def within_recording(parameter: Parameter, history: History) -> Parameter:
    """Bound a load or a time by what a recording can show.

    Loads lie between a thousandth and three times the largest one; times are at least a few
    steps between samples.

    Parameters
    ----------
    parameter : Parameter
        Of a shape.
    history : History
        Load history of the recording.

    Returns
    -------
    Parameter
        The same with other bounds.
    """
    lower, upper = parameter.lower, parameter.upper
    if parameter.unit == "N m":
        top = history.largest_torque_nm
        lower, upper = max(lower, 1e-3 * top), min(upper, 3.0 * top)
    elif parameter.unit == "s":
        lower = max(lower, FEWEST_STEPS * history.usual_step_s)
    return replace(parameter, lower=lower, upper=upper) if lower < upper else parameter


def within_load(
    amplitudes: Sequence[Parameter], limits: tuple[float, float], history: History
) -> tuple[Parameter, ...]:
    """Bound friction by the largest torque, and below what is transmitted.

    Parameters
    ----------
    amplitudes : sequence of Parameter
        Of a friction.
    limits : tuple of float
        Limit of a friction of unit amplitude without load [N m], and in proportion to the
        transmitted torque.
    history : History
        Load history of the recording.

    Returns
    -------
    tuple of Parameter
    """
    plain, loaded = limits
    most = min(
        history.largest_torque_nm / plain if plain > 0 else np.inf,
        MOST_FRICTION / loaded if loaded > 0 else np.inf,
    )
    return tuple(replace(each, upper=min(each.upper, most)) for each in amplitudes)
