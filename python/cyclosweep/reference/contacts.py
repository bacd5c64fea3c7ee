"""Contacts, profiles and load sharing of the component model beside published cases."""

from __future__ import annotations

import math
from collections.abc import Iterator

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive
from cyclosweep.errors import InputError
from cyclosweep.reference.facts import Fact
from cyclosweep.reference.model import Model
from cyclosweep.reference.sources import KROL, KROL_FORMULA, RATIO_29, UNIT_CASE

__all__ = ["facts"]

GROUP = "contacts and load sharing"

# Radii [mm] (a hollow one below zero), force [N] and length [mm], half width [mm], pressure [MPa].
_HERTZ = (
    ("roller 10 mm on a flat", (10.0, 1e12), 100.0, 1.0, 0.106061, 600.237),
    ("roller 5 mm on a flat", (5.0, 1e12), 100.0, 1.0, 0.074997, 848.864),
    ("rollers 10 and 20 mm", (10.0, 20.0), 100.0, 1.0, 0.086599, 735.138),
    ("roller 3.5 mm in a hollow of 12 mm", (3.5, -12.0), 100.0, 1.0, 0.074554, 853.902),
    ("pin 8 mm in a hole of 8.9 mm", (8.0, -8.9), 4900.0, 12.0, 0.602812, 431.231),
)

# Force [N]: approach [mm] of 10 mm steel by Palmgren, by Johnson of 5 on 50 mm and of 8 in 8.9 mm.
_APPROACHES = {
    100.0: (0.000384, 0.000418, 0.000303),
    1000.0: (0.003050, 0.003535, 0.002378),
    5000.0: (0.012984, 0.015412, 0.009629),
}

# e, q, m, h [mm]; lobe and pit stress [MPa].
_KROL = {
    "1": (2.8, 3.5, 0.7, 10.0, 424, 139),
    "1LM": (2.3317, 4.1502, 0.6238, 8.2701, 488, 177),
    "1SD": (2.4637, 3.5488, 0.6747, 9.1856, 476, 160),
    "2": (1.5, 2.0, 0.65, 8.0, 855, 331),
    "2LM": (1.6515, 2.3424, 0.4513, 8.8444, 685, 466),
    "2SD": (1.7828, 2.1442, 0.4764, 8.0453, 717, 486),
    "3": (2.9, 3.4, 0.7, 10.0, 419, 142),
    "3LM": (2.2757, 4.1670, 0.6240, 8.4674, 490, 175),
    "3SD": (2.5077, 3.4718, 0.6741, 9.0349, 478, 164),
    "4": (3.0, 3.3, 0.7, 10.0, 415, 146),
    "4LM": (2.3225, 4.0285, 0.6166, 8.3739, 489, 185),
    "4SD": (2.5542, 3.3977, 0.6735, 8.8798, 480, 169),
}
_KROL_TORQUE_NMM = 1550.0
_KROL_LOBES = 15
_KROL_TOLERANCE_MPA = 1.0

_UNIT_CASE = {
    "ratio": 17,
    "disc_count": 1,
    "eccentricity_mm": 1.3,
    "ring_pin_circle_radius_mm": 42.5,
    "hole_clocking_deg": 0.0,
    "output_pin_count": 6,
    "output_pin_circle_radius_mm": 32.9,
    "output_pin_diameter_mm": 5.0,
    "bush_wall_mm": 0.0,
    "output_torque_nm": 1.0,
    "disc_outer_radius_mm": 41.0,
    "disc_bore_radius_mm": 10.0,
    "ring_pin_radius_mm": 2.5,
    "disc_width_mm": 6.35,
    "youngs_modulus_gpa": 200.0,
    "ring_youngs_modulus_gpa": 200.0,
    "disc_youngs_modulus_gpa": 69.0,
    "disc_poisson_ratio": 0.33,
    "eccentric_bearing_stiffness_n_per_mm": 1e9,
    "disc_1_reach_mm": 0.01,
}
_RATIO_29 = {
    "ratio": 29,
    "eccentricity_mm": 1.25,
    "ring_pin_circle_radius_mm": 52.5,
    "hole_clocking_deg": 0.0,
    "output_pin_count": 4,
    "output_pin_circle_radius_mm": 34.0,
    "output_torque_nm": 116.0,
    "disc_outer_radius_mm": 50.0,
    "disc_bore_radius_mm": 15.0,
    "output_pin_diameter_mm": 16.0,
    "bush_wall_mm": 0.0,
    "ring_pin_radius_mm": 3.5,
    "disc_width_mm": 13.5,
    "eccentric_bearing_stiffness_n_per_mm": 1e9,
    "disc_1_reach_mm": 0.01,
    "disc_2_reach_mm": 0.01,
}
"""Both with rigid bearings and pins, as their sources have them."""

