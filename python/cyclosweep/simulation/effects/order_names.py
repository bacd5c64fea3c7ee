"""Shapes of the effects that are periodic in the position of the mesh: orders by name."""

from collections.abc import Sequence

from cyclosweep.simulation.effects.base import Parameter, Shape

RATIO = "travel_ratio"
"""Shape parameter: turns of the mesh zone a turn of the measured shaft. A shape without it depends
on the locking position alone."""
WHOLE_ORDER = "order_{}"
"""Name of each order of a position that is counted from a recorded one: a whole number."""
ORDER = "travel_order_{}"
"""Name of each order of the position of a travelling mesh that was not recorded."""
LOAD_POWER = "load_power"
"""Shape parameter: power of the load with which the effect grows, where that is not one."""
REFERENCE = "reference_nm"
"""Torque [N m] of the straight line at which an effect with `LOAD_POWER` is as large as without."""
_BESIDE = (RATIO, LOAD_POWER, REFERENCE)
"""Shape parameters that are no orders."""


def from_recorded_position(shape: Shape) -> bool:
    """Whether a shape counts the position from recorded ones, so that its orders are whole."""
    return WHOLE_ORDER.format(1) in shape


def travels(shape: Shape) -> bool:
    """Whether a shape goes with the travel of the mesh, so that twist and position interact."""
    return RATIO in shape


def orders_of(shape: Shape) -> tuple[float, ...]:
    """Orders of a shape, of any of the three kinds."""
    return tuple(value for name, value in shape.items() if name not in _BESIDE)


def travelling_shape(ratio: float, orders: Sequence[float]) -> Shape:
    """Shape that goes with the travel of a mesh of which no position was recorded.

    Parameters
    ----------
    ratio : float
        Turns of the mesh zone a turn of the measured shaft.
    orders : sequence of float
        Orders of the position.

    Returns
    -------
    mapping
    """
    return {RATIO: ratio, **numbered(ORDER, orders)}


def numbered(name: str, orders: Sequence[float]) -> dict[str, float]:
    """Orders by name.

    Parameters
    ----------
    name : str
        Pattern of the names, `WHOLE_ORDER` or `ORDER`.
    orders : sequence of float
        Orders of the position.

    Returns
    -------
    dict of str to float
    """
    return {name.format(k): float(order) for k, order in enumerate(orders, 1)}


def order_shapes(sets: list[tuple[int, ...]]) -> list[Shape]:
    """Shapes that name their orders."""
    return [numbered(WHOLE_ORDER, orders) for orders in sets]


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
    if not from_recorded_position(shape):
        return tuple(
            Parameter(f"{wave}_{place}", unit, f"{what}, {wave} of travel order {place}")
            for place in range(1, 1 + len(orders_of(shape)))
            for wave in ("cos", "sin")
        )
    return tuple(
        Parameter(f"{wave}_{int(order)}", unit, f"{what}, {wave} of order {int(order)}")
        for order in orders_of(shape)
        for wave in ("cos", "sin")
    )


def beside_orders(shape: Shape) -> dict[str, float]:
    """Values of a shape that are no orders, by name."""
    return {name: shape[name] for name in _BESIDE if name in shape}
