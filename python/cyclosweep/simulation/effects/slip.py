"""Friction on slip elements: how it is distributed, started, limited and solved in the angle."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.conditioning import CONDITIONING, MOST_CONDITIONING
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.slip_elements import (
    ELEMENTS,
    Elements,
    elements_of,
    spread_elements,
)
from cyclosweep.simulation.effects.slip_path import (
    BY_READING,
    SlipPath,
    between_and_by_reading,
    check_flag,
    slip_state,
    solve_slip,
)
from cyclosweep.simulation.effects.slip_start import (
    STATES,
    crossed_play,
    lies_behind_play,
    start_of,
)

__all__ = [
    "ELEMENTS",
    "SLIP_FORMS",
    "SLIP_PARAMETERS",
    "Elements",
    "Friction",
    "FrictionEffect",
    "SlipPath",
    "elements_of",
    "friction_limit_nm",
    "on_shared_elements",
    "slip_shapes",
    "slip_state",
    "solve_slip",
    "spread_elements",
    "start_of",
    "stretch_of",
]

LOAD_POWER = "load_power"
MOST_POWER = 1.0
"""Largest power by which the ratio of limit and load grows with the load."""
SLIP_PARAMETERS = (
    Parameter("slip_deg", "deg", "median presliding distance", 1e-6, 1e3, logarithmic=True),
    Parameter("scatter", "", "spread of the presliding distances (sd of log)", 0.05, 3.0, True),
    Parameter("skew", "", "1: a power law up to a longest distance, 0: lognormal", -1.0, 1.0),
    Parameter("forgetting", "", "0: turning points are remembered, 1: Dahl's law", 0.0, 1.0),
    Parameter("growth", "", "power by which presliding distances grow with the limit", 0.0, 1.0),
    Parameter(
        LOAD_POWER, "", "power by which friction over load grows with the load", -1.0, MOST_POWER
    ),
    Parameter(
        CONDITIONING,
        "N m",
        "load to and fro before a run; above zero: it was left from that side",
        -1e6,
        1e6,
    ),
)
MOST_BENT = 4.0
"""Load over `reference_nm` up to which the ratio of limit and load changes with the load."""
OPTIONAL = ("skew", "slack", "forgetting", "behind_play", CONDITIONING, BY_READING)
BEHIND_PLAY_PENALTY = 1.0
"""Log prior odds against friction behind the play [nat]."""
LEAST_UNLOADED = 0.02
"""Unloading, as a share of the largest torque, below which no friction shows. The usual tolerance
is one percent of the twist; a friction worth that is reversed only after twice its torque."""
SLIP_FORMS = (
    ShapeForm(("slip_deg", "scatter"), OPTIONAL),
    ShapeForm(("slip_deg", "scatter", "growth", "reference_nm"), (*OPTIONAL, LOAD_POWER)),
    ShapeForm(("slip_deg", "scatter", LOAD_POWER, "reference_nm"), OPTIONAL),
)


def friction_limit_nm(shape: Shape, limits: tuple[float, float], load_nm: Floats | float) -> Floats:
    """Limit of a friction under a load.

    It grows in proportion to the load, or with `load_power` as ``T ((1 + T/T0) / 2)^p`` where
    ``T0`` is `reference_nm`: -1 saturates, 1 bends upwards. Beyond four times ``T0`` it goes on in
    proportion to the load.

    Parameters
    ----------
    shape : mapping
        Shape of the friction.
    limits : tuple of float
        Friction limit without load [N m], and over the transmitted torque at `reference_nm`.
    load_nm : float or ndarray, shape (n,)
        Size of the transmitted torque [N m].

    Returns
    -------
    ndarray, shape (n,)
        In N m.
    """
    plain, loaded = limits
    growing = loaded * np.asarray(load_nm)
    power = float(shape.get(LOAD_POWER, 0.0))
    if power != 0.0:
        relative = np.minimum(load_nm / float(shape["reference_nm"]), MOST_BENT)
        growing = growing * (0.5 * (1.0 + relative)) ** power
    return np.asarray(plain + growing)


def stretch_of(history: History, shape: Shape, limits: tuple[float, float]) -> Floats:
    """How much longer than given the presliding distances are at each sample.

    With `growth` 0 they do not depend on the load, as where more asperities touch under load; with
    1 they grow with the friction limit, as for a contact of constant stiffness, and hold at the
    transmitted torque `reference_nm`.

    Parameters
    ----------
    history : History
        Load history of n samples.
    shape : mapping
        Shape of a friction, perhaps with ``growth`` and ``reference_nm`` [N m].
    limits : tuple of float
        Friction limit without load [N m], and in proportion to the transmitted torque.

    Returns
    -------
    ndarray, shape (n,)
        Factor on the presliding distances.
    """
    growth = float(shape.get("growth", 0.0))
    if growth == 0.0:
        return np.ones(len(history))
    plain, loaded = limits
    at_reference = plain + loaded * float(shape["reference_nm"])
    ratio = friction_limit_nm(shape, limits, history.load_nm) / at_reference
    return np.asarray(np.maximum(ratio, 1e-9) ** growth)


def slip_shapes(history: History) -> list[Shape]:
    """Presliding distances from a five-hundredth to a fifth of the elastic twist."""
    twist = history.largest_twist_deg
    states = STATES if history.free_play_deg > 0 else STATES[:1]
    return [
        {"slip_deg": share * twist, "scatter": scatter, "skew": 0.0, **state}
        for share in (0.002, 0.01, 0.03, 0.08, 0.2)
        for scatter in (0.4, 1.2)
        for state in states
    ]


class FrictionEffect(Effect):
    """Friction torque on slip elements, for effects to derive from.

    A subclass says how the friction limit depends on the load by `friction_limits`, and may give
    slip elements of its own by `slip_elements`; then it states its own shape parameters, too.
    """

    family = "hysteresis"
    shown_by = "loading and unloading"
    shape_parameters: ClassVar[tuple[Parameter, ...]] = SLIP_PARAMETERS
    forms: ClassVar[tuple[ShapeForm, ...]] = SLIP_FORMS
    slips = True

    def unbounded(self, history: History) -> str | None:
        """Need unloading: of loading alone, the line takes up a friction that slips."""
        load = history.side * history.applied_nm
        begins = history.restart | np.r_[True, np.diff(history.side) != 0]
        # Lifted by more than the range of the torque each time that a flank is loaded anew.
        lift = 4.0 * history.largest_torque_nm * np.cumsum(begins)
        unloaded = np.maximum.accumulate(load + lift) - lift - load
        if np.max(unloaded) < LEAST_UNLOADED * history.largest_torque_nm:
            return (
                "no flank was unloaded by more than a fiftieth of the largest torque, so that the "
                "calibration takes up what friction does"
            )
        return super().unbounded(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Presliding distances and scatters; see `slip_shapes`."""
        return slip_shapes(history)

    def variants(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Friction that turns between readings, and at them, where the load has corners."""
        if not len(history.corners) or self.shape_parameters != SLIP_PARAMETERS:
            return [shape]
        return between_and_by_reading(shape)

    def refinements(self, history: History, shape: Shape) -> Sequence[Shape]:
        """A limit that is no line of the load, as where contacts join or carry no more."""
        own = self.shape_parameters != SLIP_PARAMETERS
        if own or LOAD_POWER in shape or self.friction_limits(shape)[1] <= 0.0:
            return []
        return [{"reference_nm": 0.5 * history.largest_torque_nm, **shape, LOAD_POWER: 0.0}]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep presliding distances and conditioning to what a recording of this twist can show."""
        if parameter.name == CONDITIONING:
            most = MOST_CONDITIONING * history.largest_torque_nm
            return replace(parameter, lower=-most, upper=most)
        if parameter.name != "slip_deg":
            return super().shape_bounds(parameter, history)
        twist = history.largest_twist_deg
        return replace(parameter, lower=5e-4 * twist, upper=0.6 * twist)

    def amplitude_bounds(self, history: History, shape: Shape) -> tuple[Parameter, ...]:
        """Keep a limit that grows with another power of the load from holding all of it.

        See `Effect.amplitude_bounds` for the parameters.
        """
        bounds = super().amplitude_bounds(history, shape)
        if LOAD_POWER not in shape or self.friction_limits(shape)[1] <= 0.0:
            return bounds
        relative = history.largest_torque_nm / float(shape["reference_nm"])
        steepest = (0.5 * (1.0 + relative)) ** MOST_POWER
        steepest *= 1.0 + MOST_POWER * relative / (1.0 + relative)
        return tuple(replace(each, upper=each.upper / steepest) for each in bounds)

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist taken away by a friction of unit amplitude [deg]."""
        limits = self.friction_limits(shape)
        stretch = stretch_of(history, shape, limits)
        state = slip_state(history, shape, stretch, self.slip_elements(shape))
        limit = friction_limit_nm(shape, limits, history.load_nm)
        return np.asarray(-history.compliance_deg_per_nm * limit * state)[:, None]

    def known_shape(self, shape: Shape) -> Shape:
        """Refuse a place that is none, or that leaves no state to start in; see `Effect`.

        Parameters
        ----------
        shape : mapping
            Shape parameters by name, in any order.

        Returns
        -------
        mapping

        Raises
        ------
        InputError
            A shape parameter is unknown or missing, or these two contradict each other.
        """
        behind = check_flag(shape, "behind_play")
        check_flag(shape, BY_READING)
        if behind and "slack" in shape:
            raise InputError("slack: found beside behind_play, expected one of the two")
        return super().known_shape(shape)

    def penalty(self, shape: Shape) -> float:
        """Friction behind the play is less usual: loops that cross zero slipping do not tell."""
        return BEHIND_PLAY_PENALTY if lies_behind_play(shape) else 0.0

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Shape of elements that may forget their turning points, which no search offers."""
        if self.shape_parameters != SLIP_PARAMETERS or "forgetting" in shape:
            return None
        return {**shape, "forgetting": 0.3}

    def far_apart(self, shape: Shape, other: Shape) -> bool:
        """Whether presliding distances, or the starts, are worth a second start of a fit."""
        if any(shape.get(name) != other.get(name) for name in ("slack", "behind_play")):
            return True
        distances = [p.name for p in self.shape_parameters if p.unit == "deg" and p.logarithmic]
        return any(not 0.5 < shape[name] / other[name] < 2.0 for name in distances)

    def usual_start(
        self, history: History, limit_share: float, slip_share: float
    ) -> tuple[Shape, float] | None:
        """Friction is what whole loops usually show.

        See `Effect.usual_start` for the parameters.
        """
        if self.shape_parameters != SLIP_PARAMETERS:
            return None
        top = history.largest_torque_nm
        shape = {
            "slip_deg": slip_share * history.largest_twist_deg, "scatter": 1.0, "skew": 0.0,
            "slack": 0.0, "growth": 0.7, "reference_nm": 0.3 * top,
        }  # fmt: skip
        plain, loaded = self.friction_limits(shape)
        return shape, limit_share * top / plain if plain > 0 else 0.2 / loaded


@dataclass(frozen=True)
class Friction:
    """All friction of a model: one set of slip elements, and what limits it together.

    Attributes
    ----------
    shape : mapping
        Shape of the first friction, by which all start and stretch.
    elements : Elements
        Slip elements of the first friction, on which all act.
    limits : tuple of float
        Friction limit without load [N m], and in proportion to the transmitted torque.
    """

    shape: Shape
    elements: Elements
    limits: tuple[float, float]

    @classmethod
    def of(cls, parts: Iterable[tuple[Effect, Shape, float]]) -> Self:
        """Friction of these effects with their shapes and amplitudes, at least one."""
        parts = tuple(parts)
        first, shape, _ = parts[0]
        plain = loaded = 0.0
        for effect, own, amplitude in parts:
            limits = effect.friction_limits(own)
            plain += amplitude * limits[0]
            loaded += amplitude * limits[1]
        return cls(shape, first.slip_elements(shape), (float(plain), float(loaded)))

    def solve(
        self,
        history: History,
        offset: Floats,
        free_play: float,
        law: tuple[Floats, Floats] | None = None,
    ) -> SlipPath:
        """Angle and friction torque along the applied torque; see `solve_slip`.

        Parameters
        ----------
        history : History
            Load history of n samples with the calibrated line.
        offset : ndarray, shape (n,)
            Everything that shifts the datum [deg]; without free play the flank in contact, too.
        free_play : float
            Half width of the dead zone [deg].
        law : pair of ndarray, optional
            Elastic torques [N m] and twists [deg].

        Returns
        -------
        SlipPath
        """
        crossed: Floats | float = 0.0
        if lies_behind_play(self.shape):
            if free_play == 0.0:
                crossed = crossed_play(history, self.shape)
            free_play = 0.0
        offset = offset - crossed
        path = solve_slip(history, self.shape, offset, self.limits, free_play, law, self.elements)
        return replace(path, angle_deg=path.angle_deg + crossed)

    def torque_nm(self, history: History) -> Floats:
        """Friction torque along the path of a history, shape (n,) [N m]."""
        stretch = stretch_of(history, self.shape, self.limits)
        state = slip_state(history, self.shape, stretch, self.elements)
        limit = friction_limit_nm(self.shape, self.limits, np.abs(history.elastic_nm))
        return np.asarray(limit * state)


def on_shared_elements(
    effects: Sequence[Effect | None], shapes: Sequence[dict[str, float]]
) -> list[dict[str, float]]:
    """Shapes of a structure with all friction on the slip elements of the first.

    Parameters
    ----------
    effects : sequence of Effect or None
        Effects of the structure; None for what is no effect.
    shapes : sequence of dict
        Their shapes.

    Returns
    -------
    list of dict
        Friction whose shape has the same parameters as that of the first takes its values.
    """
    out = list(shapes)
    first: int | None = None
    for k, effect in enumerate(effects):
        if effect is None or not effect.slips:
            continue
        if first is None:
            first = k
            continue
        leader = effects[first]
        if leader is not None and leader.shape_parameters == effect.shape_parameters:
            out[k] = dict(shapes[first])
    return out
