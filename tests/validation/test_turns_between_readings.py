"""Programmes that turn between two readings, as those of a rig that is read once a second do."""

import numpy as np

import cyclosweep as cs
from cyclosweep.simulation.model import EffectValue

PEAKS_NM = np.array([0.0, 12.6, 4.1, 13.3, -11.7, -3.2, -12.4, 0.0])
FINE_S, PER_READING = 0.05, 20
NOISE_DEG = 0.04
RUNS = 8
FRICTION = EffectValue("friction_hysteresis", {"slip_deg": 0.5, "scatter": 0.4}, (1.2,))
STIFFENING = EffectValue("contact_stiffening", {"cubic_nm": 6.0}, (0.15,))


def read_once_a_second() -> cs.Recording:
    """Even ramps with peaks anywhere between the readings, solved in steps of a twentieth."""
    rng = np.random.default_rng(3)
    parts = []
    begun_s = 0.0
    for number in range(1, RUNS + 1):
        peaks = rng.uniform(0.6, 1.2) * PEAKS_NM * (-1.0) ** number
        at_s = np.r_[0.0, np.cumsum(np.abs(np.diff(peaks)) / rng.uniform(0.5, 1.2))]
        time = np.arange(FINE_S * rng.integers(1, PER_READING), at_s[-1], FINE_S)
        parts.append((time + begun_s, np.interp(time, at_s, peaks), np.full(len(time), number)))
        begun_s += at_s[-1] + 60.0
    time, torque, run = map(np.concatenate, zip(*parts, strict=True))
    model = cs.Model(compliance_deg_per_nm=1.4, free_play_deg=14.0, effects=(FRICTION, STIFFENING))
    solved = cs.simulate(model, cs.Recording.from_arrays(torque, time_s=time, run=run))
    assert solved.angle_deg is not None
    read = np.concatenate([np.flatnonzero(run == k)[::PER_READING] for k in range(1, RUNS + 1)])
    read = read[np.abs(torque[read]) > 0.3]
    angle = solved.angle_deg[read] + rng.normal(0.0, NOISE_DEG, len(read))
    return cs.Recording.from_arrays(torque[read], angle, time_s=time[read], run=run[read])


def test_friction_that_turns_between_readings_is_no_drag() -> None:
    # From reading to reading friction turned late; what that missed was named viscous drag.
    diagnosis = cs.diagnose(read_once_a_second(), cs.Drive.reference_87(), full=False)
    assert diagnosis.verdict == "IDENTIFIED"
    assert {e["name"] for e in diagnosis.effects} == {"friction_hysteresis", "contact_stiffening"}
    assert diagnosis.content["repaired"]["rmse_deg"] < 1.05 * NOISE_DEG
