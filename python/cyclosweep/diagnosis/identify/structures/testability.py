"""What a recording can show: absorbed share, smallest detectable size, and upper bounds."""

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.diagnosis.prepare.problem import line_design
from cyclosweep.result import Untestable
from cyclosweep.result.part import NORMAL_95
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Floats

PLAIN = 5.0
"""Signal-to-noise ratio of a friction that is there for certain."""
LEAST_BESIDE = 1e-6
"""Share of a column that everything fitted has to leave of it, so that it has an amplitude."""


@dataclass(frozen=True, slots=True)
class Testability:
    """How well a recording shows one effect.

    Attributes
    ----------
    name : str
    absorbed_share : float
        Share of the signature's energy that the calibration hides, for its clearest shape.
    upper95_deg : float
        95 % upper bound of its size after re-calibration [deg], over all shapes.
    estimate_deg : float
        Its best-fitting size [deg].
    smallest_detectable_deg : float
        Size found with 90 % power [deg], for its clearest shape.
    p_value : float
        Probability of as much evidence for anything when this model is all there is.
    """

    name: str
    absorbed_share: float
    upper95_deg: float
    estimate_deg: float
    smallest_detectable_deg: float
    p_value: float


ALWAYS_HIDDEN = (
    (
        "rig_compliance",
        "a compliance of the rig in series is the drive's compliance",
        "a rigid blank in place of the drive, on the same rig",
    ),
    (
        "torque_offset",
        "on straight flanks a constant error of the torque is a shift of the datum",
        "a reading of the torque sensor without load",
    ),
    (
        "torque_gain",
        "a scale error of the torque is a change of the compliance",
        "a calibrated weight on a known arm",
    ),
)
"""What the calibration hides exactly: name, reason, what would show it."""


def testability(
    search: Search, candidate: Candidate, p_of: "dict[str, float]"
) -> list[Testability]:
    """How well a recording shows each named effect beside a structure.

    Parameters
    ----------
    search : Search
    candidate : Candidate
        The structure, whose residual is looked at.
    p_of : dict of str to float
        p-value of each effect against the baseline.

    Returns
    -------
    list of Testability
        Effects that the recording can show and bound, and the structure does not have.
    """
    fitted = candidate.fit
    raw = recalibration(fitted)(search.library.columns)
    scan = candidate.scan
    out: list[Testability] = []
    passed_over = {*fitted.names, *search.library.unbounded}
    for name, members in scan.groups.items():
        if scan.library.signatures[members[0]].effect is None or name in passed_over:
            continue
        upper, estimate, detect, absorbed = 0.0, 0.0, np.inf, 1.0
        best_gain = -1.0
        for index in members:
            signature = scan.library.signatures[index]
            part = slice(signature.first, signature.stop)
            transform = scan.transform(index)
            z = transform.T @ scan.score[part]
            rows = raw[:, part] @ transform
            spreads = np.sqrt(np.sum(rows**2, axis=1))
            shape = rows @ z
            if np.any(signature.signs * (transform @ z) < 0):
                z, shape = 0.0 * z, 0.0 * shape
            peak = float(np.max(np.abs(shape)))
            upper = max(upper, float(np.max(np.abs(shape) + 1.645 * spreads)))
            gain = float(z @ z)
            if gain > best_gain:
                best_gain, estimate = gain, peak
            need = np.sqrt(2.0 * search.threshold) + 1.28
            detect = min(detect, float(spreads.max()) * need / np.sqrt(transform.shape[1]))
            before = float(np.sum(scan.energy[part]))
            after = float(np.sum(scan.left[part]))
            absorbed = min(absorbed, 1.0 - after / max(before, 1e-300))
        out.append(
            Testability(
                name, float(np.clip(absorbed, 0, 1)), upper, estimate, detect, p_of.get(name, 1.0)
            )
        )
    return out


def recalibrated_twist(fitted: FittedStructure, index: int) -> Floats:
    """Twist of a term that no other calibration would take up [deg].

    Parameters
    ----------
    fitted : FittedStructure
    index : int
        Index of the term.

    Returns
    -------
    ndarray, shape (fitted,)
    """
    return recalibration(fitted)(fitted.contribution(index)[fitted.problem.fitted])


def size_left(fitted: FittedStructure, term: Term) -> float:
    """Largest twist of a term in what a structure leaves [deg].

    What everything fitted would take up of the term is no part of it.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    term : Term
        Not one of its terms.

    Returns
    -------
    float
        In deg.
    """
    columns = term.columns(fitted.history)[fitted.problem.fitted]
    white = fitted.whitened(columns, fitted.noise)
    beside = white - fitted.tangent @ (fitted.tangent.T @ white)
    # What is taken up whole leaves rounding, of which no amplitude can be had.
    left = np.linalg.norm(beside, axis=0) > LEAST_BESIDE * np.linalg.norm(white, axis=0)
    if not np.any(left):
        return 0.0
    columns, white, beside = columns[:, left], white[:, left], beside[:, left]
    amplitudes = np.linalg.lstsq(beside, fitted.residual, rcond=LEAST_BESIDE)[0]
    whole = recalibration(fitted)(columns @ amplitudes)
    all_of_it = max(float(np.linalg.norm(white @ amplitudes)), 1e-300)
    seen = float(np.linalg.norm(beside @ amplitudes)) / all_of_it
    return seen * float(np.max(np.abs(whole)))


