"""Waves of the position of the mesh that are no more than a curve, or the error of a large law.

Where the position of the mesh was not recorded, or too few of them, a wave follows the twist itself
and is one more curve of the torque, with an order and a phase that fit. And of the many waves that
are tried one fits best what the law of a large effect misses.
"""

from collections.abc import Sequence

from cyclosweep.diagnosis.hypotheses.behaviour_classes import EVEN_CURVE, ODD_CURVE
from cyclosweep.diagnosis.identify.fitting.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.laws.law_in_class import LOUD_LAW, LawCheck, withdrawn_where
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import strength_of
from cyclosweep.diagnosis.identify.structures.verdict import MOSTLY
from cyclosweep.simulation.effects.order_names import travels
from cyclosweep.simulation.effects.orders import MeshPeriodic

LEAST_WAVE = 10.0
"""Signal-to-noise ratio that a wave beside a loud effect needs, all that is fitted beside it taken
out."""


def without_faint_waves(
    search: Search, fitted: FittedStructure, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw waves of the position of the mesh that are faint beside a loud effect.

    Parameters
    ----------
    search : Search
        Search of the recording.
    fitted : FittedStructure
        The structure.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    waves = {term.name for term in fitted.terms if isinstance(term.effect, MeshPeriodic)}
    if not waves:
        return tuple(checks)
    effects = [k for k, term in enumerate(fitted.terms) if term.effect is not None]
    strength = {fitted.terms[k].name: strength_of(search, fitted, k) for k in effects}
    if max(strength.values()) < LOUD_LAW:
        return tuple(checks)
    return withdrawn_where(lambda name: name in waves and strength[name] < LEAST_WAVE, checks)


def without_waves_of_a_curve(
    calibrated: FittedStructure, fitted: FittedStructure, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw waves that the recording shows as curves, where the structure leaves too much.

    Parameters
    ----------
    calibrated : FittedStructure
        The published model fitted to the recording.
    fitted : FittedStructure
        The structure.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    # A wave leaves little of what is one, and of another curve what order and phase do not fit.
    if beyond_noise_deg(fitted) ** 2 <= (1.0 - MOSTLY) * beyond_noise_deg(calibrated) ** 2:
        return tuple(checks)
    curves = {check.name for check in checks if check.behaviour in (ODD_CURVE, EVEN_CURVE)}
    waves = {
        term.name for term in fitted.terms if term.effect is not None and travels(term.shape)
    } & curves
    return withdrawn_where(waves.__contains__, checks)
