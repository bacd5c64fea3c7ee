"""Twist that the elastic parts of a drive lose for each unit of drag, and what lags with it.

Drag takes a part of the torque, and the elastic parts are twisted by what it leaves: where the
drive is softer, the same drag takes away more twist.
"""

from collections.abc import Callable, Sequence

import numpy as np

from cyclosweep.simulation.effect_value import EffectValue, linear_twist
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.viscous_drag import holds_friction
from cyclosweep.simulation.elastic_law import CalibratedLine

LEAST_DRAG = 1e-3
"""Drag for which the compliance is taken at the least, as a share of the largest torque."""
LEAST_COMPLIANCE = 1e-3
"""Compliance at the least, as a share of that of the line."""


def under_drag_of(model: CalibratedLine, history: History) -> History:
    """History with the compliance at which the drag of a model takes its twist.

    Parameters
    ----------
    model : CalibratedLine
        Line and effects, such as a Model.
    history : History
        Load history with the elastic torque.

    Returns
    -------
    History
        The same without drag.
    """
    drags = [value for value in model.effects if value.effect.is_drag]
    if not drags:
        return history
    elastic = [value for value in model.effects if value.elastic]

    def twist(under: History) -> Floats:
        return model.elastic_twist(under.elastic_nm) + linear_twist(elastic, under)

    return with_drag_compliance(history, twist, linear_twist(drags, history))


def with_drag_compliance(
    history: History, elastic_twist: Callable[[History], Floats], by_drag_deg: Floats
) -> History:
    """History with the compliance at which drag takes its twist.

    It is the secant of the elastic law from the torque that drag leaves to the torque before it,
    so that the twist is exact once drag and law have settled.

    Parameters
    ----------
    history : History
        Load history of n samples with the elastic torque, and the drag compliance of the round
        before.
    elastic_twist : callable
        From a history to the twist beyond the free play at its elastic torque, shape (n,) [deg].
    by_drag_deg : ndarray, shape (n,)
        Twist by drag in the round before, negative where drag takes from a positive torque [deg].

    Returns
    -------
    History
    """
    line = history.compliance_deg_per_nm
    before = line if history.drag_compliance is None else history.drag_compliance
    drag = -by_drag_deg / before
    least = LEAST_DRAG * history.largest_torque_nm
    drag = np.where(np.abs(drag) < least, np.where(drag < 0.0, -least, least), drag)
    lost = elastic_twist(_under(history, 0.0)) - elastic_twist(_under(history, drag))
    return history.with_state(drag_compliance=np.maximum(lost / drag, LEAST_COMPLIANCE * line))


def _under(history: History, drag_nm: Floats | float) -> History:
    """The same under what a drag leaves of the elastic torque, on the flank that it presses."""
    torque = history.elastic_nm - drag_nm
    side = np.where(torque == 0.0, history.side, np.sign(torque))
    return history.with_state(elastic_nm=torque, side=side)


def lagging_with_friction(values: Sequence[EffectValue]) -> list[EffectValue]:
    """Drags with which the part that friction holds lags."""
    return [value for value in values if value.effect.is_drag and holds_friction(value.shape)]
