"""Coulomb friction with presliding: a loop of constant width."""

from collections.abc import Sequence

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.slip import SLIP_FORMS, SLIP_PARAMETERS, slip_shapes, slip_state


class FrictionHysteresis(Effect):
    """Coulomb friction in mesh, bushes and bearings, with its presliding rounding.

    The friction acts on the torque: the drive is twisted by what the friction leaves of the applied
    torque, ``T_e = T - Y h(theta)``, with ``h`` the state of Maxwell-slip elements.
    """

    name = "friction_hysteresis"
    physics = (
        "Coulomb friction in mesh, bushes and bearings resists every change of twist. "
        "The contacts slide one after another, so the loop is rounded after each reversal."
    )
    source = "Al-Bender, Lampaert, Swevers, IEEE TAC 50(11), 2005, doi 10.1109/TAC.2005.858676"
    tell_tale = "loop of constant width, no rate effect"
    family = "hysteresis"
    shape_parameters = SLIP_PARAMETERS
    forms = SLIP_FORMS
    slips = True

    def shapes(self, history: History) -> Sequence[Shape]:
        """Presliding distances and scatters; see `slip_shapes`."""
        return slip_shapes(history)

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist taken away by a friction torque of 1 N m [deg]."""
        return -history.compliance_deg_per_nm * slip_state(history, shape)[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Friction torque at the measured shaft."""
        return (Parameter("friction_torque_nm", "N m", "Coulomb friction torque", 0.0),)
