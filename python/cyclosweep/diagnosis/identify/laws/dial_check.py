"""Eccentric dials whose error has one of its two parts only, or is larger than any dial's."""

from collections.abc import Sequence

import numpy as np
from scipy.special import voigt_profile
from scipy.stats import norm

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    BOTH_CURVES,
    LawCheck,
    own_classes,
    withdrawn_where,
)
from cyclosweep.simulation.effects.dial_eccentricity import LEAST_PART, MOST_STEEP

ERRORS = 2.0
"""Standard errors within which a part has to be so small, or so large."""
LEAST_ODDS = -0.5
"""Log odds of a dial of any direction over an even or an odd curve below which it is no dial [nat].
Of true dials a sixth fall below it where the smaller part is known to a tenth of the size, two
fifths where it is known to half of it. Measured, two side loads that were called a dial do so for
each dial."""


def direction_odds(smaller: float, larger: float, error: float) -> float:
    """Log odds of an error of any direction over one that has its larger part only [nat].

    Where all directions are equally likely, the ratio of the two parts has a Cauchy distribution.

    Parameters
    ----------
    smaller, larger : float
        Its amplitudes in the two directions, in absolute values; the larger one is known well
        [deg].
    error : float
        Standard error of the smaller one [deg].

    Returns
    -------
    float
        Negative where the smaller one is zero within its error; zero where it has none, because the
        recording does not determine it.
    """
    if error <= 0.0:
        return 0.0
    any_direction = float(np.log(voigt_profile(smaller, error, larger)))
    return any_direction - float(norm.logpdf(smaller, scale=error))


def without_other_dials(
    fitted: FittedStructure, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw dials whose error is an even curve or an odd one, or steeper than any dial's.

    Such a curve is a side load's or a contact's. A dial of an error once and twice a turn is not
    judged here.

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
    errors = fitted.standard_errors
    withdrawn = set[str]()
    for k, term in enumerate(fitted.terms):
        if term.effect is None or term.slips or not term.effect.vector:
            continue
        places = fitted.amplitude_places(k)
        if len(places) != 2 or not set(own_classes(term)) >= BOTH_CURVES:
            continue
        smaller, larger = sorted(places, key=lambda place: abs(float(fitted.beta[place])))
        parts = np.abs(fitted.beta[[smaller, larger]])
        most = float(parts[0]) + ERRORS * float(errors[smaller])
        size = float(np.hypot(*parts))
        odds = direction_odds(float(parts[0]), float(parts[1]), float(errors[smaller]))
        order = float(term.shape.get("order", 1.0))
        steepest = order * float(np.radians(size - ERRORS * float(errors[larger])))
        if most < LEAST_PART * size or odds < LEAST_ODDS or steepest > MOST_STEEP:
            withdrawn.add(term.name)
    return withdrawn_where(withdrawn.__contains__, checks)
