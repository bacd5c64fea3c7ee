"""Fits against physics: parts of an effect of the wrong sign, effects in the place of the line."""

from dataclasses import replace

from cyclosweep.diagnosis.identify.fitting.fit import ContactFit, fit

MOST_PRUNED = 3
"""Times parts of an effect are left out because of their sign."""


def with_right_signs(joint: ContactFit, *, whole_effects: bool = False) -> ContactFit | None:
    """Leave out parts of effects that came out with the wrong sign.

    Parameters
    ----------
    joint : ContactFit
        The fit.
    whole_effects : bool
        Leave out an effect that has no other part, too.

    Returns
    -------
    ContactFit or None
        The fit of what is left; None where there is no such, or where effects have taken the place
        of the drive's elasticity.
    """
    for _ in range(MOST_PRUNED):
        if joint.valid or not joint.keeps_line:
            break
        terms = []
        for k, term in enumerate(joint.terms):
            wrong = joint.wrong_signs(k)
            if wrong.any():
                shape = None if term.effect is None else term.effect.reduced(term.shape, wrong)
                if shape is None and whole_effects:
                    continue
                if shape is None:
                    return None
                term = replace(term, shape=shape)
            terms.append(term)
        if not terms:
            return None
        joint = fit(joint.problem, joint.noise, terms, joint)
    return joint if joint.valid and joint.keeps_line else None
