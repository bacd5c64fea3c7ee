"""Waves along the travel of the mesh that are no more than a curve of the torque.

Where the position of the mesh was not recorded, or too few of them, a wave follows the twist itself
and is one more curve of the torque, with an order and a phase that fit.
"""

from collections.abc import Sequence

from cyclosweep.diagnosis.hypotheses.behaviour_classes import EVEN_CURVE, ODD_CURVE
from cyclosweep.diagnosis.identify.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.law_in_class import LawCheck, withdrawn_where
from cyclosweep.diagnosis.identify.verdict import MOSTLY
from cyclosweep.simulation.effects.order_names import travels


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
