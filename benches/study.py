"""The study that every benchmark runs: Sobol, eight axes, 6-12 pins, two discs, five segments."""

from __future__ import annotations

from pathlib import Path

import cyclosweep as cs

__all__ = ["DRIVE", "bench_space"]

DRIVE = cs.Drive.from_toml(Path(__file__).parent / "drive.toml")


def bench_space(count: int) -> cs.Space:
    """Return ``count`` variants; a few in a hundred cannot be built."""
    return cs.Space.sobol(
        DRIVE,
        count,
        seed=1,
        eccentricity_mm=(0.3, 0.8),
        output_pin_count=(6, 12),
        output_pin_circle_radius_mm=(42.0, 50.0),
        output_pin_diameter_mm=(10.0, 17.0),
        output_pin_length_mm=(25.0, 50.0),
        hole_clocking_deg=(-2.0, 2.0),
        shaft_1_length_mm=(50.0, 80.0),
        shaft_3_diameter_mm=(51.0, 59.0),
    )
