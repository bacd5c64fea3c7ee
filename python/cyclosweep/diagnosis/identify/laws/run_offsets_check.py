"""Laws of the offsets of runs, judged beside each other.

Offsets of runs are a few numbers. What one law misses of them another law fills: temperature or
position of the mesh take up what a law of the datum leaves.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import betainc

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    CLASSES_OF_EFFECT,
    MOST_POSITIONS,
    POSITION,
)
from cyclosweep.diagnosis.identify.fitting.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    LawBeside,
    LawCheck,
    amplitude_count,
    own_classes,
    withdrawn_where,
)
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.simulation.effects.history import Flags, History
from cyclosweep.simulation.effects.mesh_range import mesh_positions
from cyclosweep.simulation.effects.order_names import travels

BY_CHANCE = 1e-4
"""Probability of a law of run offsets, found among a hundred, up to which it is no chance."""


def without_leftovers(
    fitted: FittedStructure, classes: ClassColumns, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw what vanishes beside the whole class of a larger effect of the same family.

    Offsets of runs are a few numbers. What one law misses of them another law fills, unless the
    laws have far fewer amplitudes than there are offsets, and leave next to nothing.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    classes : ClassColumns
        Columns of every class.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    place = {term.name: k for k, term in enumerate(fitted.terms)}
    found = {check.name: check for check in checks}
    offsets = [check.name for check in checks if check.name in CLASSES_OF_EFFECT]
    if len(offsets) < 2:
        return tuple(checks)
    size = {
        name: float(np.linalg.norm(fitted.whitened_contribution(place[name], fitted.noise)))
        for name in offsets
    }
    largest = max(offsets, key=lambda name: size[name])
    left = beyond_noise_deg(fitted)
    for name in offsets:
        if name == largest or not found[name].holds:
            continue
        spread = float(np.std(recalibrated_twist(fitted, place[name])))
        if not may_be_chance(fitted, place[name], spread, left):
            continue
        for whole in own_classes(fitted.terms[place[largest]]):
            if whole in classes.columns and _vanishes(fitted, classes, place[name], whole):
                found[name] = replace(found[name], holds=False)
    if not all(found[name].holds for name in offsets if name != largest):
        # The others took part of it away; it is judged again without them.
        found[largest] = replace(found[largest], holds=True)
    return tuple(found[check.name] for check in checks)


def without_any_offsets(
    fitted: FittedStructure, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw a law of the position with as many amplitudes as fitted runs have offsets.

    It fits whatever offsets, and so says nothing of where they come from.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    offsets = count_states(fitted.history, fitted.problem.fitted) - 1
    saturated = {
        term.name
        for k, term in enumerate(fitted.terms)
        if term.effect is not None
        and own_classes(term) == (POSITION,)
        and not travels(term.shape)
        and amplitude_count(fitted, k) >= offsets
    }
    return withdrawn_where(saturated.__contains__, checks)


def count_states(history: History, fitted: Flags) -> int:
    """Count the runs of a recording, each at every position at which it was read.

    Parameters
    ----------
    history : History
        Load history of the recording.
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.

    Returns
    -------
    int
    """
    if history.crank_deg is None:
        return len(np.unique(history.run[fitted]))
    states = np.column_stack([history.run[fitted], mesh_positions(history.crank_deg[fitted])])
    return len(np.unique(states, axis=0))


def _vanishes(fitted: FittedStructure, classes: ClassColumns, index: int, whole: str) -> bool:
    """Whether nothing is left of a law beside all columns of a class.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    classes : ClassColumns
        Columns of every class.
    index : int
        Place of the law's term.
    whole : str
        Name of the class.

    Returns
    -------
    bool
    """
    return LawBeside.of(fitted, classes, [index]).is_replaced(classes, whole)


def offset_count(history: History, fitted: Flags, name: str) -> int:
    """Number of offsets that a recording has for a law to follow.

    Parameters
    ----------
    history : History
        Load history of the recording.
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.
    name : str
        Name of the effect: one that goes with the position has an offset for each position of a
        run, unless it moves steadily, the others one for each run.

    Returns
    -------
    int
    """
    if history.crank_deg is None or POSITION not in CLASSES_OF_EFFECT[name]:
        return history.run_count
    place = mesh_positions(history.crank_deg[fitted])
    if len(np.unique(place)) > MOST_POSITIONS:
        return history.run_count
    return count_states(history, fitted)


def may_be_chance(fitted: FittedStructure, index: int, size: float, left: float) -> bool:
    """Whether a law of run offsets may by chance hold what another one misses of them.

    Offsets of runs are a few numbers. Of n of them k columns drawn at random leave a share of the
    mean square that has a beta distribution of (n - k)/2 and k/2.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    index : int
        Place of the law's term.
    size : float
        Root mean square of its twist [deg].
    left : float
        Root mean square of what the whole structure leaves beyond the noise [deg].

    Returns
    -------
    bool
    """
    offsets = [k for k, term in enumerate(fitted.terms) if term.name in CLASSES_OF_EFFECT]
    counted = sum(amplitude_count(fitted, k) for k in offsets)
    name = fitted.terms[index].name
    free = offset_count(fitted.history, fitted.problem.fitted, name) - 1 - counted
    if free <= 0:
        return True
    left = max(left, _noise_of_an_offset(fitted))
    share = left**2 / max(left**2 + size**2, 1e-300)
    return float(betainc(0.5 * free, 0.5 * counted, share)) > BY_CHANCE


def _noise_of_an_offset(fitted: FittedStructure) -> float:
    """Standard error of the offset of a run by the noise of its readings [deg]."""
    noise = fitted.noise
    pieces = max(noise.independent_pieces, 1.0)
    return noise.spread_deg * float(np.sqrt(fitted.history.run_count / pieces))
