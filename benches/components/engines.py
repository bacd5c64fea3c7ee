"""Error of the quadratic engine against the full one over random designs, and rates of both.

    python benches/components/engines.py [designs]

Rates are variants a second of processor time, of one thread when RAYON_NUM_THREADS=1 is set.
"""

from __future__ import annotations

import json
import resource
import sys

import numpy as np
import polars as pl

import cyclosweep as cs

COMPARED = (
    "loaded_twist_arcmin",
    "tangent_stiffness_3pct_nm_per_arcmin",
    "tangent_stiffness_50pct_nm_per_arcmin",
    "tangent_stiffness_100pct_nm_per_arcmin",
    "lost_motion_3pct_arcmin",
    "output_pin_force_max_n",
    "ring_pin_force_max_n",
    "ring_contact_pressure_max_mpa",
    "output_contact_pressure_max_mpa",
)
FINE = ("transmission_error_pp_arcmin", "input_torque_ripple_pp")
TIGHT = "tangent_stiffness_100pct_without_clearance_nm_per_arcmin"
SEED = 20


def drive_87() -> cs.Drive:
    """The 87:1 drive with two discs on which rates are measured; its numbers are assumed."""
    return cs.Drive.reference_87().replace(
        eccentricity_mm=0.9,
        ring_pin_circle_radius_mm=90.0,
        disc_outer_radius_mm=85.0,
        ring_pin_radius_mm=2.0,
        disc_width_mm=12.0,
        ring_clearance_mm=0.02,
        hole_clearance_mm=0.05,
    )


def random_designs(count: int) -> cs.Space:
    """Designs of ratios 9 to 119 that can be built, loaded to 10 to 60 N/mm at the ring."""
    rng = np.random.default_rng(SEED)
    ratio = rng.integers(9, 120, count)
    ring = rng.uniform(30, 110, count)
    e = rng.uniform(0.35, 0.85, count) * ring / (ratio + 1)
    pins, discs = rng.integers(4, 13, count), rng.integers(1, 4, count)
    circle = ring * rng.uniform(0.45, 0.55, count)
    pitch = 2 * circle * np.sin(np.pi / pins)
    diameter = np.maximum(0.25 * np.minimum(pitch, 0.5 * ring) - e, 0.05 * pitch)
    width, size = rng.uniform(4, 16, count), ring / 90
    clear = rng.random(count) < 0.8
    line_load = rng.uniform(10, 60, count)

    def sometimes(share: float, most: float) -> np.ndarray:
        return rng.uniform(0, most, count) * size * clear * (rng.random(count) < share)

    frame = pl.DataFrame(
        {
            "ratio": ratio,
            "disc_count": discs,
            "eccentricity_mm": e,
            "ring_pin_circle_radius_mm": ring,
            "hole_clocking_deg": rng.uniform(-5, 5, count),
            "output_pin_count": pins,
            "output_pin_circle_radius_mm": circle,
            "output_pin_diameter_mm": diameter,
            "disc_outer_radius_mm": 0.95 * ring,
            "disc_bore_radius_mm": 0.2 * circle,
            "output_torque_nm": line_load * width * (ratio + 1) * e * ratio * discs / 4e3,
            "ring_pin_radius_mm": 0.02 * 2 * np.pi * ring / (ratio + 1),
            "disc_width_mm": width,
            "ring_clearance_mm": sometimes(1.0, 0.03),
            "ring_circle_enlargement_mm": sometimes(0.3, 0.02),
            "hole_clearance_mm": sometimes(1.0, 0.08),
            "eccentric_bearing_stiffness_n_per_mm": 10 ** rng.uniform(4.8, 6, count),
            "eccentric_bearing_clearance_mm": sometimes(0.3, 0.01),
            "disc_1_reach_mm": rng.uniform(0.4, 1, count) * diameter,
            "disc_2_reach_mm": rng.uniform(0.8, 1.6, count) * diameter,
            "disc_3_reach_mm": rng.uniform(1.2, 2, count) * diameter,
        }
    )
    base = cs.Drive.reference_87().replace(
        bush_wall_mm=0.0, shaft=(), output_stiffness_nm_per_arcmin=1e9
    )
    return cs.Space.table(base, frame)


def errors(count: int) -> dict[str, object]:
    """Quantiles of the relative error of each column, and how the equilibria were found."""
    space = random_designs(count)
    wanted = ["status", "solver_status", *COMPARED]
    full = cs.scan(space, model="components", solver="full").select(wanted).collect()
    quick = cs.scan(space, model="components").select(wanted).collect()
    found = {}
    for name in COMPARED:
        error = np.abs((quick[name] / full[name] - 1).drop_nulls().to_numpy())
        quantiles = np.quantile(error, [0.5, 0.95, 0.99, 1.0])
        found[name] = dict(zip(("median", "p95", "p99", "max"), map(float, quantiles), strict=True))
    return {
        "designs": count,
        "statuses": dict(full["status"].value_counts().iter_rows()),
        "full": dict(full["solver_status"].value_counts().iter_rows()),
        "quadratic": dict(quick["solver_status"].value_counts().iter_rows()),
        "relative_error": found,
    }


def rate(columns: list[str], solver: str, count: int) -> float:
    """Variants a second of processor time, best of five."""
    space = cs.Space.sobol(
        drive_87(),
        count,
        seed=1,
        disc_width_mm=(8, 16),
        hole_clearance_mm=(0, 0.15),
        ring_clearance_mm=(0, 0.03),
    )
    query = cs.scan(space, model="components", solver=solver).select(columns)  # type: ignore[arg-type]
    best = 0.0
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        query.collect()
        best = max(best, count / (resource.getrusage(resource.RUSAGE_SELF).ru_utime - before))
    return best


def solved_columns() -> list[str]:
    """Every column of the component model, and of the published one."""
    study = cs.Study.of(cs.Space.grid(drive_87()), model="components")
    return [name for name in study.schema() if name in study.outputs]


def rates(count: int) -> dict[str, dict[str, float]]:
    """Rates by engine for columns of growing cost, 87:1 with two discs."""
    solved = solved_columns()
    every = [name for name in solved if name not in FINE]
    cases = {
        "twist at rated torque (8 solves)": ["loaded_twist_arcmin"],
        "twist, and stiffness at 3, 50, 100 % (24 solves)": list(COMPARED[:4]),
        "all but lost motion, the drive without clearance and the fine turn (24 solves)": [
            name for name in every if name not in ("lost_motion_3pct_arcmin", TIGHT)
        ],
        "all but the fine turn (40 solves)": every,
        "all (88 solves)": solved,
    }
    return {
        solver: {case: rate(columns, solver, count) for case, columns in cases.items()}
        for solver in ("quadratic", "full")
    }


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    print(json.dumps({"errors": errors(count), "rates": rates(4096)}, indent=1))
