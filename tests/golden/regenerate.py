"""Write the golden values anew: `python -m tests.golden.regenerate`, then read the diff."""

from __future__ import annotations

from pathlib import Path

import polars as pl

import cyclosweep as cs
from tests.drives import random_drives

GOLDEN = Path(__file__).parent / "variants.csv"
LOADS = (1.0, 2.0, 3.0, 4.0, 4.5)
DIGITS = 15


def variants() -> pl.DataFrame:
    """Rows around the reference drive, of random drives, and of variants that cannot be built."""
    reference = cs.Drive.reference_87()
    around = cs.Space.sobol(
        reference,
        112,
        seed=87,
        eccentricity_mm=(0.3, 0.9),
        hole_clocking_deg=(-3.0, 3.0),
        output_pin_count=(5, 12),
        output_pin_diameter_mm=(10.0, 22.0),
        output_pin_bore_mm=(0.0, 8.0),
        disc_count=(1, 4),
        shaft_2_diameter_mm=(48.0, 60.0),
        criterion=["published-map", "inside", "statics"],
    )
    rows = [cs.sweep(around, loads_tn=LOADS).cast({"status": pl.String, "criterion": pl.String})]
    for number, drive in enumerate(random_drives(2016, 88)):
        row = cs.sweep(cs.Space.grid(drive), loads_tn=LOADS).cast({"status": pl.String})
        variant = pl.lit(1000 + number, dtype=pl.UInt64).alias("variant")
        criterion = pl.lit(drive.criterion).alias("criterion")
        rows.append(row.with_columns(variant, criterion))
    return pl.concat(rows, how="diagonal")


def write(path: Path = GOLDEN) -> None:
    """Write the golden file as text, so that its diff can be read."""
    rounded = [
        pl.col(name).map_elements(lambda v: f"{v:.{DIGITS}g}", return_dtype=pl.String)
        for name, dtype in variants().schema.items()
        if dtype == pl.Float64
    ]
    variants().with_columns(rounded).write_csv(path)


if __name__ == "__main__":
    write()
    print(f"{GOLDEN}: {GOLDEN.stat().st_size:,} bytes")
