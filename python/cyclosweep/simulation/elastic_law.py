"""Twist over elastic torque of a model whose effects bend the straight line."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cyclosweep.simulation.effect_value import EffectValue, linear_twist
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.elastic_curve import ElasticCurve

LAW_POINTS = 128
"""Points of an elastic law on each side of zero."""


class CalibratedLine(Protocol):
    """A line with effects, as a model holds it."""

    @property
    def compliance_deg_per_nm(self) -> float:
        """Slope of the line [deg/(N m)]."""
        ...

    @property
    def free_play_deg(self) -> float:
        """Half width of the dead zone [deg]."""
        ...

    @property
    def elastic_curve(self) -> ElasticCurve | None:
        """Twist over torque beyond the free play, instead of the line."""
        ...

    def elastic_twist(self, torque_nm: Floats) -> Floats:
        """Twist beyond the free play without effects [deg]."""
        ...

    @property
    def effects(self) -> Sequence[EffectValue]:
        """Effects beside the line."""
        ...

    @property
    def output_pin_count(self) -> int:
        """Number of output pins."""
        ...


@dataclass(frozen=True, slots=True)
class ElasticLaw:
    """Twist beyond the dead zone over the elastic torque, point by point.

    Attributes
    ----------
    torque_nm : ndarray, shape (2 LAW_POINTS + 1,)
        Elastic torque, rising [N m].
    twist_deg : ndarray, shape (2 LAW_POINTS + 1,)
        Twist at that torque [deg].
    """

    torque_nm: Floats
    twist_deg: Floats


def elastic_law(model: CalibratedLine, largest_torque_nm: float) -> ElasticLaw | None:
    """Elastic law of the compliance and all effects that belong to it.

    The points lie closer towards zero; beyond three times the largest torque the law goes on
    straight. A stretch where the effects together would let the twist fall with growing torque is
    taken as rigid.

    Parameters
    ----------
    model : CalibratedLine
        Line and effects, such as a Model.
    largest_torque_nm : float
        Largest torque of the programme [N m].

    Returns
    -------
    ElasticLaw or None
        None where no effect of the model is elastic and it has no curve: the law is a line.
    """
    effects = [value for value in model.effects if value.effect.elastic]
    if not effects and model.elastic_curve is None:
        return None
    reach = 3.0 * max(largest_torque_nm, 1e-9)
    half = reach * np.geomspace(1e-5, 1.0, LAW_POINTS)
    torque = np.r_[-half[::-1], half]
    side = np.sign(torque)
    history = History(
        applied_nm=torque,
        elastic_nm=torque,
        angle_deg=side * model.free_play_deg + model.elastic_twist(torque),
        side=side,
        run=np.zeros(len(torque), dtype=np.int64),
        restart=np.arange(len(torque)) == 0,
        compliance_deg_per_nm=model.compliance_deg_per_nm,
        free_play_deg=model.free_play_deg,
        output_pin_count=model.output_pin_count,
    )
    twist = model.elastic_twist(torque) + linear_twist(effects, history)
    least = 1e-3 * model.compliance_deg_per_nm
    upper = np.maximum.accumulate(np.r_[0.0, twist[LAW_POINTS:]] - least * np.r_[0.0, half])
    lower = np.maximum.accumulate(np.r_[0.0, -twist[:LAW_POINTS][::-1]] - least * np.r_[0.0, half])
    upper, lower = upper + least * np.r_[0.0, half], lower + least * np.r_[0.0, half]
    return ElasticLaw(np.r_[-half[::-1], 0.0, half], np.r_[-lower[:0:-1], upper])
