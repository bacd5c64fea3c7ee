"""Physics that the published model leaves out: thirteen effects, and users' own."""

from cyclosweep.errors import InputError, did_you_mean
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape
from cyclosweep.simulation.effects.clearance_takeup import ClearanceTakeup
from cyclosweep.simulation.effects.contact_stiffening import ContactStiffening
from cyclosweep.simulation.effects.creep import Creep
from cyclosweep.simulation.effects.datum_drift import DatumDrift
from cyclosweep.simulation.effects.dial_eccentricity import DialEccentricity
from cyclosweep.simulation.effects.friction_hysteresis import FrictionHysteresis
from cyclosweep.simulation.effects.history import History
from cyclosweep.simulation.effects.load_asymmetry import LoadAsymmetry
from cyclosweep.simulation.effects.load_dependent_friction import LoadDependentFriction
from cyclosweep.simulation.effects.overload_softening import OverloadSoftening
from cyclosweep.simulation.effects.phase_dependent_compliance import PhaseDependentCompliance
from cyclosweep.simulation.effects.thermal_drift import ThermalDrift
from cyclosweep.simulation.effects.transmission_error import TransmissionError
from cyclosweep.simulation.effects.viscous_drag import ViscousDrag

__all__ = ["VOCABULARY", "Effect", "History", "Parameter", "Shape", "effects", "find", "register"]

VOCABULARY: tuple[Effect, ...] = (
    FrictionHysteresis(),
    LoadDependentFriction(),
    ContactStiffening(),
    ClearanceTakeup(),
    OverloadSoftening(),
    DatumDrift(),
    Creep(),
    PhaseDependentCompliance(),
    TransmissionError(),
    ThermalDrift(),
    ViscousDrag(),
    LoadAsymmetry(),
    DialEccentricity(),
)

_REGISTERED: dict[str, Effect] = {effect.name: effect for effect in VOCABULARY}


def effects() -> tuple[Effect, ...]:
    """Return the vocabulary and what users have registered, in that order."""
    return tuple(_REGISTERED.values())


def find(name: str) -> Effect:
    """Return the effect of this name.

    Raises
    ------
    InputError
        No effect of this name is registered.
    """
    if name not in _REGISTERED:
        known = ", ".join(_REGISTERED)
        hint = did_you_mean(name, _REGISTERED)
        raise InputError(f"effect {name!r}: expected one of {known}{hint}")
    return _REGISTERED[name]


def register(effect: Effect) -> Effect:
    """Add an effect of one's own to those that are diagnosed.

    Raises
    ------
    InputError
        It is no effect, or its name is taken.
    """
    if not isinstance(effect, Effect):
        found = f"the class {effect.__name__}" if isinstance(effect, type) else repr(effect)
        raise InputError(f"effect: found {found}, expected an instance of Effect")
    if effect.name in _REGISTERED:
        raise InputError(f"effect {effect.name!r} is registered already")
    _REGISTERED[effect.name] = effect
    return effect
