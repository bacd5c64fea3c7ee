"""Harmonics of the mesh position, shared by the effects that are periodic in it.

The position is known in one of three ways. Where the output was locked at several recorded
positions, a shape states whole orders of the locking position. An error of the gear itself travels
from there while the shaft twists: a shape then states the ratio by which it travels as well. Where
no position was recorded, the mesh still travels: a shape then states the ratio and orders of any
value, because a part of a turn does not tell neighbouring whole numbers apart.
"""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, listed
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.mesh_range import (
    LEAST_POSITIONS,
    LEAST_TRAVEL_DEG,
    load_count,
    loaded_travel_deg,
    position_count,
    travels_far_from_positions,
    whole_travel_deg,
)
from cyclosweep.simulation.effects.order_names import (
    ORDER,
    RATIO,
    WHOLE_ORDER,
    beside_orders,
    from_recorded_position,
    numbered,
    orders_of,
    travelling_shape,
    travels,
)

DIAL_ORDERS = (1.0, 2.0)
"""Cycles a turn of the measured shaft that are an error of the dial's own."""
MOST_WHOLE_ORDERS = 6
"""Most orders of recorded positions together: 1 to 4, and the two of the output pins."""
USUAL_ORDERS = 4
"""Orders up to which their number is not compared with that of the positions."""
MOST_ORDERS = 2
"""Orders up to which those found along a travel are joined. More, free to move, make any curve."""
HIGHEST_LOW_ORDER = 3
"""Orders of the position up to which they are looked for on a mesh that travels from several
recorded positions."""
FEWEST_CYCLES = 3.0
"""Cycles within the travel from which a wave is looked for. Slower ones look like a curve."""
MOST_CYCLES = 20.0
"""Cycles within the travel up to which a wave is looked for."""
FEWEST_STATES = 2 * int(MOST_CYCLES)
"""Different torques from which waves along the travel are looked for: two for each cycle. With
fewer, as with weights, waves of different orders are the same."""
CYCLE_STEP = 0.5
"""Distance of neighbouring orders that are looked for, in cycles within the whole travel, with the
play that is crossed: half of what the travel tells apart."""
SAME_ORDER = 0.25
"""Share of an order within which another one is the same."""
HARMONIC = 0.08
"""Share of an order within which a multiple of the first one is taken for its harmonic."""


def needed_columns(effect: Effect, shape: Shape) -> tuple[str, ...]:
    """Columns that a programme has to have for an effect of this shape.

    Parameters
    ----------
    effect : Effect
    shape : mapping of str to float

    Returns
    -------
    tuple of str
    """
    unrecorded = isinstance(effect, MeshPeriodic) and not from_recorded_position(shape)
    late = ("time_s",) if "delay_s" in shape else ()
    return () if unrecorded else (*effect.needs, *late)


def travel_deg(history: History) -> float:
    """Range over which the mesh travelled under load [deg]; zero where it stood at few places."""
    return loaded_travel_deg(history) if load_count(history) >= FEWEST_STATES else 0.0


def travel_shapes(history: History) -> list[Shape]:
    """Single orders of the position of a travelling mesh, from a few cycles within the travel on.

    One cycle and two a turn of the measured shaft itself are left to an eccentric or tilted dial,
    which is the same.
    """
    turns, step = travel_deg(history) / 360.0, CYCLE_STEP * 360.0 / whole_travel_deg(history)
    lowest, highest = FEWEST_CYCLES / turns, MOST_CYCLES / turns
    orders = np.linspace(lowest, highest, 1 + round((highest - lowest) / step))
    dial = np.array(DIAL_ORDERS) / history.mesh_ratio
    return [
        travelling_shape(history.mesh_ratio, [float(each)])
        for each in orders
        if np.abs(each - dial).min() > step
    ]


