"""Terms from which the joint fit of one more hypothesis starts."""

from collections.abc import Iterator, Sequence

import numpy as np

from cyclosweep.diagnosis.hypotheses.library import Signature
from cyclosweep.diagnosis.hypotheses.sinusoid import FAMILIES
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate, prior_penalty
from cyclosweep.diagnosis.identify.structures.placement import better_placed
from cyclosweep.diagnosis.identify.structures.scan import Scan, evidence
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.simulation.effects import Shape

DENSE = frozenset({"saturation at the end of the range", "bump at a load"})
"""Unnamed shapes whose grid stands for what is believed beforehand."""
OTHER_LAW = 0.8
"""Evidence of another law of an effect over that of the best one, from which it is tried too."""
TIED_DIGITS = 6
"""Decimals of log evidence to which shapes that explain the same agree."""
MOST_CHOICE_PENALTY = 1.5
"""What the choice of a shape is charged at most where the grid of shapes is coarse [nat]."""


def starting_terms(parent: Candidate, hypothesis: str) -> Iterator[tuple[Term, float, float]]:
    """Terms from which the fit of a structure with one more hypothesis starts.

    Parameters
    ----------
    parent : Candidate
        The structure to which it is added.
    hypothesis : str
        Name of an effect, or family of an unnamed shape.

    Yields
    ------
    term : Term
    rank : float
        Number of amplitudes that the recording tells apart.
    penalty : float
        Log evidence that the choice of this shape among others is charged [nat].
    """
    if hypothesis in FAMILIES:
        value, sinusoid = parent.sinusoid
        assert sinusoid is not None
        term = Term(None, {}, sinusoid)
        yield term, 2.0, max(_sinusoid_gain(parent, term) - value, 0.0)
        return
    found = parent.scan
    members = found.groups[hypothesis]
    each = evidence(found.observed[members], found.ranks[members])
    average = found.by_hypothesis[hypothesis]
    signatures = [found.library.signatures[index] for index in members]
    penalties = np.array([prior_penalty(hypothesis, s.effect, s.shape) for s in signatures])
    # Waves that the positions of a recording do not tell apart explain the same: fewer do it.
    width = np.array([len(s.scale) for s in signatures], dtype=np.float64)
    rank = np.lexsort(np.stack([width, np.round(penalties - each, TIED_DIGITS)]))
    order = members[rank]
    first = found.library.signatures[order[0]]
    dense = first.effect.dense if first.effect is not None else hypothesis in DENSE
    most = np.inf if dense else MOST_CHOICE_PENALTY
    choice = float(np.clip(each[rank[0]] - average, 0.0, most))
    slips = first.effect is not None and first.effect.slips
    tried, laws = 0, {frozenset(first.shape)}
    for index, value in zip(order, each[rank], strict=True):
        signature = found.library.signatures[index]
        law = frozenset(signature.shape)
        # Between the shapes of a grid a law that was not the best on it may fit best.
        other_law = dense and law not in laws and value >= OTHER_LAW * each[rank[0]]
        if tried and not (other_law or (slips and _far_apart(signature, first))):
            continue
        laws.add(law)
        amplitude = _amplitude(found, signature) if slips else 0.0
        shapes: Sequence[Shape] = [signature.shape]
        if signature.effect is not None and not tried:
            shapes = signature.effect.variants(parent.fit.history, signature.shape)
        for shape in shapes:
            term = Term(signature.effect, shape, signature.unnamed, amplitude)
            term, charge = better_placed(term, parent.fit)
            yield term, float(found.ranks[index]), choice + charge
        tried += 1
        if slips and tried >= 2:
            return


def _sinusoid_gain(parent: Candidate, term: Term) -> float:
    """Evidence of the sinusoid in a residual before the penalty for its search [nat].

    Parameters
    ----------
    parent : Candidate
        The structure to which something is added.
    term : Term

    Returns
    -------
    float
        In nat.
    """
    fitted = parent.fit
    columns = term.columns(fitted.history)[fitted.problem.fitted]
    basis = orthonormal(fitted.whitened(columns, fitted.noise))
    return float(evidence(np.sum((basis.T @ fitted.residual) ** 2), 2.0))


def _amplitude(found: Scan, signature: Signature) -> float:
    """Friction limit that a scan suggests for a signature.

    Parameters
    ----------
    found : Scan
    signature : Signature

    Returns
    -------
    float
        In N m, or a share of the torque.
    """
    column = signature.first
    return float(max(found.score[column] / found.left[column] / signature.scale[0], 1e-6))


def _far_apart(signature: Signature, other: Signature) -> bool:
    """Whether two shapes of one effect are far enough apart to be worth a second start.

    Parameters
    ----------
    signature : Signature
    other : Signature

    Returns
    -------
    bool
    """
    return signature.effect is not None and signature.effect.far_apart(signature.shape, other.shape)
