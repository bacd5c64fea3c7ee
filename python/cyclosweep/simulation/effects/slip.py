"""Slip elements behind both friction effects: how they are distributed, started and solved."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

import cyclosweep._core as _core
from cyclosweep.simulation.effects.base import Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History

ELEMENTS = 14
"""Number of slip elements; the response no longer depends on it beyond about ten."""


SLIP_PARAMETERS = (
    Parameter("slip_deg", "deg", "median presliding distance", 1e-6, 1e3, logarithmic=True),
    Parameter("scatter", "", "spread of the presliding distances (sd of log)", 0.05, 3.0, True),
    Parameter("skew", "", "1: a power law up to a longest distance, 0: lognormal", -1.0, 1.0),
)


SLIP_FORMS = (
    ShapeForm(("slip_deg", "scatter"), ("skew", "slack")),
    ShapeForm(("slip_deg", "scatter", "growth", "reference_nm"), ("skew", "slack")),
)


@dataclass(frozen=True, slots=True)
class Elements:
    """Presliding distances [deg] and shares of the friction limit."""

    slip_deg: Floats
    share: Floats


@lru_cache(maxsize=256)
def spread_elements(slip_deg: float, scatter: float, skew: float = 0.0) -> Elements:
    """Elements at equally probable quantiles of a distribution of presliding distances.

    Between a lognormal one (no skew) and a power law up to a longest distance, as Segalman found
    for joints (J. Appl. Mech. 72, 2005), or its mirror image down to a shortest one.
    """
    from scipy.special import ndtri

    share = (np.arange(ELEMENTS) + 0.5) / ELEMENTS
    tail = 1.0 + np.log(share) if skew > 0 else -1.0 - np.log1p(-share)
    quantile = (1.0 - abs(skew)) * ndtri(share) + abs(skew) * tail
    return Elements(slip_deg * np.exp(scatter * quantile), np.full(ELEMENTS, 1.0 / ELEMENTS))


def elements_of(shape: Shape) -> Elements:
    """Elements of a friction effect with this shape."""
    return spread_elements(
        float(shape["slip_deg"]), float(shape["scatter"]), float(shape.get("skew", 0.0))
    )


def start_of(history: History, shape: Shape) -> Floats:
    """Angle at which fresh elements are anchored.

    `slack` 0: unloaded contact on the first flank; 1: the middle of the dead zone, so that the
    elements have slipped before the flank is reached.
    """
    contact = history.start_angle_deg
    return contact - float(shape.get("slack", 0.0)) * history.side * history.free_play_deg


def stretch_of(history: History, shape: Shape, limits: tuple[float, float]) -> Floats:
    """How much longer than given the presliding distances are at each sample.

    With `growth` 0 they do not depend on the load, as where more asperities touch under load; with
    1 they grow with the friction limit, as for a contact of constant stiffness, and hold at the
    transmitted torque `reference_nm`.
    """
    growth = float(shape.get("growth", 0.0))
    if growth == 0.0:
        return np.ones(len(history))
    plain, loaded = limits
    at_reference = plain + loaded * float(shape["reference_nm"])
    ratio = (plain + loaded * history.load_nm) / at_reference
    return np.asarray(np.maximum(ratio, 1e-9) ** growth)


def slip_state(history: History, shape: Shape, stretch: Floats | None = None) -> Floats:
    """State of the elements along the model's path, between -1 and 1; see `stretch_of`."""
    elements = elements_of(shape)
    return _core.slip_state(
        history.angle_deg,
        history.restart,
        start_of(history, shape),
        np.ones(len(history)) if stretch is None else stretch,
        elements.slip_deg,
        elements.share,
    )


def solve_slip(
    history: History,
    shape: Shape,
    offset: Floats,
    limits: tuple[float, float],
    free_play: float,
    law: tuple[Floats, Floats] | None = None,
) -> tuple[Floats, Floats]:
    """Angle [deg] and friction torque [N m] along the applied torque.

    Parameters
    ----------
    offset : ndarray
        Everything that shifts the datum [deg].
    limits : tuple of float
        Friction limit without load [N m], and in proportion to the transmitted torque.
    free_play : float
        Half width of the dead zone; zero where `offset` already holds the flank in contact [deg].
    law : pair of ndarray, optional
        Elastic torques [N m] and twists [deg] of an elastic law that is no line.
    """
    elements = elements_of(shape)
    return _core.solve_slip(
        history.applied_nm,
        np.ascontiguousarray(offset),
        history.restart,
        np.ascontiguousarray(start_of(history, shape)),
        elements.slip_deg,
        elements.share,
        free_play=free_play,
        compliance=history.compliance_deg_per_nm,
        limit=limits[0],
        load_factor=limits[1],
        growth=float(shape.get("growth", 0.0)),
        reference_torque=float(shape.get("reference_nm", 1.0)),
        law_torque=None if law is None else law[0],
        law_twist=None if law is None else law[1],
    )


def slip_shapes(history: History) -> list[Shape]:
    """Presliding distances from a five-hundredth to a fifth of the elastic twist."""
    twist = history.largest_twist_deg
    slack = (0.0, 1.0) if history.free_play_deg > 0 else (0.0,)
    return [
        {"slip_deg": share * twist, "scatter": scatter, "skew": 0.0, "slack": start}
        for share in (0.002, 0.01, 0.03, 0.08, 0.2)
        for scatter in (0.4, 1.2)
        for start in slack
    ]
