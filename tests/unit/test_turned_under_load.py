"""A shaft that is turned under held loads shows orders of the mesh beyond the usual ones."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.effects import find
from tests.support.searches import DRIVE, search_of_recording

LEVELS_NM = (4.0, 10.0, -4.0, -10.0, 7.0)
TURNS = 1.5


def turned(positions: int, orders: tuple[int, ...]) -> cs.Recording:
    """Recording of a transmission error, at each of some loads past so many positions."""
    line = DRIVE.nominal_line("input")
    place = np.linspace(0.0, 360.0 * TURNS, positions)
    wave = np.sum([np.sin(np.radians(order * place + 40.0)) for order in orders], axis=0)
    torque = np.concatenate(
        [level + 0.25 * np.sin(np.linspace(0, 9, positions)) for level in LEVELS_NM]
    )
    run = np.repeat(np.arange(len(LEVELS_NM)), positions)
    noise = 0.03 * np.random.default_rng(5).normal(size=len(torque))
    stiff = line.compliance_deg_per_nm * torque + line.free_play_deg * np.sign(torque)
    return cs.Recording(
        torque_nm=torque,
        angle_deg=stiff + np.tile(wave, len(LEVELS_NM)) + noise,
        time_s=np.arange(len(torque), dtype=float),
        run=run,
        crank_deg=np.tile(place, len(LEVELS_NM)),
        name="turned",
    )


@pytest.mark.parametrize(("positions", "looked_for"), [(10, False), (12, True), (240, True)])
def test_higher_orders_are_looked_for_where_positions_are_many(
    positions: int, looked_for: bool
) -> None:
    history = search_of_recording(turned(positions, (2, 5))).problem.history
    for name in ("transmission_error", "phase_dependent_compliance"):
        single = [dict(shape) for shape in find(name).shapes(history)]
        assert ({"order_1": 5.0} in single) is looked_for


def test_the_error_of_a_mesh_that_is_turned_under_load_is_named_with_its_orders() -> None:
    found = cs.diagnose(turned(240, (2, 5)), DRIVE, full=False)
    assert found.verdict == "IDENTIFIED"
    (effect,) = found.effects
    assert effect["name"] == "transmission_error"
    assert set(effect["parameters"]) == {"cos_2", "sin_2", "cos_5", "sin_5"}
    # One position of hundreds is no place: it is said in which part of a turn the error is largest.
    parts = [region["crank_deg"] for region in found.mismatch["regions"] if region["crank_deg"]]
    assert parts
    assert all(last - first == 30.0 for first, last in parts)
    assert f"mesh positions {parts[0][0]:.4g} to {parts[0][1]:.4g} deg" in found.statement
