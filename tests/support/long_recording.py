"""Long recordings made with the package's own simulation, for tests and benches of thinning."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

import cyclosweep as cs
from cyclosweep.simulation.simulate import EffectValue

COMPLIANCE = 19.8 / 7.2575
"""Compliance of the reference drive at the input [deg/(N m)]."""
TOP_NM = 31.0
HOLD_S = 40.0
AMPLITUDES = (1.0, 0.4, 0.7, 0.25, 1.0, 0.55, 0.85, 0.3)
RATES_NM_PER_S = (0.5, 2.0, 0.5, 0.25, 1.0, 0.5, 0.25, 2.0)


def friction(twist_deg: float = 0.15) -> EffectValue:
    """Coulomb friction worth this twist, presliding over about 0.8 deg."""
    shape = {"slip_deg": 0.8, "scatter": 0.6, "skew": 0.0, "slack": 0.0}
    return EffectValue("friction_hysteresis", shape, (twist_deg / COMPLIANCE,))


def warming(deg_per_k: float = 0.02) -> EffectValue:
    """Datum that follows the temperature."""
    return EffectValue("thermal_drift", {"datum": 1.0}, (deg_per_k,))


def long_programme(samples: int) -> cs.Recording:
    """Eight runs of nested loops with a dwell each, at four rates, sampled evenly in time.

    Parameters
    ----------
    samples : int
        About how many samples.

    Returns
    -------
    Recording
        Without an angle.
    """
    paths = [
        np.array([0.4, m, -m, 0.55 * m, -0.4 * m, 0.8 * m, 0.8 * m, 0.3 * m, 0.8 * m, 0.4])
        for m in TOP_NM * np.array(AMPLITUDES)
    ]
    pairs = list(zip(paths, RATES_NM_PER_S, strict=True))
    duration = sum(float(np.abs(np.diff(p)).sum()) / rate + HOLD_S for p, rate in pairs)
    step = duration / samples
    torque: list[npt.NDArray[Any]] = []
    time: list[npt.NDArray[Any]] = []
    run: list[npt.NDArray[Any]] = []
    clock = 0.0
    for number, (path, rate) in enumerate(pairs, 1):
        legs = [path[:1]]
        for a, b in pairwise(path):
            count = int((HOLD_S if a == b else abs(b - a) / rate) / step)
            legs.append(np.linspace(a, b, max(count, 2) + 1)[1:])
        torque.append(np.concatenate(legs))
        time.append(clock + step * np.arange(len(torque[-1])))
        run.append(np.full(len(torque[-1]), number))
        clock = float(time[-1][-1]) + 200.0
    at, which = np.concatenate(time), np.concatenate(run)
    return cs.Recording.from_arrays(
        np.concatenate(torque),
        time_s=at,
        run=which,
        crank_deg=45.0 * (which % 4),
        temperature_c=20.0 + 6.0 * (1.0 - np.exp(-at / 2000.0)),
    )


def long_recording(
    samples: int, effects: Sequence[EffectValue] = (), *, noise_deg: float = 0.05, seed: int = 3
) -> cs.Recording:
    """Recording of `long_programme` with these effects and white noise.

    Parameters
    ----------
    samples : int
        About how many samples.
    effects : sequence of EffectValue
        What the published model leaves out.
    noise_deg : float
        Standard deviation of the noise of a sample [deg].
    seed : int
        Seed of the noise.

    Returns
    -------
    Recording
    """
    model = cs.Model(
        compliance_deg_per_nm=COMPLIANCE, free_play_deg=28.0, datum_deg=0.1, effects=tuple(effects)
    )
    angle = cs.simulate(model, programme := long_programme(samples)).angle_deg
    assert angle is not None
    noise = noise_deg * np.random.default_rng(seed).normal(size=len(programme))
    return programme.with_angle(angle + noise)
