"""What whole loops usually show, and the values from which a fit of it starts."""

from collections.abc import Callable

from cyclosweep.simulation.effects import Effect, Shape

USUAL: dict[str, Callable[[float], Shape]] = {
    "friction_hysteresis": lambda top: {},
    "load_dependent_friction": lambda top: {},
    "contact_stiffening": lambda top: {"turn_nm": 0.1 * top},
    "load_asymmetry": lambda top: {"power": 1.0},
}
"""What loops of this kind usually show, and the shapes to start from at a largest torque."""
STARTS = ((0.05, 0.02), (0.1, 0.02), (0.05, 0.08))
"""Friction limits and presliding distances to start from, as shares of torque and twist."""


def first_amplitude(effect: Effect, shape: Shape, limit_nm: float, compliance: float) -> float:
    """Amplitude from which an effect of these is fitted.

    Parameters
    ----------
    effect : Effect
    shape : mapping of str to float
    limit_nm : float
        Friction limit to start from [N m].
    compliance : float
        Rough compliance of the loop [deg/(N m)].

    Returns
    -------
    float
        In the unit of the effect's first amplitude.
    """
    parameter = effect.amplitudes(shape)[0]
    if effect.slips:
        return 0.2 if parameter.unit == "" else limit_nm
    return 0.3 * compliance if parameter.lower >= 0 else 1e-3
