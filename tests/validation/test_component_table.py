"""The 87:1 drive of the design notes over load and clearance, worked out by a prototype."""

from __future__ import annotations

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs

# Ring and hole clearance [mm], load over rated: twist [arcmin], its change over the crank [arcmin],
# active and effective output pins, largest force over 4 T / (Z R), active ring pins. Means over 360
# positions there, over 8 here.
TABLE = [
    (0.0, 0.0, 0.03, 0.0827, 0.0007, 7.64, 6.22, 1.019, 129),
    (0.0, 0.0, 1.0, 2.4063, 0.0086, 7.78, 6.33, 1.000, 135),
    (0.02, 0.05, 0.5, 7.0254, 0.302, 4.10, 3.32, 1.86, 29),
    (0.02, 0.05, 1.0, 8.5308, 0.213, 4.71, 3.87, 1.45, 40),
    (0.02, 0.05, 4.0, 15.437, 0.416, 6.33, 5.20, 1.06, 69),
    (0.02, 0.15, 1.0, 16.858, 0.735, 3.86, 3.11, 2.00, 39),
    (0.02, 0.15, 4.0, 23.966, 0.420, 5.40, 4.44, 1.19, 68),
]


def drive() -> cs.Drive:
    """The drive with both discs at equal reach and no shaft."""
    return cs.Drive.reference_87().replace(
        eccentricity_mm=0.9,
        ring_pin_circle_radius_mm=90.0,
        hole_clocking_deg=0.0,
        bush_wall_mm=0.0,
        disc_outer_radius_mm=86.0,
        shaft=(),
        output_stiffness_nm_per_arcmin=1e9,
        ring_pin_radius_mm=2.0,
        disc_width_mm=12.0,
        disc_1_reach_mm=16.0,
        disc_2_reach_mm=16.0,
        eccentric_bearing_stiffness_n_per_mm=4e5,
        pin_root_compliance=(1.23, 0.225, 5.11),
    )


@pytest.mark.parametrize("row", TABLE)
def test_a_row_of_the_table(row: tuple[float, ...]) -> None:
    ring, hole, load, twist, change, active, effective, force, ring_pins = row
    torque = 585 * load
    variant = drive().replace(ring_clearance_mm=ring, hole_clearance_mm=hole)
    space = cs.Space.table(variant, pl.DataFrame({"output_torque_nm": [torque]}))
    found = cs.sweep(space, model="components", solver="full").row(0, named=True)
    assert found["loaded_twist_arcmin"] == pytest.approx(twist, rel=0.01)
    assert found["transmission_error_pp_arcmin"] == pytest.approx(change, rel=0.05, abs=5e-5)
    assert found["active_output_pins_mean"] == pytest.approx(active, abs=0.45)
    assert found["effective_output_pins"] == pytest.approx(effective, rel=0.02)
    at_most = 4 * torque / (2 * 8 * 0.045)
    assert found["output_pin_force_max_n"] == pytest.approx(force * at_most, rel=0.02)
    assert found["active_ring_pins_mean"] == pytest.approx(ring_pins, rel=0.05)


@pytest.mark.parametrize(
    "gaps",
    [
        {"hole_clearance_mm": 0.03, "ring_clearance_mm": 0.01},
        {"ring_circle_enlargement_mm": 0.02, "profile_rotation_deg": 0.02},
    ],
)
def test_the_input_works_what_the_energy_gains(gaps: dict[str, float]) -> None:
    """On the way from one position to the next the input does the work of output and springs.

    U - T phi is the integral of the twist over a rising torque; its slope over the crank is what
    the input gives beyond T / N. The integral's nodes do not know where contacts begin: 5 %.
    """
    variant = drive().replace(**gaps)

    def stored(crank: float) -> float:
        """U - T phi = - integral of the twist over the torque [N m], from the unloaded drive."""
        nodes, weights = np.polynomial.legendre.leggauss(64)
        torques = 585.0 * ((nodes + 1) / 2) ** 2
        steps = 585.0 * (nodes + 1) / 2 * weights
        twists = [variant.loaded(float(torque), crank).twist_arcmin for torque in torques]
        return -float(np.dot(steps, twists)) * np.pi / 10_800

    crank, step = 0.25, 2e-3
    slope = (stored(crank + step) - stored(crank - step)) / (2 * step)
    extra = variant.loaded(585.0, crank).input_torque_nm - 585.0 / 87
    assert slope == pytest.approx(extra, rel=0.05)
    assert abs(extra) > 0.005


def test_doubling_widths_and_stiffnesses_with_the_torque_changes_no_motion() -> None:
    """With pins and bearings as soft in proportion, forces double and motions stay."""
    one = drive().replace(ring_clearance_mm=0.01, hole_clearance_mm=0.03)
    two = one.replace(
        youngs_modulus_gpa=412.0,
        eccentric_bearing_stiffness_n_per_mm=8e5,
    )
    first, second = one.loaded(400.0, 0.7), two.loaded(800.0, 0.7)
    assert second.twist_arcmin == pytest.approx(first.twist_arcmin, rel=1e-9)
    assert second.output_pin_forces_n == pytest.approx(2 * first.output_pin_forces_n, rel=1e-8)


def test_a_mirrored_torque_at_the_mirrored_crank_mirrors_the_twist() -> None:
    variant = drive().replace(ring_clearance_mm=0.01, hole_clearance_mm=0.03)
    forward, backward = variant.loaded(400.0, 0.7), variant.loaded(-400.0, -0.7)
    assert backward.twist_arcmin == pytest.approx(-forward.twist_arcmin, rel=1e-10)


def test_a_ring_pitch_of_the_crank_with_the_pins_clocked_back_changes_nothing() -> None:
    """The whole figure turned by one ring pitch is the same drive."""
    pitch = 360 / 88
    variant = drive().replace(ring_clearance_mm=0.01, hole_clearance_mm=0.03)
    # The crank goes on by a pitch; the pins, which turn back by pitch / N, must go on by one, too.
    turned = variant.replace(hole_clocking_deg=pitch * (1 + 1 / 87))
    there = turned.loaded(400.0, 0.7 + pitch * 3.141592653589793 / 180)
    assert there.twist_arcmin == pytest.approx(variant.loaded(400.0, 0.7).twist_arcmin, rel=1e-10)
