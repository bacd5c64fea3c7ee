"""What every opponent is handed: the inputs as arrays, and the constants of the bench drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

__all__ = ["AXES", "COLUMNS", "LOADS_TN", "Constants", "columns_of"]

Reals = npt.NDArray[np.float64]

AXES = (
    "eccentricity_mm",
    "output_pin_count",
    "output_pin_circle_radius_mm",
    "output_pin_diameter_mm",
    "output_pin_length_mm",
    "hole_clocking_deg",
    "shaft_1_length_mm",
    "shaft_3_diameter_mm",
)
LOADS_TN = (1.0, 2.0, 3.0, 4.0, 4.5)

COLUMNS = (
    "active_pins_mean",
    "active_pins_min",
    "active_pins_max",
    "torque_transfer_efficiency",
    "torque_transfer_efficiency_inside",
    "torque_transfer_efficiency_published_map",
    "pin_participation_statics",
    "statics_applicable",
    "hole_diameter_mm",
    "hole_web_mm",
    "short_width_coefficient",
    "nominal_torque_nm",
    "natural_frequency_hz",
    "shaft_compliance_rad_per_nm",
    "pin_compliance_rad_per_nm",
    "output_compliance_rad_per_nm",
    "output_compliance_statics_rad_per_nm",
    "reflected_compliance_rad_per_nm",
    "reflected_stiffness_nm_per_rad",
    "output_stiffness_nm_per_arcmin",
    "pin_force_max_n",
    "pin_bending_stress_mpa",
    "twist_1tn_deg",
    "twist_2tn_deg",
    "twist_3tn_deg",
    "twist_4tn_deg",
    "twist_4p5tn_deg",
)


@dataclass(frozen=True)
class Constants:
    """The bench drive, SI and radians; what the axes vary is not here."""

    ratio: float = 87.0
    discs: float = 2.0
    ring: float = 0.075
    wall: float = 0.002
    rim: float = 0.070
    hub: float = 0.025
    youngs: float = 206e9
    poisson: float = 0.3
    keyway: float = 10.0
    nominal: float = 1140.0 / (1500.0 * np.pi / 30.0)
    torque: float = 585.0
    free_play: float = 28.0
    inertia: float = 0.002
    shaft_diameters: tuple[float, ...] = (0.050, 0.050, 0.055, 0.060, 0.062)
    shaft_lengths: tuple[float, ...] = (0.060, 0.030, 0.030, 0.020, 0.015)
    shaft_end: float = 0.084
    keyway_depth: float = 0.0055


def columns_of(table: pl.DataFrame) -> tuple[Reals, ...]:
    """The eight axes of a sweep as contiguous arrays."""
    return tuple(np.ascontiguousarray(table[name].cast(pl.Float64).to_numpy()) for name in AXES)
