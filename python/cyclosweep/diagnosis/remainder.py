"""Shape, place and size of what is missing from the model and belongs to no listed effect."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.abrupt_step import abrupt_step
from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.hypotheses.unnamed_shapes import from_place
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.repetition import LEAST_REPEAT, Repetition
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.testability import (
    recalibrated_twist,
    recalibration,
    size_left,
)
from cyclosweep.diagnosis.locate import event_regions
from cyclosweep.diagnosis.misfit import ALL_ALONG, MISFIT, at_its_place, misfit_of
from cyclosweep.diagnosis.verification import Verification
from cyclosweep.result import DriveChange, Region, Remainder
from cyclosweep.result.effects import Measure
from cyclosweep.simulation.effects.history import Floats

STRONG_WAVE = 5.0
"""Log evidence from which a sinusoid in the residual is worth naming."""
LEAST_OF_THE_REST = 0.5
"""Least height of a shape over the rms that is left beyond the noise. A lower one is less than a
quarter of its mean square."""
LARGEST: Measure = "largest twist"
"""Measure of what has a shape."""
DRIFT = "slow drift"
"""The shape whose size is how far the zero moved. Its middle is the datum that was calibrated."""


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
        Where model and recording differ.

    Returns
    -------
    Remainder or None
    """
    if verified.change is not None:
        return _of_change(concluded, verified.change)
    if not verified.decision.unexplained:
        return None
    if verified.decision.best is None:
        alone = _of_event(concluded, regions) or _strongest(concluded.accepted)
        return _as_far_as_it_moved(alone, concluded.accepted, concluded.accepted.fit)
    if concluded.naming.withdrawn and concluded.naming.shown:
        return of_the_size_left(_of_class(concluded), concluded.naming.part.fit)
    if verified.drift is not None:
        return Remainder(shape="drift", place="from run to run", size_deg=verified.drift.other_deg)
    if concluded.repetition is not None:
        found = _step(concluded.accepted.fit)
        return found or at_its_place(_staircase(concluded.accepted, concluded.repetition), regions)
    found = _unnamed_term(concluded.best) or _unfitted(concluded)
    found = at_its_place(of_the_size_left(found, concluded.accepted.fit), regions)
    return _as_far_as_it_moved(found, concluded.best, concluded.accepted.fit)


def of_the_size_left(found: Remainder, named: FittedStructure) -> Remainder:
    """Say no more of a shape than the residual holds, and nothing of one that hardly shows in it.

    Parameters
    ----------
    found : Remainder
        The shape.
    named : FittedStructure
        The structure of the named effects.

    Returns
    -------
    Remainder
        A misfit without a shape where the shape is too small to be what is left.
    """
    left, noise = named.residual_deg, named.noise.likely_spread_deg
    beyond = float(np.sqrt(max(float(np.mean(left**2)) - noise**2, 0.0)))
    if found.size_deg >= LEAST_OF_THE_REST * beyond:
        return no_larger_than_left(found, named)
    return _step(named) or misfit_of(named, MISFIT, ALL_ALONG)


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
    largest = float(np.abs(named.residual_deg).max())
    return replace(found, size_deg=min(found.size_deg, largest))


def _as_far_as_it_moved(
    found: Remainder | None, candidate: Candidate, named: FittedStructure
) -> Remainder | None:
    """Give a slow drift the distance from its lowest to its highest zero, other shapes as found.

    Parameters
    ----------
    found : Remainder or None
        The shape.
    candidate : Candidate
        The structure that holds the drift, or in whose residual it is.
    named : FittedStructure
        The structure of the named effects, whose residual holds the drift.

    Returns
    -------
    Remainder or None
    """
    if found is None or found.shape != DRIFT:
        return found
    held = [term for term in candidate.fit.terms if term.unnamed and term.unnamed.family == DRIFT]
    term = held[0] if held else _strongest_hypothesis(candidate)[1]
    if term is None:
        return found
    columns = term.columns(named.history)[named.problem.fitted]
    moved = float(np.ptp(_fitted_beside_line(named, columns)))
    return replace(found, size_deg=moved, measure=None)


def _fitted_beside_line(named: FittedStructure, columns: Floats) -> Floats:
    """Twist of columns fitted to what a structure leaves, beside a calibration.

    Parameters
    ----------
    named : FittedStructure
    columns : ndarray, shape (fitted, k)
        Columns of a shape [deg] on the fitted rows.

    Returns
    -------
    ndarray, shape (fitted,)
        In deg, with what the calibration takes up of it.
    """
    beside_line = recalibration(named)
    amplitudes = np.linalg.lstsq(beside_line(columns), beside_line(named.residual_deg), rcond=1e-6)[
        0
    ]
    return np.asarray(columns @ amplitudes)


