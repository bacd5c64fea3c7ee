"""The component model measured: rates, error of the quadratic engine, opponents, and its report."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import polars as pl

import cyclosweep as cs
from components import engines
from opponents import cycloidgen_designs, scipy_equilibrium

__all__ = ["component_lines", "measure_components"]

TEN_MILLION = Path(__file__).parent / "ten_million.json"
"""Record of the sweep of ten million variants, which has a command of its own."""

OURS = {
    "ring_force_n": "ring_pin_force_max_n",
    "output_force_n": "output_pin_force_max_n",
    "ring_pressure_mpa": "ring_contact_pressure_max_mpa",
    "lost_motion_arcmin": "backlash_arcmin",
}
"""cycloidgen's numbers and the columns that mean the same."""

SAME_QUANTITIES = (
    "loaded_twist_arcmin",
    "tangent_stiffness_100pct_nm_per_arcmin",
    "backlash_arcmin",
    "active_ring_pins_mean",
    "effective_output_pins",
    "ring_pin_force_max_n",
    "output_pin_force_max_n",
    "ring_contact_pressure_max_mpa",
    "output_contact_pressure_max_mpa",
    "eccentric_bearing_force_max_n",
    "efficiency",
    "loss_share_ring",
    "loss_share_output",
    "loss_share_eccentric_bearing",
)
"""Columns for the quantities that its three analyses give: the same work."""

CHANGES = {"disc_width_mm": (0.9, 1.1), "hole_clearance_mm": (0.5, 1.5)}
"""What varies around a design when its rate is measured, as factors."""


def measure_components(*, quick: bool) -> dict[str, Any]:
    """Rates, errors and opponents.

    Parameters
    ----------
    quick : bool
        Fewer designs and repetitions.
    """
    count = 2_000 if quick else 20_000
    found: dict[str, Any] = {"errors": engines.errors(count)}
    found["rates"] = engines.rates(512 if quick else 4096)
    found["scipy"] = _scipy(3 if quick else 7)
    found["cycloidgen"] = _cycloidgen(3 if quick else 7)
    return found


def _fastest(run: Callable[[], object], rounds: int) -> float:
    """Processor seconds of the fastest run."""
    run()
    best = float("inf")
    for _ in range(rounds):
        began = time.process_time()
        run()
        best = min(best, time.process_time() - began)
    return best


def _scipy(rounds: int) -> dict[str, float]:
    """One drive at 24 equilibria by SciPy, its twists beside ours, and both rates."""
    drive = engines.drive_87().replace(shaft=(), output_stiffness_nm_per_arcmin=1e9)
    study = cs.Study.of(cs.Space.grid(drive), model="components", solver="full")
    core = dict(study.part_core.mechanism(study.core, 0))
    twists, missed = scipy_equilibrium.twists(core, drive.output_torque_nm)
    if missed:
        raise SystemExit(f"SciPy missed {missed} equilibria")
    row = cs.sweep(study).row(0, named=True)
    ours = row["loaded_twist_arcmin"] - row["twist_shaft_arcmin"]
    seconds = _fastest(lambda: scipy_equilibrium.twists(core, drive.output_torque_nm), rounds)
    columns = list(engines.COMPARED[:4])
    return {
        "difference": abs(float(twists[0]) / ours - 1),
        "ms": seconds * 1e3,
        "quadratic": engines.rate(columns, "quadratic", 4096) * seconds,
        "full": engines.rate(columns, "full", 2048) * seconds,
    }


def _cycloidgen(rounds: int) -> list[dict[str, Any]]:
    """Each design by cycloidgen and by us: time a design by processor time, and numbers."""
    try:
        import cycloidgen  # noqa: F401
    except ImportError:
        return []
    rows = []
    for case in cycloidgen_designs.CASES:
        drive, spec = case.drive(), case.spec()
        theirs = cycloidgen_designs.analyse(spec)
        seconds = _fastest(partial(cycloidgen_designs.analyse, spec), rounds)
        one = cs.scan(cs.Space.grid(drive), model="components").select(*OURS.values()).collect()
        axes: dict[str, Any] = {
            name: tuple(factor * getattr(drive, name) for factor in factors)
            for name, factors in CHANGES.items()
            if getattr(drive, name)
        }
        study = cs.Study.of(cs.Space.sobol(drive, 4096, seed=1, **axes), model="components")
        every = [name for name in engines.solved_columns() if name not in engines.FINE]
        query = cs.scan(study).select("status", *every)
        ours = _fastest(query.collect, rounds) / 4096
        same = _fastest(cs.scan(study).select("status", *SAME_QUANTITIES).collect, rounds) / 4096
        built = query.select((pl.col("status") == "ok").mean()).collect().item()
        if built < 1:
            raise SystemExit(f"{case.name}: {built:.0%} of the variants can be built")
        numbers = {name: (theirs[name], float(one[ours_][0])) for name, ours_ in OURS.items()}
        rows.append(
            {
                "name": case.name,
                "ms": seconds * 1e3,
                "rate_of_a_core": 1 / ours,
                "ahead": seconds / ours,
                "same_rate_of_a_core": 1 / same,
                "same_ahead": seconds / same,
                "gaps_hold": case.gaps_hold,
                "numbers": numbers,
            }
        )
    return rows


