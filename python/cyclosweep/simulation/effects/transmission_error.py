"""Kinematic error of the profile: an offset that depends on the position, whatever the load."""

from collections.abc import Sequence

from cyclosweep.simulation.effects.base import Parameter, Shape
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.mesh_range import locked_orders, turned_orders
from cyclosweep.simulation.effects.order_names import order_amplitudes, order_shapes
from cyclosweep.simulation.effects.orders import MeshPeriodic, harmonics


class TransmissionError(MeshPeriodic):
    """Offset periodic in the position of the mesh zone.

    Orders 1 to 4 of a recorded position, to 5 or 6 where it was locked at 11 or 13, 1 to 3
    of that to which it has travelled since, and up to 12 where the shaft was turned under load past
    many; any order where it travels and no position was recorded.
    """

    name = "transmission_error"
    physics = (
        "Errors of profile, pitch and eccentricity turn the output by an amount that depends on "
        "where the mesh zone stands. It does not depend on the load."
    )
    source = "Blanche, Yang, Cycloid drives with machining tolerances, J. Mech. Des. 111(3), 1989"
    tell_tale = (
        "offset periodic in crank position, orders 1-6, whatever the load; a staircase along the "
        "travel"
    )
    family = "run offsets"

    def locked_shapes(self, history: History) -> Sequence[Shape]:
        """Single orders, and the first few together."""
        locked = locked_orders(history)
        turned = turned_orders(history, above=locked[-1])
        single = [(order,) for order in (*locked, *turned)]
        return order_shapes([*single, (1, 2), (2, 4), (1, 2, 3)])

    def largest(self, history: History) -> float:
        """A hundredth of the largest twist with its play."""
        return 0.01 * (history.largest_twist_deg + history.free_play_deg)

    def columns(self, history: History, shape: Shape) -> Floats:
        """Offset for unit amplitudes [deg]."""
        return harmonics(history, shape)

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Amplitudes of the offset."""
        return order_amplitudes(shape, "kinematic error", "deg")
