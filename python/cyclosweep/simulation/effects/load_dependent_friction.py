"""Friction in proportion to the transmitted torque: a loop that opens with load."""

from collections.abc import Sequence

from cyclosweep.simulation.effects.base import Parameter, Shape
from cyclosweep.simulation.effects.history import History
from cyclosweep.simulation.effects.slip import FrictionEffect


class LoadDependentFriction(FrictionEffect):
    """Friction whose limit grows with the transmitted torque, ``mu |T_e|``.

    With `load_power` it grows with another power of the load, see `slip.friction_limit_nm`.
    """

    name = "load_dependent_friction"
    physics = (
        "The normal forces of mesh and pins grow with the transmitted torque, and the friction "
        "limit with them. The contacts slide as in Coulomb friction."
    )
    source = "Volbeda, MSc thesis 2024 (measured 13:1 drive); Al-Bender et al. 2005"
    tell_tale = "loop that opens with load"
    shown_by = "loading and unloading to several amplitudes"

    def variants(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Presliding distances that do not depend on the load, and ones that grow with it."""
        middle = 0.5 * history.largest_torque_nm
        grown = {**shape, "growth": 1.0, "reference_nm": middle}
        return [*super().variants(history, shape), *super().variants(history, grown)]

    def friction_limits(self, shape: Shape) -> tuple[float, float]:
        """The amplitude is a share of the transmitted torque."""
        return 0.0, 1.0

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Friction torque as a share of the transmitted torque."""
        return (Parameter("friction_share", "", "friction over transmitted torque", 0.0, 0.9),)