def component_lines(found: dict[str, Any]) -> list[str]:
    """The report's section on the component model."""
    errors = found["errors"]
    lines = [
        "## The component model",
        "",
        "Variants a second of processor time (one core; all cores share the work), 87:1 with two "
        "discs, fastest of five runs. A solve is one equilibrium.",
        "",
        "| columns | quadratic | full |",
        "|---|---:|---:|",
    ]
    for case, quick in found["rates"]["quadratic"].items():
        lines.append(f"| {case} | {quick:,.0f} | {found['rates']['full'][case]:,.0f} |")
    lines += [
        "",
        f"Error of the quadratic engine against the full one over {errors['designs']:,} random "
        "designs of ratios 9 to 119 (`benches/components/engines.py`), in per cent. Engines that "
        f"found the equilibria: {errors['quadratic']}; full: {errors['full']}.",
        "",
        "| column | median | 95 of 100 | 99 of 100 | largest |",
        "|---|---:|---:|---:|---:|",
    ]
    for name, row in errors["relative_error"].items():
        cells = " | ".join(f"{100 * row[key]:.2g}" for key in ("median", "p95", "p99", "max"))
        lines.append(f"| `{name}` | {cells} |")
    scipy = found["scipy"]
    lines += [
        "",
        f"A residual in NumPy solved by SciPy's `root` (`benches/opponents/scipy_equilibrium.py`) "
        f"takes {scipy['ms']:.0f} ms for the 24 equilibria of one variant; by processor time the "
        f"quadratic engine is {scipy['quadratic']:,.0f} times, the full one {scipy['full']:,.0f} "
        f"times as fast. Its twist differs from the full engine's by {scipy['difference']:.0e}.",
    ]
    if found["cycloidgen"]:
        lines += [
            "",
            "cycloidgen 8.0.0 analyses contacts, stiffness and efficiency of one design. Ours are "
            f"4,096 variants around the same design, with the {len(SAME_QUANTITIES)} columns for "
            "the quantities that it gives (twist, stiffness, backlash, pins, largest forces and "
            "pressures, efficiency and losses, at eight crank angles), and with every column but "
            "the fine turn's. Processor time of one core, fastest run. The models differ: its ring "
            "contacts lie on a rigid carrier, its largest ring force is that without clearance; "
            "ours share the load through all parts.",
            "",
            "| design | cycloidgen, ms | its quantities, variants/s a core | ahead by "
            "| every column, variants/s a core | ahead by "
            "| largest ring force, N "
            "| largest output force, N | ring pressure, MPa | lost motion, arcmin |",
            "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|",
        ]
        for row in found["cycloidgen"]:
            pairs: list[str] = []
            for name, (theirs, ours) in row["numbers"].items():
                mark = "" if row["gaps_hold"] or name != "lost_motion_arcmin" else "*"
                pairs.append(f"{theirs:.4g}{mark} / {ours:.4g}")
            lines.append(
                f"| {row['name']} | {row['ms']:.1f} "
                f"| {row['same_rate_of_a_core']:,.0f} | {row['same_ahead']:,.0f} "
                f"| {row['rate_of_a_core']:,.0f} "
                f"| {row['ahead']:,.0f} | " + " | ".join(pairs) + " |"
            )
        lines += [
            "",
            "Numbers: cycloidgen's / ours. \\* from gaps on its polyline of 2000 points, which are "
            "wrong by more than the clearance at this number of lobes.",
        ]
    if TEN_MILLION.exists():
        record = json.loads(TEN_MILLION.read_text(encoding="utf-8"))
        lines += [
            "",
            f"{record['variants']:,} variants with {record['columns']} result columns to Parquet "
            f"by `{record['command']}` on {record['date']} (load {record['load']:.1f}): ended by a "
            f"signal after {record['parts_before']} of {record['parts']} parts and resumed; "
            f"{record['seconds']:.0f} s and {record['cpu_seconds']:.0f} processor seconds in all, "
            f"at most {record['peak_mib']:.0f} MiB resident, {record['bytes'] / 2**30:.2f} GiB.",
        ]
    return [*lines, ""]
