"""Laws that together stand for one class of behaviour.

Where the law of a single cause is on no list, two or three laws of the list may make its curve
between them. The flexible group of the one class then explains as much with fewer assumptions.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.law_in_class import (
    LawCheck,
    amplitude_count,
    basis_of_others,
    law_evidence,
    law_places,
    own_classes,
)

FURTHER_EFFECT = 6.0
"""Log prior odds against each further effect [nat], as in the search."""


def without_laws_of_one_class(
    fitted: FittedStructure, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw the laws of other classes where one class explains as much as all laws together.

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
    held = {check.name for check in checks if check.holds}
    indices = [k for k, term in enumerate(fitted.terms) if term.name in held]
    if len(indices) < 2:
        return tuple(checks)
    classes = ClassColumns.of(fitted)
    places = [place for index in indices for place in law_places(fitted, index)]
    known = basis_of_others(fitted, places)
    law = classes.scale * np.sum(
        [fitted.whitened_contribution(index, fitted.noise) for index in indices], axis=0
    )
    residual = classes.scale * fitted.residual + law
    law, residual = (each - known @ (known.T @ each) for each in (law, residual))
    amplitudes = sum(amplitude_count(fitted, index) for index in indices)
    charged = (amplitudes, len(places) - amplitudes)
    by_laws = law_evidence(residual, law, charged, classes.freedom)
    by_laws -= FURTHER_EFFECT * (len(indices) - 1)
    found = {name: classes.evidence(name, known, residual).evidence for name in classes.columns}
    best = max(found, key=lambda name: found[name])
    if found[best] <= by_laws:
        return tuple(checks)
    own = {fitted.terms[index].name: own_classes(fitted.terms[index]) for index in indices}
    return tuple(
        replace(check, behaviour=best, holds=False)
        if check.name in held and best not in own[check.name]
        else check
        for check in checks
    )
