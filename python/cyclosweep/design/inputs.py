"""The keys of a drive file: their types, their ranges and where each number comes from."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import Field, field_validator, model_validator

import cyclosweep._core as _core
from cyclosweep.design.active_pins import CRITERIA, Criterion
from cyclosweep.design.shaft import NonNegative, Positive, Segment, dimensions
from cyclosweep.design.toml_files import TomlTable
from cyclosweep.errors import did_you_mean
from cyclosweep.notebook import html_table

__all__ = ["MARKS", "DriveInputs"]

MARKS = ("published", "derived", "reading", "assumed", "measured")
"""Where a number may come from, as ``[provenance]`` of a drive file says it."""


class DriveInputs(TomlTable):
    """Every number that describes a drive, checked one by one.

    The meaning and unit of each stand in :data:`cyclosweep.design.units.INPUTS`.
    """

    name: str = "drive"
    ratio: Annotated[int, Field(ge=3, le=300)]
    disc_count: Annotated[int, Field(ge=1, le=4)]
    eccentricity_mm: Positive
    ring_pin_circle_radius_mm: Positive
    hole_clocking_deg: Annotated[float, Field(allow_inf_nan=False)] = 0.0
    output_pin_count: Annotated[int, Field(ge=3, le=64)]
    output_pin_circle_radius_mm: Positive
    output_pin_diameter_mm: Positive
    output_pin_bore_mm: NonNegative = 0.0
    output_pin_length_mm: Positive
    bush_wall_mm: NonNegative = 0.0
    disc_outer_radius_mm: Positive
    disc_bore_radius_mm: NonNegative
    youngs_modulus_gpa: Positive
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5, allow_inf_nan=False)] = 0.3
    keyway_coefficient: NonNegative = 10.0
    input_power_kw: Positive
    input_speed_rpm: Positive
    output_torque_nm: Positive
    free_play_deg: NonNegative = 0.0
    input_inertia_kg_m2: Positive | None = None
    output_stiffness_nm_per_arcmin: Positive | None = None
    criterion: Criterion = "published-map"
    shaft: tuple[Segment, ...] = ()
    provenance: dict[str, str] = Field(default_factory=dict)

    _SCALARS: ClassVar[tuple[str, ...]] = tuple(name for name, _, _ in _core.input_table())

    @field_validator("shaft", mode="before")
    @classmethod
    def _shaft_is_a_sequence(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        if not self.shaft and self.output_stiffness_nm_per_arcmin is None:
            raise ValueError(
                "neither [[shaft]] nor output_stiffness_nm_per_arcmin, expected one of them"
            )
        known = frozenset(self.marked()) if self.provenance else frozenset()
        for key, mark in self.provenance.items():
            if key not in known:
                hint = did_you_mean(key, known)
                raise ValueError(f"provenance.{key}: no such input of this drive{hint}")
            if mark.partition(":")[0].strip() not in MARKS:
                raise ValueError(
                    f"provenance.{key}: found {mark!r}, expected one of {', '.join(MARKS)}"
                    f"{did_you_mean(mark.partition(':')[0], MARKS)}"
                )
        return self

    def __hash__(self) -> int:
        """Hash of every number and name; equal drives have equal hashes, marks left out."""
        given = (getattr(self, name) for name in type(self).model_fields if name != "provenance")
        return hash(tuple(given))

    def __repr__(self) -> str:
        discs = "1 disc" if self.disc_count == 1 else f"{self.disc_count} discs"
        return (
            f"<Drive {self.name}: {self.ratio}:1, {discs}, {self.output_pin_count} output pins, "
            f"eccentricity {self.eccentricity_mm:g} mm, {self.output_torque_nm:g} N m>"
        )

    __str__ = __repr__

    def _repr_html_(self) -> str:
        marks = Counter(mark.partition(":")[0].strip() for mark in self.provenance.values())
        kinds = ", ".join(segment.kind for segment in self.shaft)
        stiffness = self.output_stiffness_nm_per_arcmin
        rows = {
            "ratio": f"{self.ratio}:1, {self.disc_count} discs",
            "eccentricity": f"{self.eccentricity_mm:g} mm",
            "ring pins": f"{self.ratio + 1} on radius {self.ring_pin_circle_radius_mm:g} mm",
            "output pins": f"{self.output_pin_count} of {self.output_pin_diameter_mm:g} mm "
            f"on radius {self.output_pin_circle_radius_mm:g} mm",
            "rating": f"{self.output_torque_nm:g} N m at the output, {self.input_power_kw:g} kW at "
            f"{self.input_speed_rpm:g} rpm",
            "free play": f"{self.free_play_deg:g} deg at the input",
            "shaft": kinds,
            "output stiffness": None if stiffness is None else f"{stiffness:g} N m/arcmin",
            "criterion": self.criterion,
            "numbers": ", ".join(f"{marks[mark]} {mark}" for mark in MARKS if marks[mark]),
        }
        return html_table(f"Drive {self.name}", rows)

    if not TYPE_CHECKING:  # so that a wrong name stays an error to a type checker

        def __getattr__(self, name: str) -> Any:
            try:
                return super().__getattr__(name)
            except AttributeError:
                known = () if name.startswith("_") else (*type(self).model_fields, *dir(type(self)))
                hint = did_you_mean(name, known)
                raise AttributeError(f"{name}: no such attribute of a drive{hint}") from None

    def inputs(self) -> tuple[str, ...]:
        """Names of every input of the published model, in order; each can be an axis of a study."""
        return (*self._SCALARS, *(name for name, _ in dimensions(self.shaft)))

    def marked(self) -> tuple[str, ...]:
        """Names of every key that can have a mark of where its number comes from."""
        return self.inputs()

    def values(self) -> dict[str, float]:
        """Every input's value by name, NaN where left out, the criterion by its number."""
        values: dict[str, float] = {}
        for name in self._SCALARS:
            value = getattr(self, name)
            if name == "criterion":
                value = CRITERIA.index(value)
            values[name] = math.nan if value is None else float(value)
        return {**values, **dict(dimensions(self.shaft))}

    def study(self, loads_tn: tuple[float, ...] = ()) -> _core.Study:
        """Return the core's study of this drive alone."""
        kinds = [segment.kind for segment in self.shaft]
        return _core.Study(list(self.values().items()), kinds, [], "grid", 1, 0, list(loads_tn), [])

    @property
    def nominal_torque_nm(self) -> float:
        """Nominal input torque T_N = P / omega [N m]."""
        return self.input_power_kw * 1e3 / (self.input_speed_rpm * math.pi / 30)

    @property
    def overall_efficiency(self) -> float:
        """Rated output torque over i T_N [1]."""
        return self.output_torque_nm / (self.ratio * self.nominal_torque_nm)
