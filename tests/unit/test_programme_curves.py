"""Programmes of ramps, holds and sines are found again under the noise of the torque sensor."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.programme_curves import programme_curves
from cyclosweep.simulation.effects.history import Floats, Ints

NOISE = 1.0


def ramps(rows: int = 700) -> tuple[Floats, Floats]:
    """Clock and torque of a triangle."""
    time = np.linspace(0.0, 4.0, rows)
    return time, np.interp(time, [0.0, 1.0, 3.0, 4.0], [0.0, 900.0, -900.0, 0.0])


def staircase() -> tuple[Floats, Floats]:
    """Clock and torque of steps of 5 s, each held for a minute or so, read every second."""
    places, levels = [0.0], [0.0]
    rng = np.random.default_rng(3)
    for level in (150.0, 300.0, 450.0, 600.0, 750.0):
        places += [places[-1] + 5.0, places[-1] + 5.0 + rng.uniform(48.0, 75.0)]
        levels += [level, level]
    time = np.arange(0.5, places[-1])
    return time, np.interp(time, places, levels)


def sine() -> tuple[Floats, Floats]:
    """Clock and torque of a distorted sine of eleven readings a cycle."""
    time = np.arange(0.0, 60.0, 0.3)
    return time, 500.0 * np.sin(1.9 * time) + 20.0 * np.sin(3.8 * time + 1.0) + 0.1 * time


def found(time: Floats, torque: Floats, piece: Ints, seed: int) -> Floats:
    read = torque + NOISE * np.random.default_rng(seed).normal(size=len(torque))
    run = np.zeros(len(time), np.int64)
    curves, _ = programme_curves(read, read, time, piece, run, NOISE)
    return np.asarray(curves[0])


def pieces(torque: Floats, off: int = 0) -> Ints:
    """Label of the piece of each row, cut at the turning points or beside them."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(torque))) != 0) + 1 + off
    return np.searchsorted(turns, np.arange(len(torque)), side="right").astype(np.int64)


@pytest.mark.parametrize("off", [0, -6, 6])
def test_corners_of_ramps_are_found_where_noise_hides_them(off: int) -> None:
    time, torque = ramps()
    error = found(time, torque, pieces(torque, off), 1) - torque
    assert np.nanstd(error) < 0.2 * NOISE
    assert np.isfinite(error).mean() > 0.98
    assert np.nanmax(np.abs(error)) < 1.5 * NOISE


def test_steps_and_holds_are_told_apart() -> None:
    time, torque = staircase()
    curves = found(time, torque, np.zeros(len(time), np.int64), 2)
    error = curves - torque
    assert np.isfinite(error).mean() > 0.9
    assert np.nanstd(error) < 0.5 * NOISE
    held = np.r_[False, np.diff(torque) == 0.0] & np.isfinite(curves)
    still = np.abs(np.diff(curves))[held[1:] & held[:-1]]
    assert np.mean(still == 0.0) > 0.95


def short_ramps() -> tuple[Floats, Floats]:
    """Clock and torque of nested loops with holds, a dozen readings to each of their lines."""
    levels = [0.0, 900.0, 400.0, 800.0, 200.0, 700.0, 100.0, 600.0, 0.0]
    places, loads = [0.0], [0.0]
    for k, level in enumerate(levels[1:]):
        places += [places[-1] + (6.0, 12.0, 20.0)[k % 3]] * 2
        places[-1] += 15.0
        loads += [level, level]
    time = np.arange(0.3, places[-1])
    return time, np.interp(time, places, loads)


@pytest.mark.parametrize("off", [-3, 0, 2])
@pytest.mark.parametrize("seed", range(5))
def test_corners_are_found_where_pieces_end_elsewhere(off: int, seed: int) -> None:
    """Readings between a corner and the end of a piece were taken for one line with the next."""
    time, torque = short_ramps()
    error = found(time, torque, pieces(torque, off), seed) - torque
    assert np.isfinite(error).mean() > 0.97
    assert np.nanstd(error) < 0.45 * NOISE
    assert np.nanmax(np.abs(error)) < 2.2 * NOISE


def test_the_share_of_noise_in_a_curve_is_stated() -> None:
    """Its sum over the readings is the number of parameters of all lines."""
    time, torque = short_ramps()
    run = np.zeros(len(time), np.int64)
    errors, shares = [], []
    for seed in range(20):
        read = torque + NOISE * np.random.default_rng(seed).normal(size=len(torque))
        curves, share = programme_curves(read, read, time, pieces(torque), run, NOISE)
        there = np.isfinite(curves[0])
        errors.append(np.mean((curves[0] - torque)[there] ** 2))
        shares.append(np.mean(share[there]))
    assert np.mean(shares) * NOISE**2 == pytest.approx(np.mean(errors), rel=0.25)


def test_a_sine_of_few_readings_a_cycle_is_found() -> None:
    time, torque = sine()
    error = found(time, torque, pieces(torque), 3) - torque
    assert np.all(np.isfinite(error))
    assert np.std(error) < 0.4 * NOISE


def test_what_is_no_curve_is_left() -> None:
    rng = np.random.default_rng(4)
    torque = np.cumsum(rng.normal(size=300)) * 8.0
    curves = found(np.arange(300.0), torque, np.zeros(300, np.int64), 5)
    off = np.abs(curves - torque)[np.isfinite(curves)]
    assert len(off) < 150 or np.median(off) < 2.0 * NOISE


@pytest.mark.parametrize(
    ("programme", "spread_deg", "memory", "noise_nm"),
    [("ramps", 0.003, 0.97, 1.5), ("staircase", 0.002, 0.8, 1.0), ("sine", 0.0018, 0.5, 1.5)],
)
def test_nothing_is_found_in_noise_of_angle_and_torque(
    programme: str, spread_deg: float, memory: float, noise_nm: float
) -> None:
    """One in four such recordings was an alarm: drag, friction, or a loop by rate."""
    time, torque = {"ramps": ramps, "staircase": staircase, "sine": sine}[programme]()
    alarms = 0
    for seed in range(6):
        rng = np.random.default_rng([seed, 8])
        scatter = rng.normal(size=len(time))
        for k in range(1, len(time)):
            scatter[k] = memory * scatter[k - 1] + np.sqrt(1.0 - memory**2) * scatter[k]
        recording = cs.Recording.from_arrays(
            torque_nm=torque + noise_nm * rng.normal(size=len(time)),
            angle_deg=0.05 * np.sign(torque) + 0.00036 * torque + spread_deg * scatter,
            time_s=time if programme != "ramps" else 100.0 * time,
            side="output",
            history="continuous",
        )
        verdict = cs.diagnose(recording, cs.Drive.reference_87(), full=False).verdict
        alarms += verdict not in ("NOTHING_MISSING", "INSUFFICIENT_DATA")
    assert alarms == 0
