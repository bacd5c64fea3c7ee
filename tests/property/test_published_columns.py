"""What the columns of the published model must do for any drive: limits, independence, scaling."""

from __future__ import annotations

import math

import pytest

import cyclosweep as cs
from tests.drives import random_drives


def column(drive: cs.Drive, name: str) -> float:
    """Value of one result column of a drive."""
    value = drive.evaluate()[name]
    assert value is not None
    return value


def test_the_compliance_of_a_pin_does_not_depend_on_the_rating(reference: cs.Drive) -> None:
    for torque in (1e-3, 20.0, 585.0, 1e5):
        rated = reference.replace(output_torque_nm=torque)
        for name in ("pin_compliance_rad_per_nm", "output_compliance_rad_per_nm", "twist_4tn_deg"):
            assert column(rated, name) == column(reference, name), (torque, name)


def test_without_a_modulus_the_compliance_of_a_pin_has_no_bound(reference: cs.Drive) -> None:
    stiff = column(reference, "pin_compliance_rad_per_nm")
    for factor in (1e-3, 1e-6, 1e-9):
        soft = reference.replace(youngs_modulus_gpa=reference.youngs_modulus_gpa * factor)
        assert column(soft, "pin_compliance_rad_per_nm") * factor == pytest.approx(stiff, rel=1e-12)


@pytest.mark.parametrize(("diameter", "too_stiff"), [(6.0, 0.193), (5.0, 0.431)])
def test_the_whole_rated_torque_on_one_pin_was_a_misreading(
    reference: cs.Drive, diameter: float, too_stiff: float
) -> None:
    """The arc tangent under the whole torque falls short of the linear compliance."""
    slender = reference.replace(output_pin_diameter_mm=diameter, output_pin_length_mm=50.0)
    linear = column(slender, "pin_compliance_rad_per_nm")
    torque = slender.output_torque_nm
    arc_tangent = math.atan(linear * torque) / torque
    assert arc_tangent / linear == pytest.approx(1 - too_stiff, abs=0.0005)


def test_the_active_pins_carry_the_output_torque_together() -> None:
    for drive in random_drives(9, 60):
        row = drive.evaluate()
        torque, force, active = (
            row["torque_per_pin_nm"],
            row["force_per_pin_n"],
            row["active_pins_mean"],
        )
        eta = row["torque_transfer_efficiency"]
        assert torque is not None
        assert force is not None
        assert active is not None
        assert eta is not None
        assert torque * active == pytest.approx(drive.output_torque_nm, rel=1e-13)
        assert force * drive.output_pin_circle_radius_mm * 1e-3 == pytest.approx(torque, rel=1e-13)
        if drive.disc_count == 2:
            per_pin = drive.output_torque_nm / (eta * drive.output_pin_count)
            assert torque == pytest.approx(per_pin, rel=1e-13)
