"""Independent published cases that the package's formulas cover, and what it does not compute."""

from __future__ import annotations

from collections.abc import Iterator

from cyclosweep.design.drive import Drive
from cyclosweep.reference.facts import Fact, Kind
from cyclosweep.reference.model import Model
from cyclosweep.reference.sources import KROL, PUBLISHED, RATIO_29, UNIT_CASE

__all__ = ["facts"]

GROUP = "independent cases"
_RATIO_29 = {
    "name": "29:1, 4 N m in, 116 N m out",
    "ratio": 29,
    "eccentricity_mm": 1.25,
    "ring_pin_circle_radius_mm": 52.5,
    "output_pin_count": 4,
    "output_pin_circle_radius_mm": 34.0,
    "output_torque_nm": 116.0,
    "disc_outer_radius_mm": 50.0,
    "disc_bore_radius_mm": 15.0,
    "output_pin_diameter_mm": 8.0,
}
_CODE_TO_CODE = {
    "name": "18 ring pins, 6 output pins, 1 N m",
    "ratio": 17,
    "disc_count": 1,
    "eccentricity_mm": 1.3,
    "ring_pin_circle_radius_mm": 42.5,
    "output_pin_count": 6,
    "output_pin_circle_radius_mm": 32.9,
    "output_pin_diameter_mm": 5.0,
    "bush_wall_mm": 0.0,
    "output_torque_nm": 1.0,
    "disc_outer_radius_mm": 41.0,
    "disc_bore_radius_mm": 10.0,
}
_KROL_1 = {
    "name": "Krol et al. 2019, design 1",
    "ratio": 15,
    "disc_count": 1,
    "eccentricity_mm": 2.8,
    "ring_pin_circle_radius_mm": 64.0,
    "output_pin_circle_radius_mm": 30.0,
    "output_pin_diameter_mm": 10.0,
    "bush_wall_mm": 0.0,
    "output_torque_nm": 23.25,
    "disc_outer_radius_mm": 52.0,
    "disc_bore_radius_mm": 15.0,
}


def facts(model: Model) -> Iterator[Fact]:
    """Compare forces and geometry with other people's figures.

    Parameters
    ----------
    model : Model
        The package, or the package with one error put in.

    Yields
    ------
    Fact
        Rows that count, then what is published but not computed here.
    """
    yield from _computed(model)
    yield from _not_computed()


def _computed(model: Model) -> Iterator[Fact]:
    # Shaft and material play no part in these: short shafts that fit every pin circle.
    base = Drive.reference_87().replace(
        shaft=[{"kind": "cylinder", "diameter_mm": 20.0, "length_mm": 40.0}]
    )

    def row(
        fact: str,
        published: float,
        computed: float,
        unit: str,
        tolerance: float,
        note: str,
        source: str,
        explanation: str = "",
        explained: float | None = None,
    ) -> Fact:
        kind: Kind = "evidence" if source in PUBLISHED else "independent solution"
        return Fact(
            GROUP, fact, published, computed, unit, "published", kind, tolerance, note,
            explanation, explained, source,
        )  # fmt: skip

    force = "pin_force_max_n"
    yield row(
        "29:1, two discs, 4 output pins on 68 mm: force on an output roller",
        1705.9,
        model.evaluate(base.replace(**_RATIO_29))[force],
        "N",
        0.05,
        "4 (T2 / 2) / (zw Rw)",
        RATIO_29,
    )
    unit = model.evaluate(base.replace(**_CODE_TO_CODE))
    yield row(
        "unit case, 18 ring pins: short-width coefficient K1",
        0.5506,
        unit["short_width_coefficient"],
        "1",
        5e-5,
        "e times the ring pins over their circle's radius",
        UNIT_CASE,
    )
    yield row(
        "unit case, 6 output pins, 1 N m on one disc: inner force",
        20.26,
        unit[force],
        "N",
        5e-3,
        "code-to-code, rigid sharing",
        UNIT_CASE,
    )
    yield row(
        "Krol et al. 2019, design 1: inner force",
        348.87,
        model.evaluate(base.replace(**_KROL_1))[force],
        "N",
        0.05,
        "2 Mh zs cos(2 pi / zi) / (pi Rw); their other designs differ by the same factor",
        KROL,
        "11 % more than theirs, which replaces the sum over eight pins by an integral and takes a "
        "pin 45 deg from the worst place: the largest force that holds 23.25 N m with shares by "
        "sine lies between 358.0 and 387.5 N at every position, ours is the worst position",
        387.5,
    )


def _not_computed() -> Iterator[Fact]:
    yield Fact(
        GROUP, "29:1: bearing force along the eccentricity", None, None, "N", "published",
        "not computed", None,
        "1150.51 N noted at one position of a pattern whose clocking is not; by the component "
        "model it goes from 1170 to 1880 N over a turn without clocking", source=RATIO_29,
    )  # fmt: skip
