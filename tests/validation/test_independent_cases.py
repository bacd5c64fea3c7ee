"""Pin forces and short-width coefficients of drives that others have published or computed."""

from __future__ import annotations

from typing import Any

import pytest

import cyclosweep as cs

COMMON: dict[str, Any] = {
    "output_pin_length_mm": 6.35,
    "youngs_modulus_gpa": 200.0,
    "poisson_ratio": 0.3,
    "input_power_kw": 0.1,
    "input_speed_rpm": 1000.0,
    "output_stiffness_nm_per_arcmin": 1.0,
}

# One newton metre on one disc: ring-pin circle of 85 mm, 18 ring pins, 6 output pins.
CODE_TO_CODE = cs.Drive(
    **COMMON,
    name="code-to-code unit case",
    ratio=17,
    disc_count=1,
    eccentricity_mm=1.3,
    ring_pin_circle_radius_mm=42.5,
    output_pin_count=6,
    output_pin_circle_radius_mm=32.9,
    output_pin_diameter_mm=5.0,
    disc_outer_radius_mm=38.7,
    disc_bore_radius_mm=20.0,
    output_torque_nm=1.0,
)

# 29:1, 116 N m out, e 1.25 mm, ring circle 105 mm, two discs, 4 output pins on 68 mm.
RATIO_29 = cs.Drive(
    **COMMON,
    name="29:1",
    ratio=29,
    disc_count=2,
    eccentricity_mm=1.25,
    ring_pin_circle_radius_mm=52.5,
    output_pin_count=4,
    output_pin_circle_radius_mm=34.0,
    output_pin_diameter_mm=10.0,
    disc_outer_radius_mm=47.0,
    disc_bore_radius_mm=15.0,
    output_torque_nm=116.0,
)


@pytest.mark.parametrize(
    ("drive", "column", "printed", "tolerance"),
    [
        (CODE_TO_CODE, "short_width_coefficient", 0.5506, 5e-5),
        (CODE_TO_CODE, "pin_force_max_n", 20.26, 5e-3),
        (RATIO_29, "pin_force_max_n", 1705.9, 5e-2),
        (RATIO_29, "short_width_coefficient", 1.25 * 30 / 52.5, 1e-12),
    ],
)
def test_printed_number(drive: cs.Drive, column: str, printed: float, tolerance: float) -> None:
    assert drive.evaluate()[column] == pytest.approx(printed, abs=tolerance)


def test_statics_of_two_discs_of_eight_pins_is_four_k_r_squared(reference: cs.Drive) -> None:
    """Half of each disc's pins share by sin: stiffness 4 k R^2, participation 1/2."""
    rigid = tuple(s.model_copy(update={"length_mm": 1e-9}) for s in reference.shaft[1:2])
    drive = reference.replace(shaft=rigid, output_torque_nm=1e-3)
    results = drive.evaluate()
    pin = results["pin_compliance_rad_per_nm"]
    assert pin is not None
    assert results["pin_participation_statics"] == pytest.approx(0.5, rel=1e-13)
    assert results["output_compliance_statics_rad_per_nm"] == pytest.approx(pin / 4, rel=1e-6)
    assert results["output_compliance_rad_per_nm"] == pytest.approx(pin / 8, rel=1e-6)


def test_a_slender_pin_bends_as_euler_and_bernoulli_say(reference: cs.Drive) -> None:
    """F L^3 / (3 E I) and 32 F L / (pi d^3), for a pin twenty times as long as thick."""
    drive = reference.replace(
        output_pin_diameter_mm=10.0, output_pin_length_mm=200.0, output_torque_nm=1e-3
    )
    results = drive.evaluate()
    second_moment = 3.141592653589793 * 0.010**4 / 64
    euler = 0.2**3 / (3 * 206e9 * second_moment) / 0.045**2
    assert results["pin_compliance_rad_per_nm"] == pytest.approx(euler, rel=3e-3)
    force = results["pin_force_max_n"]
    assert force is not None
    assert results["pin_bending_stress_mpa"] == pytest.approx(
        32 * force * 200 / (3.141592653589793 * 10**3), rel=1e-12
    )
