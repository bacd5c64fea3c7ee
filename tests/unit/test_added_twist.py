"""Twist that friction adds along a bent elasticity: within the torque that was reached."""

from dataclasses import replace

import numpy as np

import cyclosweep as cs
from cyclosweep.diagnosis.elasticity import added_twist
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.simulate import EffectValue
from tests.support.arrays import present
from tests.unit.test_fitted_structure import searched

FRICTION = {"slip_deg": 0.5, "scatter": 0.4, "skew": 0.0, "slack": 0.0}
SOFTENS = {"onset_nm": 6.0, "power": 2.0}


def test_a_law_adds_no_more_than_at_the_largest_torque_that_was_reached() -> None:
    leg = np.linspace(-9.0, 9.0, 200)
    load = cs.Recording.from_arrays(
        np.tile(np.r_[leg, leg[::-1]], 3), run=np.repeat([1, 2, 3], 400), side="input"
    )
    effects = (
        EffectValue("friction_hysteresis", FRICTION, (0.7,)),
        EffectValue("overload_softening", SOFTENS, (20.0,)),
    )
    model = cs.Model(compliance_deg_per_nm=2.7, free_play_deg=26.0, effects=effects)
    angle = present(cs.simulate(model, load).angle_deg)
    noise = np.random.default_rng(4).normal(0.0, 0.02, len(angle))
    search = searched(load.with_angle(angle + noise), cs.Drive.reference_87())
    terms = (
        Term(find("friction_hysteresis"), FRICTION, None, 0.7),
        Term(find("overload_softening"), SOFTENS),
    )
    found = fit(search.problem, search.noise, terms, search.baseline.fit)
    rows = found.problem.fitted
    # The same curve up to the torque that was reached, and very steep beyond it.
    top = float(np.abs(found.history.elastic_nm[rows]).max())
    steep = {"onset_nm": top - 0.7, "power": 10.0}
    beta = found.beta.copy()
    beta[found.column_range(1)] = 3.0 / 0.07 ** steep["power"]
    steeper = replace(
        found, terms=(found.terms[0], replace(found.terms[1], shape=steep)), beta=beta
    )
    bent = steeper.contribution(1)[rows]
    assert np.abs(bent).max() < 3.001
    by_the_line = np.abs(steeper.contribution(0)[rows]).max()
    assert by_the_line > 1.0
    added = added_twist(steeper, 0)[rows]
    assert np.abs(added).max() < by_the_line + 3.001
    # Away from the largest torque the friction holds back what lies along the curve, too.
    assert np.abs(added).max() > by_the_line + 1.0
