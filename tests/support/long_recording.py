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


def driven_through_friction(
    samples: int, limit_nm: float, noise_deg: float, *, loops: int = 4, seed: int = 2
) -> cs.Recording:
    """Drive behind a friction that takes this torque, by arithmetic of its own.

    The play is crossed where friction lets the torque through, and not where it changes sign. Until
    the load first exceeds the friction, the shaft stands in the middle of the play.

    Parameters
    ----------
    samples : int
    limit_nm : float
        Friction torque [N m].
    noise_deg : float
        Standard deviation of the noise of a sample [deg].
    loops : int
        Loops between -12 and 12 N m, sinusoidal in time.
    seed : int
        Seed of the noise.

    Returns
    -------
    Recording
        Its clock goes on for 300 s a loop.
    """
    torque = 12.0 * np.sin(2.0 * np.pi * loops * np.arange(samples) / samples)
    passed = _past_friction(torque, limit_nm)
    angle = 28.0 * np.sign(passed) + 2.73 * passed
    noise = noise_deg * np.random.default_rng(seed).normal(size=samples)
    time = 300.0 * loops * np.arange(samples) / samples
    return cs.Recording.from_arrays(torque, angle + noise, time_s=time)


def flanks_through_friction(recording: cs.Recording, limit_nm: float) -> npt.NDArray[Any]:
    """Flank in contact in a recording of `driven_through_friction`; zero before the first load."""
    return np.asarray(np.sign(_past_friction(recording.torque_nm, limit_nm)))


def _past_friction(torque_nm: npt.NDArray[Any], limit_nm: float) -> npt.NDArray[Any]:
    """Torque behind a friction that takes up to its limit (play operator) [N m]."""
    passed = np.zeros(len(torque_nm))
    state = 0.0
    for k, torque in enumerate(torque_nm):
        passed[k] = state = min(max(state, torque - limit_nm), torque + limit_nm)
    return passed
