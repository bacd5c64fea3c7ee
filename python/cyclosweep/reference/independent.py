"""Independent published cases that the model's formulas cover."""

from __future__ import annotations

from collections.abc import Iterator

from cyclosweep.design.drive import Drive
from cyclosweep.reference.facts import Fact

__all__ = ["facts"]

GROUP = "independent cases"


def facts() -> Iterator[Fact]:
    """Compare forces and geometry with other people's figures.

    Yields
    ------
    Fact
    """
    base = Drive.reference_87()
    case = base.replace(
        name="29:1, 4 N m in, 116 N m out",
        ratio=29,
        eccentricity_mm=1.25,
        ring_pin_circle_radius_mm=52.5,
        output_pin_count=4,
        output_pin_circle_radius_mm=34.0,
        output_torque_nm=116.0,
        disc_outer_radius_mm=50.0,
        disc_bore_radius_mm=15.0,
        output_pin_diameter_mm=8.0,
    )
    yield Fact(
        GROUP,
        "29:1, two discs, 4 output pins on 68 mm: force on an output roller",
        1705.9,
        case.evaluate()["pin_force_max_n"],
        "N",
        "published",
        0.05,
        "4 (T2 / 2) / (zw Rw)",
    )
    unit = base.replace(
        name="18 ring pins, 6 output pins, 1 N m",
        ratio=17,
        disc_count=1,
        eccentricity_mm=1.3,
        ring_pin_circle_radius_mm=42.5,
        output_pin_count=6,
        output_pin_circle_radius_mm=32.9,
        output_pin_diameter_mm=5.0,
        bush_wall_mm=0.0,
        output_torque_nm=1.0,
        disc_outer_radius_mm=41.0,
        disc_bore_radius_mm=10.0,
    ).evaluate()
    yield Fact(
        GROUP,
        "unit case, 18 ring pins: short-width coefficient K1",
        0.5506,
        unit["short_width_coefficient"],
        "1",
        "published",
        5e-5,
        "code-to-code, reproduced independently",
    )
    yield Fact(
        GROUP,
        "unit case, 6 output pins, 1 N m on one disc: inner force",
        20.26,
        unit["pin_force_max_n"],
        "N",
        "published",
        5e-3,
        "code-to-code, rigid sharing",
    )
    krol = base.replace(
        name="Krol et al. 2019, design 1",
        ratio=15,
        disc_count=1,
        eccentricity_mm=2.8,
        ring_pin_circle_radius_mm=64.0,
        output_pin_circle_radius_mm=30.0,
        output_pin_diameter_mm=10.0,
        bush_wall_mm=0.0,
        output_torque_nm=23.25,
        disc_outer_radius_mm=52.0,
        disc_bore_radius_mm=15.0,
    ).evaluate()
    yield Fact(
        GROUP,
        "Krol et al. 2019, design 1: inner force",
        348.87,
        krol["pin_force_max_n"],
        "N",
        "published",
        None,
        "theirs is 2 Mh zs cos(2 pi / zi) / (pi Rw), another sharing: ours is the worst position",
    )
    for fact, unit_name, reason in (
        ("Krol et al. 2019: contact stresses of twelve designs", "MPa", "no contact model yet"),
        ("unit case: ring force and contact stresses", "N", "no contact model yet"),
        ("29:1: ring roller and bearing forces", "N", "no contact model yet"),
        ("Wang 2016: volumes", "mm^3", "no volume in the model"),
        (
            "13:1 printed drive: output stiffness 310 to 337 N m/rad",
            "N m/rad",
            "printed discs, housing and joints are soft there; the model holds pins and shaft only",
        ),
    ):
        yield Fact(GROUP, fact, None, None, unit_name, "published", None, reason)
