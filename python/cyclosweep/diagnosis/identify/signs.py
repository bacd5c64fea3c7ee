"""Signs of amplitudes: parts of an effect that came out against physics are left out."""

from dataclasses import replace

from cyclosweep.diagnosis.identify.fit import ContactFit, fit

MOST_PRUNED = 3
"""Times parts of an effect are left out because of their sign."""


def with_right_signs(joint: ContactFit) -> ContactFit | None:
    """Leave out parts of effects that came out with the wrong sign; None where that fails."""
    for _ in range(MOST_PRUNED):
        if joint.valid:
            return joint
        terms = []
        for k, term in enumerate(joint.terms):
            wrong = joint.wrong_signs(k)
            if wrong.any():
                shape = None if term.effect is None else term.effect.reduced(term.shape, wrong)
                if shape is None:
                    return None
                term = replace(term, shape=shape)
            terms.append(term)
        joint = fit(joint.problem, joint.noise, terms, joint)
    return joint if joint.valid else None
