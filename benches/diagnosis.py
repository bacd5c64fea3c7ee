"""Seconds of whole diagnoses, report included, by number of samples and of missing effects.

``python benches/diagnosis.py`` prints them; ``run.py`` puts them into docs/performance.md.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import cyclosweep as cs
from cyclosweep.simulation.simulate import EffectValue

__all__ = ["measure_diagnoses"]

NOISE_DEG = 0.05
TORQUES_NM = (0.4, 31.0, -31.0, 17.0, -12.0, 25.0, 9.0, 25.0, 0.4)
"""Reversals of every run, scaled by its amplitude."""
RUNS = ((1.0, 0.5), (0.4, 2.0), (0.7, 0.5), (0.25, 0.25), (1.0, 1.0), (0.55, 0.5))
"""Amplitude as a share of the largest torque, and rate [N m/s], of each run."""


def measure_diagnoses(*, quick: bool = False) -> list[dict[str, Any]]:
    """Diagnose recordings of the published model with effects far above the noise.

    Parameters
    ----------
    quick : bool
        Leave the long recording out.

    Returns
    -------
    list of dict
        Samples, missing effects, verdict, and wall-clock and processor seconds of each.
    """
    drive = cs.Drive.reference_87()
    nominal = drive.nominal_line("input")
    slip = {"slip_deg": 0.8, "scatter": 0.6, "skew": 0.0, "slack": 0.0}
    friction = EffectValue("friction_hysteresis", slip, (0.5,))
    warming = EffectValue("thermal_drift", {"datum": 1.0}, (0.05,))
    cases = [(3_000, ()), (3_000, (friction,)), (3_000, (friction, warming))]
    if not quick:
        cases.append((100_000, (friction, warming)))
    found = []
    for samples, effects in cases:
        model = cs.Model(
            compliance_deg_per_nm=nominal.compliance_deg_per_nm,
            free_play_deg=nominal.free_play_deg,
            effects=effects,
        )
        exact = cs.simulate(model, _programme(samples)).angle_deg
        assert exact is not None
        noise = NOISE_DEG * np.random.default_rng(1).normal(size=len(exact))
        recording = _programme(samples).with_angle(exact + noise)
        wall, cpu = time.perf_counter(), time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            diagnosis = cs.diagnose(recording, drive)
            diagnosis.write(Path(folder))
        found.append(
            {
                "samples": len(recording),
                "effects": [effect.name for effect in effects],
                "verdict": diagnosis.verdict,
                "seconds": time.perf_counter() - wall,
                "cpu_seconds": time.process_time() - cpu,
            }
        )
        print(f"  {len(recording):,} samples: {found[-1]['seconds']:.1f} s")
    return found


def _programme(samples: int) -> cs.Recording:
    """Nested loops at four rates, evenly sampled, warming up."""
    paths = [(share * np.array(TORQUES_NM), rate) for share, rate in RUNS]
    step = sum(float(np.abs(np.diff(path)).sum()) / rate for path, rate in paths) / samples
    torque, time_s, run = [], [], []
    begun = 0.0
    for number, (path, rate) in enumerate(paths, 1):
        turns = np.r_[0.0, np.cumsum(np.abs(np.diff(path)) / rate)]
        clock = np.arange(0.0, turns[-1], step)
        torque.append(np.interp(clock, turns, path))
        time_s.append(begun + clock)
        run.append(np.full(len(clock), number))
        begun += float(turns[-1]) + 200.0
    at = np.concatenate(time_s)
    return cs.Recording.from_arrays(
        np.concatenate(torque),
        time_s=at,
        run=np.concatenate(run),
        temperature_c=20.0 + 6.0 * (1.0 - np.exp(-at / 1000.0)),
    )


if __name__ == "__main__":
    for row in measure_diagnoses():
        print(row)
