"""Coulomb friction with presliding: a loop of constant width."""

from cyclosweep.simulation.effects.base import Parameter, Shape
from cyclosweep.simulation.effects.slip import FrictionEffect


class FrictionHysteresis(FrictionEffect):
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

    def friction_limits(self, shape: Shape) -> tuple[float, float]:
        """The amplitude is the limit, whatever the load."""
        return 1.0, 0.0

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Friction torque at the measured shaft."""
        return (Parameter("friction_torque_nm", "N m", "Coulomb friction torque", 0.0),)
