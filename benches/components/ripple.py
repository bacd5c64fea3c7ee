"""Errors of the transmission error and the torque ripple: of the quadratic engine, of 48 positions.

    python benches/components/ripple.py [variants]

Takes about half a minute on one core.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import numpy as np

import cyclosweep as cs

EXAMPLES = Path(__file__).parents[2] / "examples"
DRIVES = ("catalogue-29", "components-87")
COLUMNS = ("transmission_error_pp_arcmin", "input_torque_ripple_pp")
LOW_RATIO = 11
POSITIONS = 1440
"""Of a whole turn: 120 in each pitch of the ring of the drive of the low ratio."""


def around(drive: cs.Drive, count: int) -> cs.Space:
    """Variants of a drive, clearances from none to twice its own, sizes within 15 %."""
    sizes = ("output_pin_diameter_mm", "disc_width_mm", "eccentric_bearing_stiffness_n_per_mm")
    clearances = ("ring_clearance_mm", "hole_clearance_mm")
    axes = {name: (0.85 * getattr(drive, name), 1.15 * getattr(drive, name)) for name in sizes}
    axes |= {name: (0.0, 2 * getattr(drive, name)) for name in clearances}
    return cs.Space.sobol(drive, count, seed=1, **axes)


def engine_errors(drive: cs.Drive, count: int) -> dict[str, dict[str, float]]:
    """Quantiles of the relative error of the quadratic engine against the full one [1]."""
    space = around(drive, count)
    full = cs.scan(space, model="components", solver="full").select(COLUMNS).collect()
    quick = cs.scan(space, model="components").select(COLUMNS).collect()
    found = {}
    for name in COLUMNS:
        error = np.abs((quick[name] / full[name] - 1).drop_nulls().to_numpy())
        quantiles = np.quantile(error, [0.5, 0.95, 0.99, 1.0])
        found[name] = dict(zip(("median", "p95", "p99", "max"), map(float, quantiles), strict=True))
    return found


def of_a_whole_turn(drive: cs.Drive) -> float:
    """Transmission error by the full engine over a turn of the mesh against that of the column."""
    column = cs.scan(cs.Space.grid(drive), model="components", solver="full")
    of_column = column.select(COLUMNS[0]).collect().item()
    cranks = np.arange(POSITIONS) * math.tau / POSITIONS
    twists = [drive.loaded(crank_rad=float(crank)).twist_arcmin for crank in cranks]
    return float(of_column / np.ptp(twists))


def low_ratio() -> cs.Drive:
    """The catalogue's drive with a ring of twelve pins, its load by the ratio."""
    drive = cs.Drive.from_toml(EXAMPLES / "catalogue-29.toml")
    return drive.replace(
        ratio=LOW_RATIO,
        eccentricity_mm=2.0,
        disc_outer_radius_mm=46.0,
        output_torque_nm=drive.output_torque_nm * LOW_RATIO / drive.ratio,
    )


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 512
    drives = {name: cs.Drive.from_toml(EXAMPLES / f"{name}.toml") for name in DRIVES}
    answer = {
        "relative_error": {name: engine_errors(drive, count) for name, drive in drives.items()},
        "column_over_whole_turn": {
            name: of_a_whole_turn(drive)
            for name, drive in {f"ratio {LOW_RATIO}": low_ratio(), **drives}.items()
        },
    }
    print(json.dumps(answer, indent=1))
