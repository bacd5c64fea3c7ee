"""The pin's root against finite elements, and the pin under the five loads of Fig. 13."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.design.pin_loads import THICK_FLANGE, root_flexibility
from tests.support.pin_on_flange import end_deflection

# Length over diameter; E d delta / F with a rigid root, and on a flange of 16 diameters.
DESIGN_NOTES = [(0.5, 2.6947, 5.4510), (1.0, 10.2392, 17.3299), (2.0, 60.3554, 84.4138)]


@pytest.mark.parametrize(("length", "rigid", "on_flange"), DESIGN_NOTES)
def test_the_root_formula_against_finite_elements(
    length: float, rigid: float, on_flange: float
) -> None:
    held = end_deflection(length, flange=None)
    given = end_deflection(length, flange=16.0)
    assert held == pytest.approx(rigid, rel=2e-4)
    assert given == pytest.approx(on_flange, rel=4e-4)
    # The formula goes on top of Timoshenko's beam, whose own error against the rigid root it holds.
    beam = 64 * length**3 / (3 * math.pi) + length * 2.6 * (7 + 1.8) / 7.8 * 4 / math.pi
    root = root_flexibility(THICK_FLANGE, length, 1.0, 1e-3)
    assert beam + root == pytest.approx(given, rel=5e-4)


def test_finer_meshes_converge() -> None:
    deflections = [end_deflection(1.0, flange=4.0, cells=cells) for cells in (3, 6, 12)]
    steps = np.diff(deflections)
    assert steps[1] < 0.3 * steps[0]
    assert deflections[-1] == pytest.approx(17.2265, rel=4e-4)


def test_the_python_formula_is_the_core_s() -> None:
    drive = cs.Drive.reference_87().replace(
        ring_pin_radius_mm=1.5, disc_width_mm=12.0, disc_1_reach_mm=8.0, disc_2_reach_mm=24.0
    )
    study = drive.study()
    stiff = drive.part_study("full").mechanism(study, 0)["pin_stiffness"]
    rootless = drive.replace(pin_root_compliance=(0.0, 0.0, 0.0)).part_study("full")
    alone = rootless.mechanism(study, 0)["pin_stiffness"]
    for disc, reach in enumerate((8.0, 24.0)):
        root = root_flexibility(THICK_FLANGE, reach, 16.0, 206.0)
        assert 1 / stiff[disc] - 1 / alone[disc] == pytest.approx(root * 1e-3, rel=1e-9)


def test_five_loads_of_one_pin() -> None:
    drive = cs.Drive.reference_87()
    table = drive.pin_loads()
    columns = drive.evaluate()
    force, compliance = columns["force_per_pin_n"], columns["pin_compliance_rad_per_nm"]
    assert force is not None
    assert compliance is not None
    np.testing.assert_allclose(table["force_n"], force * np.array([1, 2, 3, 4, 4.5]))
    # Linear over the five loads, as the paper's pin; what the arc tangent of Eq. (8) takes off is
    # below 5e-5 of the compliance, that of Eq. (10) is its limit.
    ratio = (table["deflection_mm"] / table["force_n"]).to_numpy()
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    found = table["compliance_rad_per_nm"].to_numpy()
    assert (np.diff(found) < 0).all()
    np.testing.assert_allclose(found, compliance, rtol=5e-5)
    # A thick flange makes the pin of L/d 40/16 softer by about 30 %.
    softer = (table["deflection_with_root_mm"] / table["deflection_mm"]).to_numpy()
    length, diameter = drive.output_pin_length_mm, drive.output_pin_diameter_mm
    root = root_flexibility(THICK_FLANGE, length, diameter, drive.youngs_modulus_gpa)
    np.testing.assert_allclose(softer, 1 + root / ratio[0], rtol=1e-12)
    assert 1.25 < softer[0] < 1.35
    with pytest.raises(cs.InputError, match="found 0"):
        drive.pin_loads((0.0, 1.0))
    with pytest.raises(cs.DesignError, match="bore"):
        drive.replace(output_pin_bore_mm=20.0).pin_loads()
