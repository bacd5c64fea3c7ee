"""Shape, place and size of what is missing from the model and belongs to no listed effect."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.decide import Conclusion
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.repetition import LEAST_REPEAT, Repetition
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.identify.testability import size_left, size_of
from cyclosweep.diagnosis.locate import event_regions
from cyclosweep.diagnosis.verification import Verification
from cyclosweep.result import DriveChange, Region, Remainder
from cyclosweep.simulation.effects.history import Floats

STRONG_WAVE = 5.0
"""Log evidence from which a sinusoid in the residual is worth naming."""
STEP_QUANTILE = 0.95
"""Quantile of the residual that is given as the size of a staircase."""


def remainder(
    concluded: Conclusion, verified: Verification, regions: Sequence[Region]
) -> Remainder | None:
    """Describe what is left without a name; None where nothing is.

    Parameters
    ----------
    concluded : Conclusion
        With the best structure.
    verified : Verification
        With the drift between the runs, if there is one.
    regions : sequence of Region
        Where the calibrated model and the recording differ.

    Returns
    -------
    Remainder or None
    """
    if verified.change is not None:
        return _of_change(concluded, verified.change)
    if not verified.decision.unexplained:
        return None
    if verified.decision.best is None:
        return _of_event(concluded, regions)
    if concluded.naming.withdrawn and concluded.naming.shown:
        return no_larger_than_left(_of_class(concluded), concluded.naming.part.fit)
    if verified.drift is not None:
        return Remainder(shape="drift", place="from run to run", size_deg=verified.drift.other_deg)
    if concluded.repetition is not None:
        return _staircase(concluded.accepted, concluded.repetition)
    found = _unnamed_term(concluded.best) or _unfitted(concluded)
    return no_larger_than_left(found, concluded.accepted.fit)


def no_larger_than_left(found: Remainder, named: FittedStructure) -> Remainder:
    """Bound the size of a remainder by the largest residual of the named effects.

    Fitted jointly, a shape may be larger than what is left, as others make up for it.

    Parameters
    ----------
    found : Remainder
    named : FittedStructure
        The structure of the named effects.

    Returns
    -------
    Remainder
    """
    largest = float(np.abs(_residual_deg(named)).max())
    return replace(found, size_deg=min(found.size_deg, largest))


def _residual_deg(fitted: FittedStructure) -> Floats:
    """Measured less modelled twist of the fitted rows [deg]."""
    return np.asarray((fitted.problem.angle_deg - fitted.mean_deg)[fitted.problem.fitted])


def _of_event(concluded: Conclusion, regions: Sequence[Region]) -> Remainder | None:
    """Describe the event that is all that remains; None where there is none.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.
    regions : sequence of Region
        Where the calibrated model and the recording differ.

    Returns
    -------
    Remainder or None
    """
    if not event_regions(concluded.search.problem, concluded.accepted):
        return None
    run, size = regions[0].run, abs(regions[0].mean_residual_deg)
    return Remainder(
        shape="event of a single run",
        place="" if run is None else f"in run {run[0]}, as no other shows",
        size_deg=size,
    )


def _of_change(concluded: Conclusion, change: DriveChange) -> Remainder:
    """Describe a compliance that moved while the drive was tested.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.
    change : DriveChange
        Compliance early and late.

    Returns
    -------
    Remainder
    """
    history = concluded.accepted.fit.history
    moved = change.compliance_late_deg_per_nm - change.compliance_early_deg_per_nm
    return Remainder(
        shape="change of the drive while it was tested",
        place="at equal torque, earlier against later",
        size_deg=abs(moved) * history.largest_torque_nm,
    )


def _of_class(concluded: Conclusion) -> Remainder:
    """Describe the class of behaviour for which laws stand in that may not be named.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.

    Returns
    -------
    Remainder
    """
    fitted = concluded.accepted.fit
    gone = {check.name for check in concluded.naming.withdrawn}
    sizes = [
        float(np.max(np.abs(size_of(fitted, index))))
        for index, term in enumerate(fitted.terms)
        if term.name in gone
    ]
    size = max(sizes, default=concluded.naming.part.fit.rmse_deg)
    shape = concluded.naming.shown[0].behaviour
    return Remainder(shape=shape, place="all along", size_deg=size)


def _unnamed_term(best: Candidate) -> Remainder | None:
    """Describe the first term without a name: a free shape, or an effect like many others."""
    fitted = best.fit
    for index, term in enumerate(fitted.terms):
        if term.unnamed is not None:
            size = float(np.max(np.abs(size_of(fitted, index))))
            return Remainder(shape=term.unnamed.family, place=term.unnamed.place, size_deg=size)
    for index, (term, named) in enumerate(zip(fitted.terms, best.recognised, strict=True)):
        if not named and term.effect is not None:
            size = float(np.max(np.abs(size_of(fitted, index))))
            return Remainder(shape=term.effect.family, place="all along", size_deg=size)
    return None


def _unfitted(concluded: Conclusion) -> Remainder:
    """Describe the strongest hypothesis in the residual of the best structure.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.

    Returns
    -------
    Remainder
    """
    best = concluded.best
    excesses = best.excesses
    name = max(excesses, key=lambda key: excesses[key])
    wave = best.sinusoid[1]
    term: Term | None = None
    place = ""
    if wave is not None and wave.family == name:
        term, place = Term(None, {}, wave), wave.place
    elif name in best.scan.groups:
        signature = best.scan.library.signatures[best.scan.best_signature(name)]
        term = Term(signature.effect, signature.shape, signature.unnamed)
        place = signature.unnamed.place if signature.unnamed is not None else "all along"
    size = concluded.accepted.fit.rmse_deg if term is None else size_left(best.fit, term)
    return Remainder(shape=name, place=place, size_deg=size)


def _staircase(accepted: Candidate, repeats: Repetition) -> Remainder:
    """Describe error of the model: steps where it repeats from run to run, else no more than that.

    Parameters
    ----------
    accepted : Candidate
        Structure that was accepted.
    repeats : Repetition
        How well the residual of one run predicts that of another.

    Returns
    -------
    Remainder
    """
    fitted = accepted.fit
    left = _residual_deg(fitted)
    shape, place = "misfit of the model", "which does not repeat from run to run"
    if repeats.is_physics or repeats.order is not None:
        shape, place = "staircase tied to the position of the mesh", f"repeating {repeats.in_words}"
    elif not repeats.is_known:
        place = "all along"
    elif repeats.correlation > LEAST_REPEAT:
        place = f"which repeats only in part {repeats.in_words}"
    evidence, wave = accepted.sinusoid
    if repeats.order is not None:
        place = f"{repeats.order.in_words(fitted.problem.history.mesh_ratio)}, {place}"
    elif wave is not None and evidence > STRONG_WAVE:
        place += f", strongest {wave.place}"
    return Remainder(
        shape=shape,
        place=place,
        size_deg=float(np.quantile(np.abs(left), STEP_QUANTILE)),
    )