def spread_of_size(fitted: FittedStructure, index: int, covariance: Floats) -> float:
    """Standard error of the largest twist of a term, by its amplitudes and its shape [deg].

    Parameters
    ----------
    fitted : FittedStructure
    index : int
        Index of a linear term.
    covariance : ndarray, shape (k, k)
        Of all parameters, linear ones first.

    Returns
    -------
    float
        In deg.
    """
    use = fitted.problem.fitted
    recalibrated = recalibration(fitted)

    def twist(changed: FittedStructure) -> Floats:
        return recalibrated(changed.contribution(index)[use])

    here = twist(fitted)
    place = int(np.argmax(np.abs(here)))
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    chosen = [*fitted.amplitude_places(index), *fitted.nonlinear_places(index)]
    slope = np.zeros(len(chosen))
    for j, k in enumerate(chosen):
        step = 0.1 * spread[k]
        if step > 0 and np.isfinite(step):
            slope[j] = (twist(fitted.moved(k, step))[place] - here[place]) / step
    variance = float(slope @ covariance[np.ix_(chosen, chosen)] @ slope)
    return float(np.sqrt(max(variance, 0.0)))


def of_any_size(search: Search, fitted: FittedStructure) -> frozenset[str]:
    """Names of terms beside friction that fit as well at any size, or let friction do so.

    Parameters
    ----------
    search : Search
        Search of the recording.
    fitted : FittedStructure
        Structure fitted jointly with the calibration.

    Returns
    -------
    frozenset of str
        On a known flank those whose 95 % interval of size holds zero, if nothing were known of
        their shapes, and those that all other terms together can replace; anywhere those beside
        which a friction is not seen that is plain without them. None where nothing slips: a law
        that alone explains a mismatch is at work, whatever its shape.
    """
    effects = [k for k, term in enumerate(fitted.terms) if term.effect is not None]
    sliding = [k for k in effects if fitted.terms[k].slips]
    others = [k for k in effects if k not in sliding]
    if not (sliding and others):
        return frozenset()
    hidden = [k for k in sliding if strength_of(search, fitted, k) < NORMAL_95]

    def hides(index: int) -> bool:
        return any(strength_of(search, fitted, k, (index,)) >= PLAIN for k in hidden)

    def is_open(index: int) -> bool:
        if fitted.follows_path(index):
            return False
        size = float(np.max(np.abs(recalibrated_twist(fitted, index)), initial=0.0))
        # A spread beyond all numbers is no number; where the others can be all of a law, the
        # covariance holds none of what it shares with them.
        known = NORMAL_95 * spread_of_size(fitted, index, fitted.covariance) < size
        return not known or strength_of(search, fitted, index) < NORMAL_95

    return frozenset(fitted.terms[k].name for k in others if hides(k) or is_open(k))


def calibration_basis(fitted: FittedStructure) -> Floats:
    """Orthonormal columns of what a calibration takes up on the fitted rows, shape (fitted, k)."""
    problem, history = fitted.problem, fitted.history
    line = line_design(history, history.applied_nm, one_sided=problem.one_sided)
    return orthonormal(line[problem.fitted])


def recalibration(fitted: FittedStructure) -> Callable[[Floats], Floats]:
    """Function that takes out of twists on the fitted rows all that a calibration takes up."""
    basis = calibration_basis(fitted)
    return lambda part: np.asarray(part - basis @ (basis.T @ part))


def hidden_effects(search: Search) -> list[Untestable]:
    """Effects that this recording cannot show, with reason and remedy."""
    hidden = search.library.untestable | search.library.unbounded
    shown = set(search.baseline.scan.groups)
    hidden |= dict.fromkeys(
        sorted(search.library.effects.keys() - shown),
        "the calibration of stiffness, play and datum hides all of it",
    )
    return [
        *(Untestable(name=n, reason=r, needs=w) for n, r, w in ALWAYS_HIDDEN),
        *(
            Untestable(name=name, reason=reason, needs=find(name).shown_by)
            for name, reason in hidden.items()
        ),
    ]


def strength_of(
    search: Search, fitted: FittedStructure, index: int, left_out: Collection[int] = ()
) -> float:
    """Projected signal-to-noise of a term, the other terms and the calibration taken out.

    Parameters
    ----------
    search : Search
        Search of the recording.
    fitted : FittedStructure
        Structure fitted jointly with the calibration.
    index : int
        Which of the structure's terms.
    left_out : collection of int
        Others of them, which are not taken out.

    Returns
    -------
    float
        In units of the noise.
    """
    signal = fitted.whitened_contribution(index, search.noise)
    known = list(range(search.problem.line_columns))
    for k, term in enumerate(fitted.terms):
        if k != index and k not in left_out and not term.slips:
            known += fitted.amplitude_places(k)
    for k, nonlinear in enumerate(fitted.fit_parameters):
        if nonlinear.term != index and nonlinear.term not in left_out:
            known.append(len(fitted.beta) + k)
    basis = orthonormal(fitted.sensitivity[:, known], 1e-8)
    left = signal - basis @ (basis.T @ signal)
    return float(np.linalg.norm(left)) * float(np.sqrt(fitted.independent_share))
