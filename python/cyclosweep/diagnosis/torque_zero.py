"""Whether the torque was read from a wrong zero, which looks like a curve that is not odd."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from cyclosweep.diagnosis.hypotheses.unnamed_shapes import unnamed_shapes
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.friction_first import (
    CONVERGED,
    PARAMETER_CHARGE,
    charges,
    structure_cost,
)
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import WITHIN_NOISE
from cyclosweep.diagnosis.one_history import (
    AS_WELL,
    CLEARLY,
    CLEARLY_LIKELIER,
    best_structure,
    identify_over_runs,
)
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.prepare.split import restrict
from cyclosweep.diagnosis.prepare.torque_zero import TorqueZero
from cyclosweep.diagnosis.refuse import NoDiagnosisError
from cyclosweep.recording import Recording
from cyclosweep.simulation.effects.history import Flags

FARTHEST = 0.05
"""Largest error of the zero that is tried, as a share of the largest torque."""
STEP = 0.005
"""Error of the zero by which the likelihood is tried first, as a share of the largest torque."""
MOST_ZEROS = 3
"""Most zeros that are taken one after the other: effects found with a better one show it better."""
MOST_KEPT = 0.5
"""Share of the rows that have to stay in contact."""
IMPOSSIBLE = 1e12
"""Cost of a zero with which hardly anything, or one direction alone, is left."""
NEAR = 1e-4
"""Share of the largest torque to which the zero is found."""
LESS_LEFT = 0.99
"""What as many effects leave with another zero, over what they leave without, at most."""
ODD = "smooth odd curve"
BY_WAYS = frozenset({"even curve", "dial"})
"""Families of the effects by which one way is unlike the other, as from a wrong zero."""
ODD_IN_PART = frozenset({"dial", "torque and direction"})
"""Families of what may be an odd curve and a wrong zero together."""
BENDS = BY_WAYS | ODD_IN_PART | {ODD, "bump at a load", "saturation at the end of the range"}
"""Families of what bends the curve of the torque. A straight one is only shifted by its zero."""

Prepared = Callable[..., Problem]
"""From ``one_history`` and ``torque_zero`` to the prepared recording."""
Calibrated = Callable[[Problem], Search]


@dataclass(frozen=True, eq=False)
class Zeroed:
    """A structure fitted with the torque read from another zero.

    Attributes
    ----------
    cost : float
        Minus twice the log likelihood, with what parameters and effects are charged.
    fitted : FittedStructure
    """

    cost: float
    fitted: FittedStructure


def identify_with_torque_zero(
    recording: Recording, prepared: Prepared, calibrated: Calibrated, say: Callable[[str], None]
) -> Search:
    """Identify what is missing, with the torque's zero as read or as what is found shows it.

    Parameters
    ----------
    recording : Recording
    prepared, calibrated : callable
        Steps from the recording to a calibrated search.
    say : callable
        Called with a few words before each long step.

    Returns
    -------
    Search
        With all visited structures.
    """

    def identified(zero: TorqueZero | None) -> Search:
        def with_zero(one_history: bool) -> Problem:
            return prepared(one_history=one_history, torque_zero=zero)

        return identify_over_runs(recording, with_zero, calibrated, say)

    searched = identified(None)
    for _ in range(MOST_ZEROS):
        zero = find_torque_zero(searched, prepared)
        if zero is None:
            break
        say("starting over with the torque's zero")
        try:
            again = identified(zero)
        except NoDiagnosisError:
            # What can be diagnosed as it was read is not refused for a zero that was only inferred.
            break
        if not _is_better(again, searched):
            break
        searched = again
    return searched


def _is_better(again: Search, before: Search) -> bool:
    """Whether another zero of the torque leaves fewer effects, or as many and less error."""
    found, known = best_structure(again), best_structure(before)
    if not found.terms or len(found.terms) > len(known.terms):
        return False
    return len(found.terms) < len(known.terms) or found.rmse_deg < LESS_LEFT * known.rmse_deg


def find_torque_zero(searched: Search, prepared: Prepared) -> TorqueZero | None:
    """Zero of the torque that what was found shows.

    Read from a wrong zero, a curve that is odd in the torque is not odd in what was read, and looks
    as if a side load or an eccentric dial stood beside it. The zero is one number, and more common
    than either: it is taken where it explains as much as they do, or where it explains clearly
    more of what no effect does.

    Parameters
    ----------
    searched : Search
        A search that has run.
    prepared : callable
        Prepares the recording with another zero of the torque.

    Returns
    -------
    TorqueZero or None
        None where the torque is right, or its zero does not show.
    """
    problem, found = searched.problem, best_structure(searched)
    # Where the crossings of the dead zone show the zero, it was fitted with whole loops.
    if problem.one_sided or found.torque_zero != problem.torque_zero:
        return None
    if not any(term.family in BENDS for term in found.terms):
        return None
    as_read = _Profile(searched, prepared, found.terms)
    for terms in _offered(problem, found):
        profile = as_read if terms == found.terms else _Profile(searched, prepared, terms)
        share = profile.best()
        if share is not None and _explains_more(profile, share, as_read):
            return profile.zero_at(share)
    return None


def _explains_more(profile: "_Profile", share: float, as_read: "_Profile") -> bool:
    """Whether another zero explains as much with fewer effects, or clearly more with no fewer.

    Both are compared on the rows that are in contact with either zero.

    Parameters
    ----------
    profile : _Profile
        Of the effects with another zero.
    share : float
        How much further that is, over the largest torque.
    as_read : _Profile
        Of the effects that were found.

    Returns
    -------
    bool
    """
    other = profile.at(share)
    before = None if other is None else as_read.on(other.fitted.problem.fitted, 0.0)
    if other is None or before is None:
        return False
    charge = PARAMETER_CHARGE if profile.problem.torque_zero is None else 0.0
    likelier = before.cost - other.cost - charge
    fitted, known = other.fitted, before.fitted
    if len(fitted.terms) < len(known.terms):
        return likelier > -AS_WELL
    if likelier <= CLEARLY_LIKELIER:
        return False
    # What is left may be error of the laws, of which there is less than there are rows.
    within_noise = fitted.rmse_deg < WITHIN_NOISE * known.noise.spread_deg
    return within_noise or structure_cost(known) - structure_cost(fitted) > CLEARLY


def _offered(problem: Problem, found: FittedStructure) -> list[tuple[Term, ...]]:
    """Effects that may be all there is with another zero.

    Parameters
    ----------
    problem : Problem
    found : FittedStructure
        What was found with the zero as read.

    Returns
    -------
    list of tuple of Term
        Those found without what tells one way from the other; with an odd curve of no name in
        place of what may be odd in part; those found.
    """
    by_load = tuple(term for term in found.terms if term.family not in BY_WAYS)
    offered = [by_load]
    if any(term.family in ODD_IN_PART for term in found.terms):
        straight = tuple(term for term in found.terms if term.family not in BENDS)
        shapes = unnamed_shapes(problem.history, problem.fitted)
        odd = next(each for each in shapes if each.family == ODD)
        offered.append((*straight, Term(None, {}, odd)))
    return list(dict.fromkeys((*offered, found.terms)))


class _Profile:
    """Cost of some effects over the zero of the torque.

    Parameters
    ----------
    searched : Search
        The search that found them.
    prepared : callable
        Prepares the recording with another zero of the torque.
    terms : tuple of Term
        The effects.
    """

    def __init__(self, searched: Search, prepared: Prepared, terms: tuple[Term, ...]) -> None:
        self.problem, self.noise = searched.problem, searched.noise
        self.prepared, self.terms = prepared, terms
        self.largest_nm = self.problem.history.largest_torque_nm
        self.known: dict[float, Zeroed | None] = {}

    def at(self, share: float) -> Zeroed | None:
        """Fit with the zero further by a share of the largest torque, see `on`."""
        if share not in self.known:
            self.known[share] = self.on(self.problem.fitted, share)
        return self.known[share]

    def cost_at(self, share: float) -> float:
        """Cost of as many rows as were fitted before: near zero, one may lose contact."""
        found = self.at(share)
        if found is None:
            return IMPOSSIBLE
        return found.cost + found.fitted.loss * (
            self.problem.count / found.fitted.problem.count - 1.0
        )

    def on(self, rows: Flags, share: float) -> Zeroed | None:
        """Fit anew to some rows, where they are in contact.

        Parameters
        ----------
        rows : ndarray of bool, shape (n,)
        share : float
            How much further the zero is, over the largest torque.

        Returns
        -------
        Zeroed or None
            None where too few are in contact, or one direction alone is left.
        """
        zero = TorqueZero(self.problem.zero_nm + share * self.largest_nm, np.nan)
        problem = self.prepared(one_history=self.problem.one_history, torque_zero=zero)
        problem, noise = restrict(problem, self.noise, rows)
        if problem.one_sided or problem.count < MOST_KEPT * self.problem.count:
            return None
        fitted = fit(problem, noise, self.terms, rounds=CONVERGED)
        return Zeroed(fitted.loss + charges(fitted), fitted)

    def best(self) -> float | None:
        """Share of the largest torque by which the zero of least cost is further.

        Returns
        -------
        float or None
            None where steps to both sides promise too little, and where the cost has no least value
            well within reach.
        """
        below, middle, above = map(self.cost_at, (-STEP, 0.0, STEP))
        slope, bend = (above - below) / 2.0, above + below - 2.0 * middle
        promised = slope**2 / (2.0 * bend) if bend > 0.0 else np.inf
        if promised < CLEARLY_LIKELIER and not min(below, above) < middle - CLEARLY_LIKELIER:
            return None
        minimize_scalar(
            lambda share: self.cost_at(float(share)),
            bounds=(-FARTHEST, FARTHEST),
            method="bounded",
            options={"xatol": NEAR},
        )
        share = min(self.known, key=self.cost_at)
        return share if abs(share) <= FARTHEST - STEP and self._bend_at(share) > 0.0 else None

    def _bend_at(self, share: float) -> float:
        """Second difference of the cost over `STEP` about a zero."""
        return self.cost_at(share - STEP) + self.cost_at(share + STEP) - 2.0 * self.cost_at(share)

    def zero_at(self, share: float) -> TorqueZero:
        """Zero that is further by a share of the largest torque, with its standard error.

        Parameters
        ----------
        share : float
            Where the cost is least.

        Returns
        -------
        TorqueZero
        """
        spread = math.sqrt(2.0 / self._bend_at(share)) * STEP * self.largest_nm
        if self.noise.structured:
            spread *= math.sqrt(max(self.problem.count / INDEPENDENT_PIECES, 1.0))
        return TorqueZero(self.problem.zero_nm + share * self.largest_nm, spread)
