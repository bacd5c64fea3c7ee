"""Friction torque along the fitted path: how much of its limit a recording reaches."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.simulation.effects.history import Flags, Floats, History


def friction_torque_nm(terms: Sequence[Term], history: History, index: int) -> Floats:
    """Torque that one friction of a structure takes along its path.

    All friction acts on one set of slip elements, so that each has the share of its own limit.

    Parameters
    ----------
    terms : sequence of Term
        All terms of the structure.
    history : History
        All rows with the path that was solved, n of them.
    index : int
        Which of the terms, a friction.

    Returns
    -------
    ndarray, shape (n,)
        In N m, with its sign.
    """
    limit = np.zeros(len(history))
    for term in terms:
        if term.slips:
            limit += term.friction_limit(history)
    own = terms[index].friction_limit(history)
    share = np.divide(own, limit, out=np.zeros_like(limit), where=limit > 0)
    return np.asarray(share * (history.applied_nm - history.elastic_nm))


def friction_reached_nm(terms: Sequence[Term], history: History, name: str, rows: Flags) -> float:
    """Largest torque that the friction of a name takes along its path.

    Where the presliding is long against the twist that was recorded, not all slip elements slide:
    the limit of the law then lies beyond all that was recorded, and is known by extrapolation only.

    Parameters
    ----------
    terms : sequence of Term
        All terms of the structure.
    history : History
        All rows with the path that was solved, n of them.
    name : str
        Name of the friction.
    rows : ndarray of bool, shape (n,)
        Rows that count.

    Returns
    -------
    float
        In N m; zero without such a friction.
    """
    taken = np.zeros(len(history))
    for index, term in enumerate(terms):
        if term.slips and term.name == name:
            taken += friction_torque_nm(terms, history, index)
    return float(np.abs(taken[rows]).max(initial=0.0))
