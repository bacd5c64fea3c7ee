"""Speed of modes and transients beside SciPy and NumPy in the same run; prints ratios.

``python benches/dynamics.py [--json FILE]``. Processor time of the process, fastest of several
runs: other work on the machine makes it longer, never shorter.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp

import cyclosweep as cs
from cyclosweep.dynamics import natural_frequencies_hz

GAP = math.radians(28)
INERTIAS = (0.0035, 4e-4, 2.1e-6, 1.6e-6, 5 / 87**2)
STIFFNESSES = (2e4, 84.0, 28.0, 132.0)
TORQUE = 7.2575


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    arguments = parser.parse_args()
    figures = {**_modes(), **_columns(), **_transients()}
    for name, value in figures.items():
        print(f"{name}: {value:,.4g}")
    if arguments.json:
        arguments.json.write_text(json.dumps(figures, indent=1) + "\n")


def _fastest(work: Callable[[], object], rounds: int = 5) -> float:
    """Least processor time of a call [s]."""
    times = []
    for _ in range(rounds):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


def _modes() -> dict[str, float]:
    rng = np.random.default_rng(1)
    count = 100_000
    inertias = np.array(INERTIAS) * 10 ** rng.uniform(-0.3, 0.3, (count, 5))
    stiffnesses = np.array(STIFFNESSES) * 10 ** rng.uniform(-0.3, 0.3, (count, 4))
    ours = _fastest(lambda: natural_frequencies_hz(inertias, stiffnesses))
    few = 20_000
    theirs = _fastest(lambda: _numpy_modes(inertias[:few], stiffnesses[:few]), 3)
    agree = np.abs(
        _numpy_modes(inertias[:few], stiffnesses[:few])[:, 1:]
        / natural_frequencies_hz(inertias[:few], stiffnesses[:few])[:, 1:]
        - 1
    ).max()
    return {
        "chains of 5 inertias a second and core": count / ours,
        "the same by numpy.linalg.eigvalsh on the stack": few / theirs,
        "ratio": (count / ours) / (few / theirs),
        "largest relative difference": float(agree),
    }


def _numpy_modes(
    inertias: npt.NDArray[np.float64], stiffnesses: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    n = inertias.shape[1]
    matrix = np.zeros((len(inertias), n, n))
    for k in range(stiffnesses.shape[1]):
        stiffness = stiffnesses[:, k]
        matrix[:, k, k] += stiffness / inertias[:, k]
        matrix[:, k + 1, k + 1] += stiffness / inertias[:, k + 1]
        coupling = -stiffness / np.sqrt(inertias[:, k] * inertias[:, k + 1])
        matrix[:, k, k + 1] = matrix[:, k + 1, k] = coupling
    squares = np.linalg.eigvalsh(matrix)
    return np.asarray(np.sqrt(np.maximum(squares, 0)) / math.tau)


def _columns() -> dict[str, float]:
    space = cs.Space.grid(
        cs.Drive.reference_87(),
        output_pin_diameter_mm=cs.linspace(12, 18, 100),
        output_pin_length_mm=cs.linspace(20, 50, 100),
        load_inertia_kg_m2=cs.linspace(1, 20, 100),
    )
    query = cs.scan(space).select("natural_frequency_1_hz")
    three = cs.scan(
        cs.Space.grid(
            cs.Drive.reference_87().replace(
                flange_inertia_kg_m2=0.012, coupling_stiffness_nm_per_rad=1e6
            ),
            output_pin_diameter_mm=cs.linspace(12, 18, 100),
            output_pin_length_mm=cs.linspace(20, 50, 100),
            load_inertia_kg_m2=cs.linspace(1, 20, 100),
        )
    ).select("natural_frequency_1_hz", "natural_frequency_2_hz")
    return {
        "sweep: first frequency of 2 inertias, variants a second and core": 1e6
        / _fastest(query.collect),
        "sweep: both frequencies of 3 inertias, variants a second and core": 1e6
        / _fastest(three.collect),
    }


def _transients() -> dict[str, float]:
    train = cs.Train(INERTIAS, STIFFNESSES, [0.0, GAP, 0.0, 0.0])
    core_calls = 200

    def run(samples: int) -> object:
        ends = {0: TORQUE, 4: -TORQUE}
        return train.transient({0: -TORQUE, 4: TORQUE}, 0.1, samples, preload_nm=ends)

    def many(samples: int) -> None:
        for _ in range(core_calls):
            run(samples)

    core = train.core()
    angles = [sum(t for t, _ in core.static_twists([TORQUE] * 4)[k:]) for k in range(5)]
    times = np.array([0.0, 0.1])
    torques = np.array([[-TORQUE, 0, 0, 0, TORQUE]] * 2)
    at = np.linspace(0, 0.1, 100)

    def core_only() -> None:
        for _ in range(core_calls):
            core.transient(angles, [0.0] * 5, [[]] * 4, times, torques, at)

    core_time = _fastest(core_only) / core_calls
    whole_time = _fastest(lambda: many(100)) / core_calls
    scipy_time = _fastest(lambda: _scipy_transient(angles), 3)
    return {
        "transient of .1 s, 5 inertias, 9 events, 100 samples, core [us]": 1e6 * core_time,
        "the same from Python, train.transient [us]": 1e6 * whole_time,
        "the same by scipy DOP853 with events, rtol 1e-10 [us]": 1e6 * scipy_time,
        "ratio to the core": scipy_time / core_time,
    }


def _scipy_transient(angles: list[float]) -> int:
    inertias, stiffnesses = np.array(INERTIAS), np.array(STIFFNESSES)
    torques = np.array([-TORQUE, 0, 0, 0, TORQUE])

    def rates(_: float, state: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        twist = state[:4] - state[1:5]
        twist[1] = np.sign(twist[1]) * max(abs(twist[1]) - GAP, 0.0)
        carried = stiffnesses * twist
        total = torques.copy()
        total[:4] -= carried
        total[1:] += carried
        return np.concatenate([state[5:], total / inertias])

    events = [lambda _, y, s=side: (y[1] - y[2]) - s * GAP for side in (-1, 1)]
    state = np.r_[angles, np.zeros(5)]
    solved = solve_ivp(
        rates, (0, 0.1), state, method="DOP853", rtol=1e-10, atol=1e-12, events=events
    )
    return sum(len(times) for times in solved.t_events or [])


if __name__ == "__main__":
    main()
