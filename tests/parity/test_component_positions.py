"""Columns, solved at several positions of the crank side by side, against single equilibria."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cyclosweep as cs
from tests.parity.test_component_equilibrium import random_drive

POSITIONS = 8
ACTIVE = 0.01


def positions(drive: cs.Drive) -> list[float]:
    """Cranks over one period of the output pins, or over all where contacts of a kind differ."""
    pins, holes = drive.ring_gap_errors_mm or (), drive.hole_gap_errors_mm or ()
    differ = [len(set(errors)) > 1 for errors in (pins, holes)]
    pitch = 2 * math.pi / drive.output_pin_count
    period = pitch if differ[0] else pitch * drive.ratio / (drive.ratio + 1)
    periods = drive.output_pin_count if any(differ) else 1
    return [period * k / POSITIONS for k in range(POSITIONS * periods)]


@pytest.mark.parametrize("seed", range(40))
def test_columns_are_those_of_single_equilibria(seed: int) -> None:
    drive, load, _ = random_drive(seed)
    row = cs.scan(cs.Space.grid(drive), model="components", solver="full").collect()
    cranks = positions(drive)
    states = [drive.loaded(load, crank) for crank in cranks]
    shaft = sum(float(state.budget["twist_arcmin"][-1]) for state in states) / len(states)

    def expect(column: str, value: float, tolerance: float = 1e-8) -> None:
        assert row[column][0] == pytest.approx(value, rel=tolerance), column

    expect("loaded_twist_arcmin", float(np.mean([state.twist_arcmin for state in states])))
    for column, name in (
        ("twist_ring_contacts_arcmin", "ring contacts"),
        ("twist_eccentric_bearing_arcmin", "eccentric bearing"),
    ):
        parts = [
            state.budget.filter(state.budget["component"] == name)["twist_arcmin"].item()
            for state in states
        ]
        expect(column, float(np.mean(parts)))
    pins = np.array([np.ravel(state.output_pin_forces_n) for state in states])
    ring = np.array([np.ravel(state.ring_pin_forces_n) for state in states])
    expect("output_pin_force_max_n", float(pins.max()))
    expect("ring_pin_force_max_n", float(ring.max()))
    active = (pins > ACTIVE * pins.max(axis=1, keepdims=True)).sum(axis=1)
    expect("active_output_pins_mean", float(active.mean()))
    expect("active_output_pins_min", float(active.min()))
    expect("effective_output_pins", float((pins.sum(1) ** 2 / (pins**2).sum(1)).mean()))
    active = (ring > ACTIVE * ring.max(axis=1, keepdims=True)).sum(axis=1)
    expect("active_ring_pins_mean", float(active.mean()))
    reverse = [drive.loaded(-0.03 * load, crank).twist_arcmin for crank in cranks]
    low = [drive.loaded(0.03 * load, crank).twist_arcmin for crank in cranks]
    expect("lost_motion_3pct_arcmin", float(np.mean(low) - np.mean(reverse)), 1e-7)
    flange = np.array([1 / state.tangent_stiffness_nm_per_arcmin for state in states])
    flange -= shaft / load
    stiffness = float(1 / (1 / np.mean(1 / flange) + shaft / load))
    expect("tangent_stiffness_100pct_nm_per_arcmin", stiffness)