def _of_event(concluded: Conclusion, regions: Sequence[Region]) -> Remainder | None:
    """Describe the event that is all that remains; None where there is none.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.
    regions : sequence of Region
        Where model and recording differ.

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
        float(np.max(np.abs(recalibrated_twist(fitted, index))))
        for index, term in enumerate(fitted.terms)
        if term.name in gone
    ]
    shape = concluded.naming.shown[0].behaviour
    if not sizes:
        return misfit_of(concluded.naming.part.fit, shape, ALL_ALONG)
    return Remainder(shape=shape, place=ALL_ALONG, size_deg=max(sizes), measure=LARGEST)


def _step(fitted: FittedStructure) -> Remainder | None:
    """Describe the single step of the zero that is nearly all that is left; None without one."""
    step = abrupt_step(fitted)
    if step is None:
        return None
    place = from_place(fitted.problem.history, step.row)
    return Remainder(shape="step of the angle", place=place, size_deg=abs(step.size_deg))


def _unnamed_term(best: Candidate) -> Remainder | None:
    """Describe the largest free shape, or the first effect that is like many others."""
    fitted = best.fit
    shapes = [
        Remainder(
            shape=term.unnamed.family,
            place=term.unnamed.place,
            size_deg=float(np.max(np.abs(recalibrated_twist(fitted, index)))),
            measure=LARGEST,
        )
        for index, term in enumerate(fitted.terms)
        if term.unnamed is not None
    ]
    if shapes:
        return max(shapes, key=lambda shape: shape.size_deg)
    for index, (term, named) in enumerate(zip(fitted.terms, best.recognised, strict=True)):
        if not named and term.effect is not None:
            size = float(np.max(np.abs(recalibrated_twist(fitted, index))))
            return Remainder(
                shape=term.effect.family, place=ALL_ALONG, size_deg=size, measure=LARGEST
            )
    return None


def _strongest(accepted: Candidate) -> Remainder | None:
    """Describe what is left where no structure was found; None where it is within the noise.

    Parameters
    ----------
    accepted : Candidate
        The calibrated published model.

    Returns
    -------
    Remainder or None
    """
    if not any(left > 0.0 for left in accepted.excesses.values()):
        return None
    step = _step(accepted.fit)
    if step is not None:
        return step
    name, term, place = _strongest_hypothesis(accepted)
    fitted = accepted.fit
    if term is None:
        return misfit_of(fitted, name, place)
    # Far beyond the noise, rows count less the further off they are; here all count the same.
    columns = term.columns(fitted.history)[fitted.problem.fitted]
    twist = recalibration(fitted)(_fitted_beside_line(fitted, columns))
    size = float(np.max(np.abs(twist)))
    return Remainder(shape=name, place=place, size_deg=size, measure=LARGEST)


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
    name, term, place = _strongest_hypothesis(best)
    if term is None:
        return misfit_of(concluded.accepted.fit, name, place)
    size = size_left(best.fit, term)
    return Remainder(shape=name, place=place, size_deg=size, measure=LARGEST)


def _strongest_hypothesis(candidate: Candidate) -> tuple[str, Term | None, str]:
    """What explains most of the residual of a structure.

    Parameters
    ----------
    candidate : Candidate
        The structure.

    Returns
    -------
    name : str
        Of the hypothesis.
    term : Term or None
        With its best shape; None where the recording hardly shows it.
    place : str
        Where it sits, in words.
    """
    excesses = candidate.excesses
    name = max(excesses, key=lambda key: excesses[key])
    wave = candidate.sinusoid[1]
    if wave is not None and wave.family == name:
        return name, Term(None, {}, wave), wave.place
    if name not in candidate.scan.groups:
        return name, None, ""
    signature = candidate.scan.library.signatures[candidate.scan.best_signature(name)]
    place = signature.unnamed.place if signature.unnamed is not None else ALL_ALONG
    return name, Term(signature.effect, signature.shape, signature.unnamed), place


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
    shape, place = MISFIT, "which does not repeat from run to run"
    if repeats.is_physics or repeats.order is not None:
        shape, place = "staircase tied to the position of the mesh", f"repeating {repeats.in_words}"
    elif not repeats.is_known:
        place = ALL_ALONG
    elif repeats.correlation > LEAST_REPEAT:
        place = f"which repeats only in part {repeats.in_words}"
    evidence, wave = accepted.sinusoid
    if repeats.order is not None:
        place = f"{repeats.order.in_words(fitted.problem.history.mesh_ratio)}, {place}"
    elif wave is not None and evidence > STRONG_WAVE:
        place += f", strongest {wave.place}"
    return misfit_of(fitted, shape, place)
