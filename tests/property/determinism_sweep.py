"""Print a digest of every column of a few spaces, bit for bit."""

from __future__ import annotations

import hashlib

import polars as pl

import cyclosweep as cs


def spaces() -> list[cs.Space]:
    drive = cs.Drive.reference_87()
    axes = {
        "eccentricity_mm": (0.3, 0.9),
        "output_pin_count": (3, 20),
        "criterion": ["published-map", "inside", "statics"],
    }
    return [
        cs.Space.grid(
            drive,
            eccentricity_mm=cs.linspace(0.3, 0.9, 101),
            output_pin_count=[6, 7, 9],
            shaft_1_diameter_mm=cs.linspace(45, 56, 41),
        ),
        cs.Space.sobol(drive, 30_000, seed=1, **axes),
        cs.Space.latin_hypercube(drive, 30_000, seed=1, **axes),
        cs.Space.random(drive, 30_000, seed=1, **axes),
    ]


def digest(frame: pl.DataFrame) -> str:
    total = hashlib.sha256()
    for column in frame.iter_columns():
        total.update(column.is_null().to_numpy().tobytes())
        physical = column.to_physical()
        total.update(physical.fill_null(strategy="zero").to_numpy().tobytes())
    return total.hexdigest()


if __name__ == "__main__":
    for space in spaces():
        print(digest(cs.sweep(space)))
