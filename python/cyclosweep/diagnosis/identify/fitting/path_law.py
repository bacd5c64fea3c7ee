"""Elastic law by which the path of the shaft is solved while a structure is fitted.

Friction holds the shaft where it sticks, so that what is elastic and what slips have to be solved
together. With the line alone in the solver, and the twist of a stiffening added afterwards, the two
never settle where that twist is as steep as the line: each round overshoots the last.
"""

from collections.abc import Sequence

import numpy as np

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.simulation.drag_compliance import with_drag_compliance
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.twist_law import ElasticLaw
from cyclosweep.simulation.elastic_law import history_through, law_of_twist


def path_law(elastic: Sequence[tuple[Term, Floats]], history: History) -> ElasticLaw | None:
    """Elastic law of a structure: the line and every term that follows from the elastic torque.

    Where a term differs between rising and falling torque the law has the mean of both; what is
    left of it moves the datum of the path, as everything does that is no part of the law.

    Parameters
    ----------
    elastic : sequence of (Term, ndarray)
        The terms that belong to the law, each with its amplitudes.
    history : History
        All rows, with the calibrated line.

    Returns
    -------
    ElasticLaw or None
        None where no term belongs to it: the law is the line.
    """
    if not elastic:
        return None
    compliance, free_play = history.compliance_deg_per_nm, history.free_play_deg

    def added(torque: Floats) -> Floats:
        line = compliance * torque
        rows = history_through(torque, line, (compliance, free_play), history.output_pin_count)
        return np.asarray(sum(term.columns(rows) @ own for term, own in elastic))

    def twist(torque: Floats) -> Floats:
        return compliance * torque + 0.5 * (added(torque) + added(torque[::-1])[::-1])

    return law_of_twist(twist, history.largest_torque_nm, compliance)


def beyond_friction(terms: Sequence[Term], design: Sequence[Floats], beta: Floats) -> Floats:
    """Twist that does not move the part that friction holds.

    Parameters
    ----------
    terms : sequence of Term
        All terms of a structure.
    design : sequence of ndarray, shape (n, m)
        Columns of the line, then of each term that does not slip.
    beta : ndarray
        Linear parameters.

    Returns
    -------
    ndarray, shape (n,)
        In deg.
    """
    parts = linear_parts(terms, design, beta)
    twist = np.zeros(len(design[0]))
    for term, columns, own in parts:
        if term.lies_beyond_friction:
            twist += columns @ own
    return twist


def elastic_parts(
    terms: Sequence[Term], design: Sequence[Floats], beta: Floats
) -> list[tuple[Term, Floats]]:
    """Terms of the elastic law, each with its amplitudes.

    Parameters
    ----------
    terms : sequence of Term
        All terms of a structure.
    design : sequence of ndarray, shape (n, m)
        Columns of the line, then of each term that does not slip.
    beta : ndarray
        Linear parameters.

    Returns
    -------
    list of (Term, ndarray)
    """
    parts = linear_parts(terms, design, beta)
    return [(term, own) for term, _, own in parts if term.elastic]


def under_drag(
    terms: Sequence[Term], design: Sequence[Floats], beta: Floats, history: History
) -> History:
    """Path of the shaft with the compliance at which drag takes its twist.

    Parameters
    ----------
    terms : sequence of Term
        All terms of a structure.
    design : sequence of ndarray, shape (n, m)
        Columns of the line, then of each term that does not slip.
    beta : ndarray
        Linear parameters.
    history : History
        All rows, with the calibrated line.

    Returns
    -------
    History
    """
    elastic = elastic_parts(terms, design, beta)
    drags = [
        columns @ own
        for term, columns, own in linear_parts(terms, design, beta)
        if term.effect is not None and term.effect.is_drag
    ]

    def twist(under: History) -> Floats:
        line = history.compliance_deg_per_nm * under.elastic_nm
        return np.asarray(line + sum(term.columns(under) @ own for term, own in elastic))

    return with_drag_compliance(history, twist, np.asarray(sum(drags)))


def linear_parts(
    terms: Sequence[Term], design: Sequence[Floats], beta: Floats
) -> list[tuple[Term, Floats, Floats]]:
    """Terms that do not slip, each with its columns and amplitudes.

    Parameters
    ----------
    terms : sequence of Term
        All terms of a structure.
    design : sequence of ndarray, shape (n, m)
        Columns of the line, then of each of these terms.
    beta : ndarray
        Linear parameters.

    Returns
    -------
    list of (Term, ndarray, ndarray)
    """
    ends = np.cumsum([part.shape[1] for part in design])
    linear = [term for term in terms if not term.slips]
    return [
        (term, columns, beta[start:end])
        for term, columns, start, end in zip(linear, design[1:], ends[:-1], ends[1:], strict=True)
    ]
