"""Pulsation of the active pins: the compliance depends on the mesh position."""

from collections.abc import Sequence

from cyclosweep.simulation.effects.base import Parameter, Shape
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.orders import (
    MeshPeriodic,
    harmonics,
    order_amplitudes,
    order_shapes,
)


class PhaseDependentCompliance(MeshPeriodic):
    """Compliance periodic in the mesh position: orders 1-4, and those of the output pins.

    Orders 1 to 3 where it travels from recorded positions, any order where none was recorded.
    """

    name = "phase_dependent_compliance"
    physics = (
        "The number of output pins that carry load changes as the mesh zone travels, and the "
        "compliance pulsates with it. Uneven pins and holes add the low orders."
    )
    source = "Kumar et al. 2016, section 4 (map of active pins); McIver's claim in section 5"
    tell_tale = "slope differs by crank position; orders 1-4, N_OP and 2 N_OP"
    family = "position"

    def locked_shapes(self, history: History) -> Sequence[Shape]:
        """Single orders, the low ones together, and the pin orders."""
        pins = history.output_pin_count
        sets = [(1,), (2,), (3,), (4,), (pins,), (2 * pins,), (1, 2), (2, 4), (1, 2, 3)]
        return order_shapes([*sets, (1, 2, 3, 4), (pins, 2 * pins), (2, 4, pins)])

    def largest(self, history: History) -> float:
        """A third of the compliance."""
        return 0.3 * history.compliance_deg_per_nm

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist for unit amplitudes of the compliance [deg]."""
        return history.elastic_nm[:, None] * harmonics(history, shape)

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Amplitudes of the compliance."""
        return order_amplitudes(shape, "compliance", "deg/(N m)")