_SHARING = (
    "theirs shares the torque by straight springs, the component model by the power 10/9 of line "
    "contacts, which loads the deepest of them 2 % more and its pressure half of that"
)
# Column, what it is, printed, unit, tolerance, number that the explanation is about.
_SHARED = (
    (_UNIT_CASE, "unit case", "ring_pin_force_max_n", "ring force", 10.04, "N", 10.2467),
    (_UNIT_CASE, "unit case", "output_pin_force_max_n", "output force", 20.26, "N", 20.7239),
    (
        _UNIT_CASE, "unit case", "ring_contact_pressure_max_mpa", "ring pressure", 118.56, "MPa",
        119.441,
    ),
    (
        _UNIT_CASE, "unit case", "output_contact_pressure_max_mpa", "output pressure", 89.21,
        "MPa", 90.2207,
    ),
    (_UNIT_CASE, "unit case", "eccentric_bearing_force_max_n", "bearing force", 54.0, "N", None),
    (_RATIO_29, "29:1", "ring_pin_force_max_n", "force on a ring roller", 213.3, "N", 217.588),
    (
        _RATIO_29, "29:1", "output_pin_force_max_n", "force on an output roller by the component "
        "model", 1705.9, "N", None,
    ),
)  # fmt: skip


def facts(model: Model) -> Iterator[Fact]:
    """Compare the parts of the component model with other people's figures.

    Parameters
    ----------
    model : Model
        The package, or the package with one error put in.

    Yields
    ------
    Fact
        Rows of kind ``identity`` for formulas worked out by hand, ``evidence`` for published cases
        and ``independent solution`` for others.
    """
    yield from _hertz(model)
    yield from _approaches(model)
    yield from _profiles(model)
    yield from _shared(model)
    yield from _krol(model)


def _steel(model: Model, youngs_modulus_gpa: float) -> tuple[float, float]:
    """Young's modulus [GPa] and Poisson's ratio that the model takes for a steel of this one."""
    steel = Drive.reference_87().replace(youngs_modulus_gpa=youngs_modulus_gpa, poisson_ratio=0.3)
    steel = model.change_drive(steel)
    return steel.youngs_modulus_gpa, steel.poisson_ratio


def _row(fact: str, expected: float, computed: float, unit: str, tolerance: float) -> Fact:
    note = "worked out from the formula by hand"
    return Fact(GROUP, fact, expected, computed, unit, "identity", "identity", tolerance, note)


def _hertz(model: Model) -> Iterator[Fact]:
    steel = _steel(model, 206.0)
    for name, radii, force, length, half_width, pressure in _HERTZ:
        found = _core.line_contact(force, length, radii, steel, steel)
        for what, unit, expected, computed in (
            ("half width", "mm", half_width, found[0]),
            ("pressure", "MPa", pressure, found[1]),
        ):
            yield _row(f"Hertz, {name}: {what}", expected, computed, unit, 1e-5 * expected)


