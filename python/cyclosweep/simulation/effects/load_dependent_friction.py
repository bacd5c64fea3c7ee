"""Friction in proportion to the transmitted torque: a loop that opens with load."""

from collections.abc import Sequence

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.slip import (
    SLIP_FORMS,
    SLIP_PARAMETERS,
    slip_shapes,
    slip_state,
    stretch_of,
)


class LoadDependentFriction(Effect):
    """Friction whose limit grows with the transmitted torque, ``mu |T_e|``."""

    name = "load_dependent_friction"
    physics = (
        "The normal forces of mesh and pins grow with the transmitted torque, and the friction "
        "limit with them. The contacts slide as in Coulomb friction."
    )
    source = "Volbeda, MSc thesis 2024 (measured 13:1 drive); Al-Bender et al. 2005"
    tell_tale = "loop that opens with load"
    family = "hysteresis"
    shape_parameters = SLIP_PARAMETERS
    forms = SLIP_FORMS
    slips = True

    def shapes(self, history: History) -> Sequence[Shape]:
        """Presliding distances and scatters; see `slip_shapes`."""
        return slip_shapes(history)

    def variants(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Presliding distances that do not depend on the load, and ones that grow with it."""
        middle = 0.5 * history.largest_torque_nm
        return [shape, {**shape, "growth": 1.0, "reference_nm": middle}]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist taken away by friction of 100 % of the transmitted torque [deg]."""
        state = slip_state(history, shape, stretch_of(history, shape, (0.0, 1.0)))
        return (-history.compliance_deg_per_nm * history.load_nm * state)[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Friction torque as a share of the transmitted torque."""
        return (Parameter("friction_share", "", "friction over transmitted torque", 0.0, 0.9),)
