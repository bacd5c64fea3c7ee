"""The keys of a drive file: their types, their ranges and where each number comes from."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Self

from pydantic import Field, field_validator, model_validator

import cyclosweep._core as _core
from cyclosweep.design.active_pins import CRITERIA, Criterion
from cyclosweep.design.shaft import NonNegative, Positive, Segment, dimensions
from cyclosweep.design.toml_files import TomlTable

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
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5)] = 0.3
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
        for key, mark in self.provenance.items():
            if key not in self.marked():
                raise ValueError(f"provenance.{key}: no such input of this drive")
            if mark.partition(":")[0].strip() not in MARKS:
                raise ValueError(
                    f"provenance.{key}: found {mark!r}, expected one of {', '.join(MARKS)}"
                )
        return self

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