def _approaches(model: Model) -> Iterator[Fact]:
    steel = _steel(model, 206.0)
    for force, approaches in _APPROACHES.items():
        on_50 = _core.line_contact(force, 10.0, (5.0, 50.0), steel, steel)
        in_hole = _core.line_contact(force, 10.0, (8.0, -8.9), steel, steel)
        for law, expected, computed in zip(
            ("Palmgren, 10 mm", "Johnson, 5 on 50 mm", "Johnson, 8 in 8.9 mm"),
            approaches,
            (on_50[2], on_50[3], in_hole[3]),
            strict=True,
        ):
            yield _row(f"approach of steel at {force:g} N: {law}", expected, computed, "mm", 6e-7)


def _radii(model: Model, lobes: int, ring_radius: float, pin: float, e: float) -> list[float]:
    """Radii of curvature [mm] of the profile that the model makes of these dimensions."""
    drive = model.change_drive(
        Drive.reference_87().replace(
            ratio=lobes,
            ring_pin_circle_radius_mm=ring_radius,
            ring_pin_radius_mm=pin,
            eccentricity_mm=e,
        )
    )
    return _core.profile_radii(
        drive.ratio,
        drive.ring_pin_circle_radius_mm,
        drive.ring_pin_radius_mm or pin,
        drive.eccentricity_mm,
    )


def _profiles(model: Model) -> Iterator[Fact]:
    yield Fact(
        GROUP, "unit case, 18 ring pins: smallest convex radius of the profile", 6.678,
        _radii(model, 17, 42.5, 2.5, 1.3)[2], "mm", "published", "independent solution", 5e-4,
        "code-to-code", source=UNIT_CASE,
    )  # fmt: skip
    krol = _radii(model, _KROL_LOBES, 64.0, 3.5, 2.8)
    for what, radius, computed in (("top", 11.6607, krol[0]), ("pit", -4.0647, krol[1])):
        yield Fact(
            GROUP, f"Krol et al. 2019, design 1: radius of curvature at the {what}", radius,
            computed, "mm", "derived", "independent solution", 6e-5, source=KROL_FORMULA,
        )  # fmt: skip


def _shared(model: Model) -> Iterator[Fact]:
    base = Drive.reference_87().replace(
        shaft=[{"kind": "cylinder", "diameter_mm": 20.0, "length_mm": 40.0}]
    )
    for changes, case, column, what, printed, unit, explained in _SHARED:
        yield Fact(
            GROUP, f"{case}: {what}", printed, _solved(model, base.replace(**changes), column),
            unit, "published", "independent solution", 1e-3 * printed,
            "worst position over the turn; rigid bearings and pins",
            _SHARING if explained is not None else "", explained,
            UNIT_CASE if changes is _UNIT_CASE else RATIO_29,
        )  # fmt: skip


def _solved(model: Model, drive: Drive, column: str) -> float:
    """A column of the component model; NaN where an error put in makes the drive impossible."""
    try:
        drive = model.change_drive(drive)
    except InputError:
        return math.nan
    _, _, columns = drive.part_study("full").evaluate_range(drive.study(), 0, 1, [column])
    return float(columns[0, 0])


def _krol(model: Model) -> Iterator[Fact]:
    steel = _steel(model, 200.0)
    for design, (e, q, m, h, lobe, pit) in _KROL.items():
        ring_radius = e * (_KROL_LOBES + 1) / m
        force = 4 * _KROL_TORQUE_NMM / (e * (_KROL_LOBES + 1))
        top, hollow, _ = _radii(model, _KROL_LOBES, ring_radius, q, e)
        for place, radius, printed in (("lobe", top, lobe), ("pit", hollow, pit)):
            stress = _core.line_contact(force, h, (radius, q), steel, steel)[1]
            yield Fact(
                GROUP, f"Krol et al. 2019, design {design}: stress at the {place}", printed, stress,
                "MPa", "published", "evidence", _KROL_TOLERANCE_MPA,
                "force 4 Mh zs / (e zs zk) of theirs; printed to 1 MPa", source=KROL,
            )  # fmt: skip
