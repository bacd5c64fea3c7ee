"""Position of the mesh while the shaft twists: effects that depend on it move it themselves."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.order_names import travels
from cyclosweep.simulation.effects.orders import MeshPeriodic
from cyclosweep.simulation.model import EffectValue, linear_twist

MESH_ROUNDS = 24
"""Rounds more in which friction and a travelling mesh settle on each other. Each leaves at most the
slope of the staircase of the error of the one before."""
MOST_STEPS = 60
"""Most steps of the solution at known friction. Even halving alone is then exact."""
EXACT_DEG = 1e-10
"""Error of the angle at which the solution ends [deg]."""
PROBE_DEG = 1e-5
"""Step of the angle by which the slope of a staircase is measured [deg]."""
LEAST_SLOPE = 0.02
"""Slope of the equation below which halving is preferred."""


def travelling(values: Sequence[EffectValue]) -> list[EffectValue]:
    """Effects that depend on a mesh position which travels with the twist."""
    return [
        value for value in values if isinstance(value.effect, MeshPeriodic) and travels(value.shape)
    ]


def on_the_mesh(values: Sequence[EffectValue], history: History, rest_deg: Floats) -> History:
    """Solve for the angle at which a shaft stands on its staircase.

    The angle is the rest and what the effects add at that very angle: one equation a sample, of
    one solution where the staircase rises by less than the shaft travels. It is solved by Newton's
    method, safe within a bracket.

    Parameters
    ----------
    values : sequence of EffectValue
        Effects that depend on the travel.
    history : History
        Load history with the angle from which the solution starts, n samples.
    rest_deg : ndarray, shape (n,)
        Angle without these effects [deg].

    Returns
    -------
    History
        The same with the solved angle.
    """

    def twist(angle: Floats) -> Floats:
        return linear_twist(values, history.with_state(angle_deg=angle))

    reach = np.zeros(len(history))
    for value in values:
        # Cosine and sine of one order make up the same length at any angle.
        length = np.linalg.norm(value.effect.columns(history, value.shape), axis=1)
        reach += length * float(np.linalg.norm(value.amplitudes))
    low, high = rest_deg - reach, rest_deg + reach
    angle = np.clip(history.angle_deg, low, high)
    for _ in range(MOST_STEPS):
        added = twist(angle)
        over = angle - rest_deg - added
        if float(np.max(np.abs(over), initial=0.0)) < EXACT_DEG:
            break
        low, high = np.where(over < 0, angle, low), np.where(over > 0, angle, high)
        slope = 1.0 - (twist(angle + PROBE_DEG) - added) / PROBE_DEG
        newton = angle - over / np.maximum(slope, LEAST_SLOPE)
        inside = (newton >= low) & (newton <= high)
        angle = np.where(inside, newton, 0.5 * (low + high))
    return history.with_state(angle_deg=angle)