def harmonics(history: History, shape: Shape) -> Floats:
    """Cosine and sine of every order in the shape, one pair of columns an order.

    Parameters
    ----------
    history : History
        Load history with the position of the mesh zone at each sample.
    shape : mapping of str to float
        The orders [1], by name, and the ratio where the mesh travels.

    Returns
    -------
    ndarray, shape (n, 2 orders)
    """
    if travels(shape):
        angle = np.radians(history.mesh_deg(shape[RATIO]))
    else:
        assert history.crank_deg is not None
        angle = np.radians(history.crank_deg)
    return np.column_stack(
        [wave(order * angle) for order in orders_of(shape) for wave in (np.cos, np.sin)]
    )


def _travelling(locked: Sequence[Shape], history: History) -> list[Shape]:
    """Shapes of low orders of a locking position, as they are where the mesh travels from it.

    Parameters
    ----------
    locked : sequence of mapping
        Shapes of the locking position.
    history : History
        Load history with the position of the mesh zone at each sample.

    Returns
    -------
    list of mapping
        Those whose highest order goes through enough of a cycle on the way.
    """
    highest = [max(orders_of(shape)) for shape in locked]
    return [
        {RATIO: history.mesh_ratio, **shape}
        for shape, order in zip(locked, highest, strict=True)
        if order <= HIGHEST_LOW_ORDER and travels_far_from_positions(history, order)
    ]


def more_than_positions(history: History, shape: Shape) -> bool:
    """Whether many orders have as many free numbers as there are positions, and make any values.

    Parameters
    ----------
    history : History
        Load history of the recording.
    shape : mapping
        Shape of an effect.

    Returns
    -------
    bool
    """
    orders = orders_of(shape) if from_recorded_position(shape) else ()
    return len(orders) > USUAL_ORDERS and 2 * len(orders) + 1 >= position_count(history)


