"""Laws that together stand for one class of behaviour.

Where the law of a single cause is on no list, two or three laws of the list may make its curve
between them. The flexible group of the one class then explains as much with fewer assumptions.
"""

from collections.abc import Sequence
from dataclasses import replace

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    LawBeside,
    LawCheck,
    own_classes,
)
from cyclosweep.diagnosis.identify.structures.candidate import FURTHER


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
    laws = LawBeside.of(fitted, classes, indices)
    found = {
        name: classes.evidence(name, laws.known, laws.residual).evidence for name in classes.columns
    }
    best = max(found, key=lambda name: found[name])
    if found[best] <= laws.evidence - FURTHER * (len(indices) - 1):
        return tuple(checks)
    own = {fitted.terms[index].name: own_classes(fitted.terms[index]) for index in indices}
    return tuple(
        replace(check, behaviour=best, holds=False)
        if check.name in held and best not in own[check.name]
        else check
        for check in checks
    )
