"""Slip elements behind both friction effects: how they are distributed, started and solved."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

import cyclosweep._core as _core
from cyclosweep.effects.base import Parameter, Shape
from cyclosweep.effects.history import Floats, History

ELEMENTS = 14
"""Number of slip elements; the response no longer depends on it beyond about ten."""

SLIP_PARAMETERS = (
    Parameter("slip_deg", "deg", "median presliding distance", 1e-6, 1e3, logarithmic=True),
    Parameter("scatter", "", "spread of the presliding distances (sd of log)", 0.05, 3.0, True),
)


@dataclass(frozen=True, slots=True)
class Elements:
    """Presliding distances [deg] and shares of the friction limit."""

    slip_deg: Floats
    share: Floats


@lru_cache(maxsize=256)
def lognormal_elements(slip_deg: float, scatter: float) -> Elements:
    """Elements at equally probable quantiles of a lognormal distribution."""
    from scipy.special import ndtri

    quantile = ndtri((np.arange(ELEMENTS) + 0.5) / ELEMENTS)
    return Elements(slip_deg * np.exp(scatter * quantile), np.full(ELEMENTS, 1.0 / ELEMENTS))


def elements_of(shape: Shape) -> Elements:
    """Elements of a friction effect with this shape."""
    return lognormal_elements(float(shape["slip_deg"]), float(shape["scatter"]))


def start_of(history: History, shape: Shape) -> Floats:
    """Angle at which fresh elements are anchored.

    `slack` 0: unloaded contact on the first flank; 1: the middle of the dead zone, so that the
    elements have slipped before the flank is reached.
    """
    contact = history.start_angle_deg
    return contact - float(shape.get("slack", 0.0)) * history.side * history.free_play_deg


def slip_state(history: History, shape: Shape) -> Floats:
    """State of the elements along the model's path, between -1 and 1."""
    elements = elements_of(shape)
    return _core.slip_state(
        history.angle_deg,
        history.restart,
        start_of(history, shape),
        elements.slip_deg,
        elements.share,
    )


def slip_shapes(history: History) -> list[Shape]:
    """Presliding distances from a five-hundredth to a fifth of the elastic twist."""
    twist = history.largest_twist_deg
    slack = (0.0, 1.0) if history.free_play_deg > 0 else (0.0,)
    return [
        {"slip_deg": share * twist, "scatter": scatter, "slack": start}
        for share in (0.002, 0.01, 0.03, 0.08, 0.2)
        for scatter in (0.4, 1.2)
        for start in slack
    ]
