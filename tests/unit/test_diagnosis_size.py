"""Sizes of effects and their intervals."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.fitting.fit import ContactFit, fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.testability import (
    recalibrated_twist,
    spread_of_size,
)
from cyclosweep.diagnosis.prepare.noise_estimate import estimate_noise
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.simulation.effects import Shape, effects
from tests.support.arrays import Floats
from tests.support.bench_rig import record

KNOWN = {effect.name: effect for effect in effects()}


def fitted(
    name: str, shape: Shape, twist: Floats, torque: Floats, run: npt.NDArray[np.int64]
) -> ContactFit:
    recording = cs.Recording.from_arrays(torque, twist, run=run)
    drive = cs.Drive.reference_87()
    problem = prepare(recording, drive.nominal_line("input"), int(drive.output_pin_count))
    library = build_library(problem.history, problem.fitted, tuple(KNOWN.values()))
    use = problem.fitted
    basis = flexible_basis(problem, library, None)
    noise = estimate_noise(
        problem.angle_deg[use], basis, problem.gap[use], 0.0, problem.weight[use]
    )
    return fit(problem, noise, (Term(KNOWN[name], shape),))


@pytest.mark.parametrize(
    ("name", "shape", "made"),
    [
        ("dial_eccentricity", {"order": 1.0}, lambda t, a: 1.2 * np.cos(np.radians(a) - 0.4)),
        (
            "overload_softening",
            {"onset_nm": 15.0, "power": 2.0},
            lambda t, a: 0.008 * np.sign(t) * np.maximum(np.abs(t) - 15.0, 0.0) ** 2,
        ),
    ],
)
def test_standard_error_of_a_size_is_its_spread(
    name: str, shape: Shape, made: Callable[[Floats, Floats], Floats]
) -> None:
    torque = np.tile(np.r_[np.linspace(1, 25, 80), np.linspace(25, 1, 80)], 4)
    torque[320:] *= -1
    run = np.repeat(np.arange(4), 160)
    rng = np.random.default_rng(5)
    plain = 30 * np.sign(torque) + 2.7 * torque
    sizes, errors = [], []
    for _ in range(40):
        angle = plain + made(torque, plain) + 0.2 * rng.normal(size=len(torque))
        found = fitted(name, shape, angle, torque, run)
        sizes.append(np.max(np.abs(recalibrated_twist(found, 0))))
        errors.append(spread_of_size(found, 0, found.covariance_within_bounds))
    # Forty draws tell a spread within a quarter, nineteen times in twenty.
    assert np.median(errors) == pytest.approx(np.std(sizes), rel=0.35)


def test_two_causes_are_not_put_down_to_free_offsets_of_the_runs() -> None:
    found = cs.diagnose(
        record(11, ("transmission_error", "thermal_drift"), d=20.0),
        cs.Drive.reference_87(),
        full=False,
    )
    assert {effect["name"] for effect in found.effects} == {"transmission_error", "thermal_drift"}
