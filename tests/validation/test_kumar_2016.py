"""Kumar, Kosse and Oloyede, Mech. Mach. Theory 105 (2016) 185-198: what it prints and we compute.

The drive's dimensions are not published; nothing here rests on the assumed ones unless it says so.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
import cyclosweep._core as _core
from cyclosweep.design.drive import CRITERIA

# Section 2.1: 1.14 kW at 1500 rpm, 585 N m at the output, 87:1, 2 discs, 8 pins, 56 deg of play.
SECTION_2_1 = {"ratio": 87, "disc_count": 2, "output_pin_count": 8}
PUBLISHED_MAP = CRITERIA.index("published-map")
# e -> 0, no spin, holes symmetric about ring pin 0.
IDEAL = (1e30, 2, 8, 0.0, 0.0)


def test_section_2_1_ratings(reference: cs.Drive) -> None:
    for name, value in SECTION_2_1.items():
        assert getattr(reference, name) == value
    assert round(reference.nominal_torque_nm, 4) == 7.2575
    assert round(reference.overall_efficiency, 4) == 0.9265
    assert reference.free_play_deg == 28
    assert reference.evaluate()["nominal_torque_nm"] == pytest.approx(
        1140 / (1500 * math.pi / 30), rel=1e-15
    )


def test_section_4_map_of_both_discs_in_the_ideal_limit() -> None:
    (mean, least, most), _, (opens, _) = _core.active_pins(PUBLISHED_MAP, *IDEAL)
    assert (mean, least, most) == (6.75, 4, 8)
    assert mean / 8 == 0.84375
    assert opens * 360 == 67.5
    sectors = _core.sectors(PUBLISHED_MAP, *IDEAL)
    at = {}
    for centre in range(0, 360, 45):
        turn = (centre + 1e-6) / 360
        at[centre] = next(active for start, end, active in sectors if start <= turn < end)
    assert list(at.values()) == [4, 6, 8, 8, 6, 8, 8, 6]


def test_section_4_map_with_spin_and_the_printed_start_of_h1(reference: cs.Drive) -> None:
    """With e/R 0.0125 and H1 opening at 66.0 deg the reconstruction's mean is 6.676."""
    radius = reference.output_pin_circle_radius_mm
    delta = math.degrees(math.asin(0.0125 / 2))
    clocking = 66.0 * 88 / 87 - 90 - delta + 22.5
    drive = reference.replace(eccentricity_mm=0.0125 * radius, hole_clocking_deg=clocking)
    assert drive.active_pins().mean == pytest.approx(6.676, abs=5e-4)
    assert -2.5 < clocking < -0.5


def test_section_4_of_the_built_in_drive(reference: cs.Drive) -> None:
    """Rests on assumed dimensions: minimum 4, all eight near 90 deg for a short span only."""
    pins = reference.active_pins()
    assert (pins.minimum, pins.maximum) == (4, 8)
    assert pins.mean == pytest.approx(6.75, rel=0.015)
    near_90 = pins.sectors.filter(pl.col("start_deg") < 91, pl.col("end_deg") > 89)
    assert near_90["active"].max() == 8


def test_the_shaft_of_the_built_in_drive_has_the_parts_of_the_paper_s(
    reference: cs.Drive,
) -> None:
    """Eqs. (5)-(7): a keyway, four steps, a frustum; assumed dimensions that can be built."""
    kinds = [segment.kind for segment in reference.shaft]
    assert kinds == ["keyway", *["cylinder"] * 4, "frustum"]
    frustum = reference.shaft[-1]
    assert isinstance(frustum, cs.Frustum)
    diameters = [*(s.diameter_mm for s in reference.shaft), frustum.end_diameter_mm]
    assert diameters[4] == diameters[5]  # the frustum begins where the fourth step ends
    del diameters[5]
    assert all(after > before for before, after in itertools.pairwise(diameters))
    assert diameters[0] == 50
    within_pins = 2 * reference.output_pin_circle_radius_mm - reference.output_pin_diameter_mm
    assert frustum.end_diameter_mm < within_pins
    assert reference.explain() is None


def test_every_dimension_of_the_built_in_drive_says_where_it_comes_from(
    reference: cs.Drive,
) -> None:
    given = set(reference.inputs()) - {"output_stiffness_nm_per_arcmin", "criterion"}
    assert set(reference.provenance) == given
    shaft = {name for name in given if name.startswith("shaft_")}
    assert all(reference.provenance[name].startswith("assumed") for name in shaft)


def test_the_loading_line_stays_where_rig_and_recordings_have_it(reference: cs.Drive) -> None:
    """19.8 deg at the input per T_N beyond the free play, to 0.1 %."""
    line = reference.nominal_line()
    assert line.compliance_deg_per_nm == pytest.approx(19.8 / 7.2575, rel=1e-3)
    assert reference.evaluate()["twist_1tn_deg"] == pytest.approx(47.7852, abs=1e-4)


def test_section_6_loading_line_of_the_built_in_drive(reference: cs.Drive) -> None:
    """Chosen, not evidence: 75 to 80 deg at 2.5 T_N, compliance 0.0452 to 0.0500 rad/(N m)."""
    twist = reference.evaluate((2.5,))["twist_2p5tn_deg"]
    assert twist is not None
    assert 75 <= twist <= 80
    line = reference.nominal_line()
    assert 0.0452 <= math.radians(line.compliance_deg_per_nm) <= 0.0500


def test_eq_13_multiplies_the_whole_compliance_by_eta(reference: cs.Drive) -> None:
    """Fewer active pins read as less twist: as printed, and as the documentation warns."""
    results = reference.evaluate()
    eta, reflected = (
        results["torque_transfer_efficiency"],
        results["reflected_compliance_rad_per_nm"],
    )
    assert eta is not None
    assert reflected is not None
    for load, name in ((1, "twist_1tn_deg"), (4.5, "twist_4p5tn_deg")):
        expected = eta * reflected * load * reference.nominal_torque_nm * 180 / math.pi + 28
        assert results[name] == pytest.approx(expected, rel=1e-13)


def test_a_hole_s_centre_traces_the_hypotrochoid(reference: cs.Drive) -> None:
    """Section 4: inside the pitch circle exactly while cos psi < -e / (2 R_OP)."""
    e, radius, ratio = 0.00062, 0.045, 87.0
    theta = np.linspace(0, 4 * np.pi, 5001)
    centre = _core.hole_locus(e, radius, ratio, 0.4, theta)
    x = e * np.cos(theta) + radius * np.cos(0.4 - theta / ratio)
    y = e * np.sin(theta) + radius * np.sin(0.4 - theta / ratio)
    assert np.allclose(centre, np.column_stack([x, y]), rtol=0, atol=1e-16)
    psi = theta * (1 + 1 / ratio) - 0.4
    inside = np.hypot(*centre.T) < radius
    assert np.array_equal(inside, np.cos(psi) < -e / (2 * radius))
