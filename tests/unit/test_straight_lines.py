"""Straight lines through the middle of a loop read exact play, compliance and friction."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.report.play_and_stiffness import mean_and_interval
from cyclosweep.report.straight_lines import straight_lines
from tests.support.dry_friction import friction_that_builds_up


@pytest.mark.parametrize("rows", [240, 361])
@pytest.mark.parametrize("compliance", [2.7, 8.1])
def test_lines_without_friction_are_read_exactly(rows: int, compliance: float) -> None:
    """Read at the middles of the bins of the angle, the play was half a degree off."""
    torque = np.interp(np.linspace(0.0, 4.0, rows), [0.0, 1.0, 3.0, 4.0], [0.0, 6.0, -6.0, 0.0])
    angle = 3.0 + 28.0 * np.sign(torque) + compliance * torque
    (lines,) = straight_lines(cs.Recording.from_arrays(torque_nm=torque, angle_deg=angle))
    assert lines.play_deg == pytest.approx(56.0, abs=1e-9)
    assert lines.compliance_deg_per_nm == pytest.approx(compliance, rel=1e-9)
    assert abs(lines.friction_nm) < 1e-9


def test_a_loop_of_few_readings_is_read_without_bias() -> None:
    branch = np.r_[0:9:60j, 9:-9:120j, -9:0:60j]
    elastic = branch - 0.3 * np.sign(np.gradient(branch))
    angle = 28.0 * np.sign(elastic) + 2.7 * elastic
    (lines,) = straight_lines(cs.Recording.from_arrays(torque_nm=branch, angle_deg=angle))
    assert lines.play_deg == pytest.approx(56.0, abs=0.05)
    assert lines.compliance_deg_per_nm == pytest.approx(2.7, rel=0.003)
    assert lines.friction_nm == pytest.approx(0.3, rel=0.03)


@pytest.mark.parametrize(("rows", "runs"), [(60, 3), (60, 6), (200, 6)])
def test_intervals_of_friction_hold_the_true_one(rows: int, runs: int) -> None:
    """Read below a fifth of the load, too, as friction builds up, 20 N m came out as 19.3."""
    q = np.linspace(0.0, 600.0, rows)
    torque = np.r_[q, q[-2::-1], -q[1:], -q[-2::-1]]
    elastic = torque - friction_that_builds_up(torque, 20.0)
    angle = 0.32 * np.sign(elastic) + 0.00036 * elastic
    every, number = np.tile(torque, runs), np.repeat(np.arange(runs) + 1, len(torque))
    estimates, held = [], 0
    for seed in range(40):
        noise = 0.001 * np.random.default_rng(seed).standard_normal(len(every))
        loops = cs.Recording.from_arrays(every, np.tile(angle, runs) + noise, run=number)
        mean, ends = mean_and_interval([line.friction_nm for line in straight_lines(loops)])
        assert mean is not None
        assert ends is not None
        estimates.append(mean)
        held += ends[0] <= 20.0 <= ends[1]
    assert np.mean(estimates) == pytest.approx(20.0, rel=0.005)
    assert held >= 34  # of 40; 38 are expected
