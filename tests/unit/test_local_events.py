"""Events of a few runs are told from noise, outliers and departures that every run shows."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.local_events import event_rows
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.simulation.effects.history import Floats, Ints

ROWS, RUNS = 200, 8


def material() -> tuple[Floats, Ints]:
    x = np.tile(np.linspace(-1.0, 1.0, ROWS), RUNS)
    return orthonormal(np.column_stack([x**k for k in range(6)])), np.repeat(np.arange(RUNS), ROWS)


def autoregression(rng: np.random.Generator, rho: float) -> Floats:
    out: Floats = np.sqrt(1.0 - rho**2) * rng.normal(size=ROWS * RUNS)
    for row in range(1, len(out)):
        out[row] += rho * out[row - 1]
    return out


def test_an_event_in_one_run_is_found() -> None:
    basis, run = material()
    angle = np.random.default_rng(1).normal(size=len(run))
    angle[230:262] += 15.0
    found = event_rows(angle, basis, run)
    assert found[232:260].all()
    assert found.sum() <= 32 + 16


@pytest.mark.parametrize("rho", [0.0, 0.9, 0.99])
def test_no_event_is_found_in_noise(rho: float) -> None:
    basis, run = material()
    for seed in range(20):
        rng = np.random.default_rng(seed)
        assert not event_rows(autoregression(rng, rho), basis, run).any()
        assert not event_rows(rng.standard_t(3, len(run)), basis, run).any()


def test_outliers_are_no_event() -> None:
    basis, run = material()
    rng = np.random.default_rng(2)
    angle = rng.normal(size=len(run))
    angle[rng.choice(len(run), 60, replace=False)] += 40.0
    assert not event_rows(angle, basis, run).any()


def test_what_every_run_shows_is_no_event() -> None:
    basis, run = material()
    angle = np.random.default_rng(3).normal(size=len(run))
    angle[(np.arange(len(run)) % ROWS) < 16] += 15.0
    assert not event_rows(angle, basis, run).any()


def test_a_slip_in_one_run_is_said_with_its_place() -> None:
    """It was taken for noise of autocorrelation 0.8, three times too large: NOTHING_MISSING."""
    rng = np.random.default_rng(4)
    up = np.r_[np.linspace(0.5, 15.0, 60), np.linspace(15.0, 0.5, 60)]
    torque = np.tile(np.r_[up, -up], RUNS)
    run = np.repeat(np.arange(1, RUNS + 1), 240)
    angle = 28.0 * np.sign(torque) + 2.7 * torque + 0.045 * rng.normal(size=len(torque))
    angle[:40] -= 3.0 * np.linspace(1.0, 0.0, 40) ** 0.5
    recording = cs.Recording.from_arrays(
        torque_nm=torque,
        angle_deg=angle,
        run=run,
        time_s=0.5 * np.arange(len(torque)),
        side="input",
    )
    found = cs.diagnose(recording, cs.Drive.reference_87())
    assert found.verdict == "UNKNOWN_PHYSICS"
    assert found.answer.noise.sigma_deg == pytest.approx(0.045, rel=0.1)
    assert "run 1" in found.statement
