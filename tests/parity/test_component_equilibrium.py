"""The core's equilibria against a residual written anew and solved by SciPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import fsolve

import cyclosweep as cs
from tests.parity.component_residual import Reals, residual

DESIGNS = 200


def random_drive(seed: int) -> tuple[cs.Drive, float, float]:
    """A drive that can be built, a torque [N m] and a crank angle [rad]."""
    rng = np.random.default_rng(seed)
    ratio = int(rng.integers(9, 120))
    ring = rng.uniform(30, 110)
    e = rng.uniform(0.35, 0.85) * ring / (ratio + 1)
    pins, discs = int(rng.integers(4, 13)), int(rng.integers(1, 4))
    circle = ring * rng.uniform(0.45, 0.55)
    pitch = 2 * circle * math.sin(math.pi / pins)
    diameter = max(0.25 * min(pitch, 0.5 * ring) - e, 0.05 * pitch)
    width = rng.uniform(4, 16)
    size = ring / 90
    individual = rng.random() < 0.4
    load = rng.uniform(10, 60) * width * (ratio + 1) * e * ratio * discs / 4e3
    drive = cs.Drive.reference_87().replace(
        ratio=ratio,
        disc_count=discs,
        eccentricity_mm=e,
        ring_pin_circle_radius_mm=ring,
        hole_clocking_deg=rng.uniform(-5, 5),
        output_pin_count=pins,
        output_pin_circle_radius_mm=circle,
        output_pin_diameter_mm=diameter,
        bush_wall_mm=0.0,
        disc_outer_radius_mm=0.95 * ring,
        disc_bore_radius_mm=0.2 * circle,
        output_torque_nm=load,
        shaft=(),
        output_stiffness_nm_per_arcmin=100.0,
        ring_pin_radius_mm=0.05 * 2 * math.pi * ring / (ratio + 1),
        disc_width_mm=width,
        ring_clearance_mm=rng.uniform(0, 0.03) * size,
        ring_circle_enlargement_mm=rng.uniform(0, 0.02) * size * (rng.random() < 0.3),
        profile_rotation_deg=rng.uniform(0, 0.02) * (rng.random() < 0.3),
        hole_clearance_mm=rng.uniform(0, 0.08) * size,
        eccentric_bearing_stiffness_n_per_mm=10 ** rng.uniform(4.8, 6),
        eccentric_bearing_clearance_mm=rng.uniform(0, 0.01) * size * (rng.random() < 0.3),
        disc_1_reach_mm=rng.uniform(0.4, 1) * diameter,
        disc_2_reach_mm=rng.uniform(0.8, 1.6) * diameter,
        disc_3_reach_mm=rng.uniform(1.2, 2) * diameter,
        ring_gap_errors_mm=tuple(rng.uniform(0, 0.01, ratio + 1) * size) if individual else None,
        hole_gap_errors_mm=tuple(rng.uniform(0, 0.01, pins) * size) if individual else None,
    )
    return drive, load, rng.uniform(0, 2 * math.pi)


def house_frame(state: dict[str, object], drive: dict[str, object], crank: float) -> Reals:
    """The core's unknowns as the residual's [mm]."""
    discs = np.array(state["discs"]) * 1e3
    unknowns = [float(state["twist"]) * float(drive["pin_circle_radius"]) * 1e3]  # type: ignore[arg-type]
    for disc, (turn, along, across) in enumerate(discs):
        at = crank + 2 * math.pi * disc / len(discs)
        c, s = math.cos(at), math.sin(at)
        unknowns += [turn, along * c - across * s, along * s + across * c]
    return np.array(unknowns)


def solved_by_scipy(
    start: Reals, mechanism: dict[str, object], torque: float, crank: float
) -> Reals | None:
    """SciPy's equilibrium; none where it gets stuck at a kink, as a method without bounds may."""
    force = torque / float(mechanism["pin_circle_radius"])  # type: ignore[arg-type]

    def out_of_balance(unknowns: Reals) -> Reals:
        return residual(unknowns, mechanism, torque * 1e3, crank) / force

    found: Reals
    found, information, _, _ = fsolve(out_of_balance, start, xtol=1e-13, full_output=True)
    return found if np.max(np.abs(information["fvec"])) < 1e-10 else None


def test_a_residual_written_anew_agrees_on_random_designs() -> None:
    """SciPy finds the same equilibrium to 1e-8, from a start moved off it."""
    worst, checked = 0.0, 0
    for seed in range(DESIGNS):
        drive, torque, crank = random_drive(seed)
        study = drive.study()
        assert study.explain(0) is None, (seed, study.explain(0))
        parts = drive.part_study("full")
        state, mechanism = (
            parts.state(study, 0, torque, crank, "full"),
            parts.mechanism(study, 0),
        )
        assert state["converged"], seed
        ours = house_frame(dict(state), dict(mechanism), crank)
        force = torque / mechanism["pin_circle_radius"]
        left = residual(ours, dict(mechanism), torque * 1e3, crank)
        assert np.max(np.abs(left)) < 1e-8 * force, seed
        start = ours * (1 + 0.01 * np.sin(np.arange(len(ours)) + seed))
        theirs = solved_by_scipy(start, dict(mechanism), torque, crank)
        if theirs is not None:
            checked += 1
            worst = max(worst, abs(theirs[0] / ours[0] - 1))
    assert checked > 0.9 * DESIGNS
    assert worst < 1e-8


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_the_residual_can_fail(factor: float) -> None:
    """A wrong stiffness is seen."""
    drive, torque, crank = random_drive(1)
    study = drive.study()
    parts = drive.part_study("full")
    state, mechanism = parts.state(study, 0, torque, crank, "full"), parts.mechanism(study, 0)
    wrong = {**mechanism, "ring_stiffness": factor * mechanism["ring_stiffness"]}
    ours = house_frame(dict(state), dict(mechanism), crank)
    left = residual(ours, wrong, torque * 1e3, crank)
    assert np.max(np.abs(left)) > 0.01 * torque / mechanism["pin_circle_radius"]
