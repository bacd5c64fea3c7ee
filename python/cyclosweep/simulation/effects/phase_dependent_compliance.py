"""Pulsation of the active pins: the compliance depends on the mesh position."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.base import Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.mesh_range import locked_orders, turned_orders
from cyclosweep.simulation.effects.order_names import (
    LOAD_POWER,
    ORDER,
    RATIO,
    REFERENCE,
    WHOLE_ORDER,
    order_amplitudes,
    order_shapes,
)
from cyclosweep.simulation.effects.orders import MeshPeriodic, harmonics

PRELOADED = 0.05
"""Share of the reference load below which a pulsation is in proportion to the load, so that the
compliance is finite without load."""
POWERS = (0.3, 1.0)
"""Least and largest power of the load."""
LEAST_REFERENCE_NM = 1e-6
"""Least reference load [N m]."""


class PhaseDependentCompliance(MeshPeriodic):
    """Compliance periodic in the mesh position: orders 1-4 or 1-6, and those of the output pins.

    It multiplies the twist of all elastic parts that carry what friction leaves, a stiffening or a
    side load among them. Orders 5 and 6 where it was locked at 11 or 13 positions, up to 12 where
    the shaft was turned under load past many positions, orders 1 to 3 where it travels from
    recorded positions, any order where none was recorded. With `load_power` it grows with another
    power of the load, as where contacts alone pulsate that stiffen under load, and the rest of the
    compliance does not; below a twentieth of `reference_nm` it grows in proportion to it, as
    contacts that are preloaded.
    """

    name = "phase_dependent_compliance"
    physics = (
        "The number of output pins that carry load changes as the mesh zone travels, and the "
        "compliance pulsates with it. Uneven pins and holes add the low orders."
    )
    source = "Kumar et al. 2016, section 4 (map of active pins); McIver's claim in section 5"
    tell_tale = "slope differs by crank position; orders 1-6, N_OP and 2 N_OP"
    family = "position"
    shape_parameters = (
        *MeshPeriodic.shape_parameters,
        Parameter(LOAD_POWER, "", "power of the load", *POWERS),
    )
    forms = (
        ShapeForm(optional=(LOAD_POWER, REFERENCE), numbered=WHOLE_ORDER),
        ShapeForm((RATIO,), (LOAD_POWER, REFERENCE), WHOLE_ORDER),
        ShapeForm((RATIO,), (LOAD_POWER, REFERENCE), ORDER),
    )

    def known_shape(self, shape: Shape) -> Shape:
        """Refuse a power beyond its bounds, or without its reference; see `MeshPeriodic`.

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
            As there, or only one of `load_power` and `reference_nm` is stated, or the former is
            beyond its bounds, or the latter is not above zero.
        """
        if (LOAD_POWER in shape) != (REFERENCE in shape):
            raise InputError(
                f"shape: found {' '.join(shape)}, expected {LOAD_POWER} with {REFERENCE}"
            )
        if not POWERS[0] <= shape.get(LOAD_POWER, 1.0) <= POWERS[1]:
            least, most = POWERS
            raise InputError(
                f"{LOAD_POWER}: found {shape[LOAD_POWER]:g}, expected {least:g} to {most:g}"
            )
        if not shape.get(REFERENCE, 1.0) >= LEAST_REFERENCE_NM:
            raise InputError(f"{REFERENCE}: found {shape[REFERENCE]:g}, expected a load above zero")
        return super().known_shape(shape)

    def locked_shapes(self, history: History) -> Sequence[Shape]:
        """Single orders, the low ones together, and the pin orders."""
        pins = history.output_pin_count
        locked = locked_orders(history)
        single = (*locked, *turned_orders(history, above=locked[-1]))
        sets: list[tuple[int, ...]] = [
            (order,) for order in single if order not in (pins, 2 * pins)
        ]
        sets += [(pins,), (2 * pins,), (1, 2), (2, 4), (1, 2, 3)]
        return order_shapes([*sets, (1, 2, 3, 4), (pins, 2 * pins), (2, 4, pins)])

    def largest(self, history: History) -> float:
        """A third of the compliance."""
        return 0.3 * history.compliance_deg_per_nm

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist for unit amplitudes of the compliance [deg]."""
        torque = history.line_equivalent_nm
        if LOAD_POWER in shape:
            share = np.maximum(np.abs(torque) / shape[REFERENCE], PRELOADED)
            torque = torque * share ** (shape[LOAD_POWER] - 1.0)
        return torque[:, None] * harmonics(history, shape)

    def refinements(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Pulsation that grows with another power of the load; see `Effect.refinements`."""
        if LOAD_POWER in shape:
            return []
        return [{LOAD_POWER: 0.8, REFERENCE: history.largest_torque_nm, **shape}]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Amplitudes of the compliance."""
        return order_amplitudes(shape, "compliance", "deg/(N m)")
