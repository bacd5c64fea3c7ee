"""Offsets of runs that follow a law are foreseen for a run that was left out."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from tests.support.searches import search_of_recording

NOISE_DEG = 0.05


def recording(datum_deg: float) -> cs.Recording:
    """Five loops, the datum of each further by seven tenths of what it was the time before."""
    rise = np.linspace(0.05, 1.0, 45)
    half = np.concatenate([rise, rise[-2::-1]])
    torque = 6.0 * np.concatenate([half, -half])
    moved, parts = 0.0, []
    for _ in range(5):
        parts.append(28.0 * np.sign(torque) + 2.7 * torque + datum_deg - moved)
        moved = 0.7 * moved + 0.3
    angle = np.concatenate(parts)
    angle += np.random.default_rng(4).normal(0.0, NOISE_DEG, len(angle))
    return cs.Recording.from_arrays(
        np.tile(torque, 5), angle, run=np.repeat(np.arange(5), len(torque))
    )


@pytest.mark.parametrize("datum_deg", [0.0, 44.0])
def test_forecast_of_left_out_runs_does_not_hang_on_the_zero_of_the_dial(datum_deg: float) -> None:
    search = search_of_recording(recording(datum_deg))
    effect = search.library.effects["datum_drift"].effect
    fitted = fit(search.problem, search.noise, [Term(effect, {"each_run": 1.0})])
    angle = search.problem.angle_deg
    for left in fitted.predict_left_out():
        error = (angle - left.structure_deg)[left.rows]
        assert np.sqrt(np.mean(error**2)) < 0.5