class MeshPeriodic(Effect):
    """An effect that is periodic in the position of the mesh zone."""

    needs = ("crank_deg",)
    shown_by = "runs at three or more recorded mesh positions, or a sixth of a turn under load"
    forms = (
        ShapeForm(numbered=WHOLE_ORDER),
        ShapeForm((RATIO,), numbered=WHOLE_ORDER),
        ShapeForm((RATIO,), numbered=ORDER),
    )
    shape_parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(ORDER.format(1), "", "cycles a turn of the mesh zone", 1e-3, 1e4),
    )

    def largest(self, history: History) -> float:
        """Size that the first order may well have, in the unit of the amplitudes."""
        raise NotImplementedError

    def locked_shapes(self, history: History) -> Sequence[Shape]:
        """Shapes over which the effect is looked for where the mesh was locked at positions."""
        raise NotImplementedError

    def shapes(self, history: History) -> Sequence[Shape]:
        """Orders of the locking position, or of the travel where that hardly varied.

        Where the mesh was locked at several positions and travelled far from them, low orders may
        go with either: an error of the frame stays where it was locked, one of the gear travels.
        """
        if position_count(history) < LEAST_POSITIONS:
            return travel_shapes(history)
        locked = self.locked_shapes(history)
        return [*locked, *_travelling(locked, history)]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Orders that are looked for; see `Effect.shape_bounds` for what is no order.

        Parameters
        ----------
        parameter : Parameter
            One of ``shape_parameters``.
        history : History
            Load history of the recording.

        Returns
        -------
        Parameter
            The same with other bounds.
        """
        if parameter.name != ORDER.format(1):
            return super().shape_bounds(parameter, history)
        turns = max(travel_deg(history), 1e-9) / 360.0
        lower, upper = FEWEST_CYCLES / turns, MOST_CYCLES / turns
        return Parameter(parameter.name, parameter.unit, parameter.meaning, lower, upper)

    def expected(self, history: History, shape: Shape) -> Floats | None:
        """Amplitudes that fall with the square of the order, from the lowest on.

        A few positions leave combinations of orders open, which would swing between them; a single
        order has none. A wave along an unrecorded travel leaves nothing open.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.

        Returns
        -------
        ndarray, shape (k,), or None
            None for a mesh of which no position was recorded.
        """
        if not from_recorded_position(shape):
            return None
        orders = np.array([order for order in orders_of(shape) for _ in range(2)])
        # The orders of the pins are no harmonics of a turn but first orders of their own.
        pins = history.output_pin_count
        own = np.where(orders % pins == 0, orders / pins, orders)
        return np.asarray(self.largest(history) / (own / own.min()) ** 2)

    def known_shape(self, shape: Shape) -> Shape:
        """Return a shape with its parameters in order; orders of a recorded position are whole.

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
            A shape parameter is unknown or missing, or an order is no whole number above zero.
        """
        known = super().known_shape(shape)
        if not from_recorded_position(known):
            return known
        orders = orders_of(known)
        for k, value in enumerate(orders, 1):
            if value < 1.0 or value != round(value):
                name = WHOLE_ORDER.format(k)
                raise InputError(f"{name}: found {value:g}, expected a whole number above zero")
        if len(set(orders)) < len(orders):
            found = " ".join(f"{order:g}" for order in orders)
            raise InputError(f"order: found {found}, expected each order once")
        return known

    def untestable(self, history: History) -> str | None:
        """Need at least three positions, or a travel over a good part of a turn."""
        if position_count(history) >= LEAST_POSITIONS or travel_deg(history) >= LEAST_TRAVEL_DEG:
            return None
        reason = super().untestable(history) or "the mesh zone stood at fewer than three positions"
        return f"{reason}, and it travelled by {travel_deg(history):.3g} deg under load only"

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Orders of both; none where the position is known in different ways."""
        recorded = from_recorded_position(shape)
        if travels(shape) != travels(found) or recorded != from_recorded_position(found):
            return None
        if recorded:
            both = listed(WHOLE_ORDER, [*orders_of(shape), *orders_of(found)], MOST_WHOLE_ORDERS)
            return None if both is None else {**beside_orders(shape), **both}
        known, new = orders_of(shape), orders_of(found)[0]
        multiple = max(round(new / known[0]), 1) * known[0]
        if abs(multiple - new) < HARMONIC * new:
            new = multiple
        if len(known) >= MOST_ORDERS or any(abs(new - old) < SAME_ORDER * old for old in known):
            return None
        return {**beside_orders(shape), **numbered(ORDER, (*known, new))}

    def found_law(self, history: History, shape: Shape, amplitudes: Floats) -> str:
        """Orders that were found, with the phase of each.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Fitted shape.
        amplitudes : ndarray, shape (k,)
            Fitted amplitudes.

        Returns
        -------
        str
            Empty where it goes with the locking position alone.
        """
        if not travels(shape):
            return ""
        pairs = np.reshape(amplitudes, (-1, 2))
        parts = []
        for order, (cosine, sine) in zip(orders_of(shape), pairs, strict=True):
            phase = float(np.degrees(np.arctan2(sine, cosine)))
            parts.append(f"order {order:.3g} (crest at {phase / order:.3g} deg)")
        unit = "itself" if shape[RATIO] == 1 else f"of which one output turn has {shape[RATIO]:g}"
        if from_recorded_position(shape):
            return (
                "Here it goes with where the mesh was locked and how far it has travelled since, "
                f"in cycles a turn of the input {unit}: {', '.join(parts)}."
            )
        apart = 360.0 / whole_travel_deg(history)
        return (
            f"Here it goes with the travel of the mesh, in cycles a turn of the input {unit}: "
            f"{', '.join(parts)}; the travel tells orders apart that differ by {apart:.2g}. "
            "It is tied to the position of mesh and motor."
        )

    def notes(self, history: History, shape: Shape, amplitudes: Floats) -> tuple[str, ...]:
        """Where the staircase is so steep that the shaft jumps.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Fitted shape.
        amplitudes : ndarray, shape (k,)
            Fitted amplitudes.
        """
        if not travels(shape):
            return ()
        step = 1e-3
        here = self.columns(history, shape)
        ahead = history.with_state(angle_deg=history.travelled_deg + step, measured_deg=None)
        slope = (self.columns(ahead, shape) - here) @ np.asarray(amplitudes) / step
        if float(np.max(slope, initial=0.0)) < 1.0:
            return ()
        return (
            f"{self.name} is steeper than the travel itself: the shaft jumps there, and a "
            "simulation takes one of several positions at which it can stand.",
        )
