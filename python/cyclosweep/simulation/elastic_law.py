"""Twist over elastic torque of a model whose effects bend the straight line."""

from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from cyclosweep.simulation.effect_value import EffectValue, linear_twist
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.twist_law import ElasticLaw
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


def elastic_law(
    model: CalibratedLine, largest_torque_nm: float, *, held_by_friction: bool = False
) -> ElasticLaw | None:
    """Elastic law of the compliance and all effects that belong to it; see `law_of_twist`.

    Parameters
    ----------
    model : CalibratedLine
        Line and effects, such as a Model.
    largest_torque_nm : float
        Largest torque of the programme [N m].
    held_by_friction : bool
        Leave out the effects in series with the part that friction holds.

    Returns
    -------
    ElasticLaw or None
        None where no effect of the model is elastic and it has no curve: the law is a line.
    """
    effects = [
        value
        for value in model.effects
        if value.effect.elastic and not (held_by_friction and value.in_series)
    ]
    if not effects and model.elastic_curve is None:
        return None

    def twist(torque: Floats) -> Floats:
        straight = model.elastic_twist(torque)
        line = model.compliance_deg_per_nm, model.free_play_deg
        history = history_through(torque, straight, line, model.output_pin_count)
        return np.asarray(straight + linear_twist(effects, history))

    return law_of_twist(twist, largest_torque_nm, model.compliance_deg_per_nm)


def history_through(
    torque_nm: Floats, twist_deg: Floats, line: tuple[float, float], output_pin_count: int
) -> History:
    """Load history that passes through elastic torques in one run, each on its own flank.

    Parameters
    ----------
    torque_nm : ndarray, shape (n,)
        Elastic torque [N m], never zero.
    twist_deg : ndarray, shape (n,)
        Twist beyond the dead zone at that torque [deg].
    line : tuple of float
        Compliance [deg/(N m)] and free play [deg].
    output_pin_count : int
        Number of output pins.

    Returns
    -------
    History
    """
    side = np.sign(torque_nm)
    compliance, free_play = line
    return History(
        applied_nm=torque_nm,
        elastic_nm=torque_nm,
        angle_deg=side * free_play + twist_deg,
        side=side,
        run=np.zeros(len(torque_nm), dtype=np.int64),
        restart=np.arange(len(torque_nm)) == 0,
        compliance_deg_per_nm=compliance,
        free_play_deg=free_play,
        output_pin_count=output_pin_count,
    )


def law_of_twist(
    twist: Callable[[Floats], Floats], largest_torque_nm: float, compliance_deg_per_nm: float
) -> ElasticLaw:
    """Elastic law of a function, made to rise everywhere.

    The points lie closer towards zero; beyond three times the largest torque the law goes on
    straight. A stretch where the twist would fall with growing torque is taken as rigid.

    Parameters
    ----------
    twist : callable
        From torques [N m] to the twist beyond the dead zone [deg].
    largest_torque_nm : float
        Largest torque of the programme [N m].
    compliance_deg_per_nm : float
        Usual slope, of which a thousandth is the least [deg/(N m)].

    Returns
    -------
    ElasticLaw
    """
    half = 3.0 * max(largest_torque_nm, 1e-9) * np.geomspace(1e-5, 1.0, LAW_POINTS)
    twists = twist(np.r_[-half[::-1], half])
    # Of a drive without compliance neighbouring twists would be the same number.
    told_apart = 1e-9 * float(np.abs(twists).max()) / half[0]
    least = max(1e-3 * compliance_deg_per_nm, told_apart)
    upper = np.maximum.accumulate(np.r_[0.0, twists[LAW_POINTS:]] - least * np.r_[0.0, half])
    lower = np.maximum.accumulate(np.r_[0.0, -twists[:LAW_POINTS][::-1]] - least * np.r_[0.0, half])
    upper, lower = upper + least * np.r_[0.0, half], lower + least * np.r_[0.0, half]
    torque = np.r_[-half[::-1], 0.0, half]
    return ElasticLaw(torque, np.r_[-lower[:0:-1], upper], compliance_deg_per_nm)
