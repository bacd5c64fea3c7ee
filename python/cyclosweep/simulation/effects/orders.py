"""Harmonics of the mesh position, shared by the effects that are periodic in it."""

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, listed
from cyclosweep.simulation.effects.history import Floats, History


def distinct_positions(history: History) -> int:
    """Count the positions of the mesh zone in a recording, to a tenth of a degree."""
    if history.crank_deg is None:
        return 0
    return len(np.unique(np.round(history.crank_deg % 360.0, 1)))


def harmonics(history: History, shape: Shape) -> Floats:
    """Cosine and sine of every order in the shape, one pair of columns an order.

    Parameters
    ----------
    history : History
        Load history with the position of the mesh zone at each sample.
    shape : mapping of str to float
        The orders [1], by name.

    Returns
    -------
    ndarray, shape (n, 2 orders)
    """
    assert history.crank_deg is not None
    angle = np.radians(history.crank_deg)
    return np.column_stack(
        [wave(order * angle) for order in shape.values() for wave in (np.cos, np.sin)]
    )


def order_shapes(sets: list[tuple[int, ...]]) -> list[Shape]:
    """Shapes that name their orders."""
    return [{f"order_{k}": float(m) for k, m in enumerate(orders, 1)} for orders in sets]


def order_amplitudes(shape: Shape, what: str, unit: str) -> tuple[Parameter, ...]:
    """One cosine and one sine amplitude an order.

    Parameters
    ----------
    shape : mapping of str to float
        The orders [1], by name.
    what : str
        What the amplitude is of, for its meaning.
    unit : str
        Unit of the amplitude.

    Returns
    -------
    tuple of Parameter
    """
    return tuple(
        Parameter(f"{wave}_{int(order)}", unit, f"{what}, {wave} of order {int(order)}")
        for order in shape.values()
        for wave in ("cos", "sin")
    )


class MeshPeriodic(Effect):
    """An effect that is periodic in the position of the mesh zone."""

    needs = ("crank_deg",)
    shown_by = "runs at three or more recorded mesh positions"
    forms = (ShapeForm(numbered="order_{}"),)

    def largest(self, history: History) -> float:
        """Size that the first order may well have, in the unit of the amplitudes."""
        raise NotImplementedError

    def expected(self, history: History, shape: Shape) -> Floats:
        """Amplitudes that fall with the square of the order, as those of smooth shapes do.

        A few positions leave combinations of orders open, which would swing between them.
        """
        orders = np.array([order for order in shape.values() for _ in range(2)])
        # The orders of the pins are no harmonics of a turn but first orders of their own.
        pins = history.output_pin_count
        own = np.where(orders % pins == 0, orders / pins, orders)
        return np.asarray(self.largest(history) / own**2)

    def untestable(self, history: History) -> str | None:
        """Need at least three positions."""
        reason = super().untestable(history)
        if reason is None and distinct_positions(history) < 3:
            reason = "the mesh zone stood at fewer than three positions"
        return reason

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Orders of both."""
        return listed("order_{}", [*shape.values(), *found.values()])
