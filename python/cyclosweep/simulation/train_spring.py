"""The spring of a calibrated model in a torsional train: elastic law, play, friction, drag."""

from __future__ import annotations

import math

import numpy as np

from cyclosweep.dynamics.spring import SlipElement, TrainSpring
from cyclosweep.simulation.effects.slip import Friction
from cyclosweep.simulation.elastic_law import CalibratedLine, elastic_law

__all__ = ["drag_time_s", "spring_of"]


def spring_of(model: CalibratedLine, largest_torque_nm: float) -> TrainSpring:
    """Spring of a model at the shaft to which it belongs.

    Elastic effects bend the law point by point; friction becomes slip elements in parallel. Their
    limits without load and under it are the model's, the latter in proportion to the load as at the
    model's `reference_nm` (`load_power` is left out). They remember their turning points
    (`forgetting` is left out), and their stiffness is constant: the one that they have at the
    torque for which the model states its presliding distances, or at half of the largest torque
    where it states none. Friction behind the play is taken as if it slid through it.

    Parameters
    ----------
    model : CalibratedLine
        Line and effects.
    largest_torque_nm : float
        Largest torque that the law has to hold for [N m]; beyond three times it goes on straight.

    Returns
    -------
    TrainSpring
        Twists from the middle of the play.
    """
    sliding = [value for value in model.effects if value.effect.slips]
    friction: list[SlipElement] = []
    if sliding:
        of = Friction.of((v.effect, v.shape, v.amplitudes[0]) for v in sliding)
        plain, loaded = of.limits
        reference = float(of.shape.get("reference_nm", 0.5 * largest_torque_nm))
        limit = plain + loaded * reference
        for distance, share in zip(of.elements.slip_deg, of.elements.share, strict=True):
            stiffness = float(share) * limit / math.radians(float(distance))
            if stiffness > 0:
                friction.append(SlipElement(stiffness, float(share) * plain, float(share) * loaded))
    play = math.radians(model.free_play_deg)
    law = elastic_law(model, largest_torque_nm)
    if law is None:
        stiffness = 1.0 / math.radians(model.compliance_deg_per_nm)
        return TrainSpring.linear(stiffness, play, friction)
    beyond = np.radians(law.twist_deg)
    middle = len(beyond) // 2
    if play == 0:
        return TrainSpring.through_points(beyond, law.torque_nm, friction)
    twist = np.r_[beyond[:middle] - play, -play, play, beyond[middle + 1 :] + play]
    torque = np.r_[law.torque_nm[:middle], 0.0, 0.0, law.torque_nm[middle + 1 :]]
    return TrainSpring.through_points(twist, torque, friction)


def drag_time_s(model: CalibratedLine) -> float:
    """Time constant of a model's drag against its stiffness.

    Parameters
    ----------
    model : CalibratedLine
        Line and effects.

    Returns
    -------
    float
        Drag times compliance [s]; zero without drag.
    """
    return float(sum(v.shape.get("lag_s", 0.0) for v in model.effects if v.name == "viscous_drag"))
