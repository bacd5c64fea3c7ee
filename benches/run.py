"""All benchmarks with one command; writes docs/performance.md, its plot and its JSON.

``python benches/run.py [--quick] [--full]``: quick takes smaller runs and writes to
``out/bench`` instead of docs; full adds 1e8 variants through filter, select and sink.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
import polars as pl

import cyclosweep as cs
from component_model import measure_components
from cyclosweep.sweep.dataset import ROWS_PER_PART
from cyclosweep.sweep.part_file import COMPRESSION
from diagnosis import measure_diagnoses
from measure import Timing, alternate
from opponents import numba_closed, numpy_closed, theta
from opponents.common import COLUMNS, columns_of
from report import write_report
from study import DRIVE, bench_space

BENCHES = Path(__file__).parent
COMPLIANCE = (
    "output_compliance_rad_per_nm",
    "reflected_compliance_rad_per_nm",
    "reflected_stiffness_nm_per_rad",
    "output_stiffness_nm_per_arcmin",
    *(name for name in COLUMNS if name.startswith("twist_")),
)
Codec = Literal["uncompressed", "snappy", "lz4", "zstd"]
CODECS: tuple[Codec, ...] = get_args(Codec)


def main() -> None:
    """Measure everything and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="smaller and fewer runs")
    parser.add_argument("--full", action="store_true", help="1e8 variants too")
    arguments = parser.parse_args()
    count, rounds = (2**17, 3) if arguments.quick else (2**20, 7)
    results: dict[str, Any] = {"machine": _machine(), "count": count, "rounds": rounds}
    results["command"] = " ".join(["python", "benches/run.py", *sys.argv[1:]])
    print("agreement with the opponents")
    results["agreement"] = _agreement()
    print("in memory")
    results["memory"] = _in_memory(count, rounds)
    print("full grid")
    results["grid"] = _grid(count, rounds)
    print("Parquet")
    with tempfile.TemporaryDirectory() as folder:
        results["codecs"] = _codecs(count, rounds, Path(folder))
        results["parquet"] = _parquet(count, rounds, Path(folder))
        print("streams")
        results["streams"] = _streams(arguments, Path(folder))
    print("component model")
    results["components"] = measure_components(quick=arguments.quick)
    print("diagnosis")
    results["diagnosis"] = measure_diagnoses(quick=arguments.quick)
    target = BENCHES.parent / ("out/bench" if arguments.quick else "docs")
    write_report(results, target)
    print(f"written to {target.relative_to(BENCHES.parent)}/performance.md")


def _machine() -> dict[str, Any]:
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    versions = {"python": platform.python_version(), "polars": pl.__version__}
    versions |= {"numpy": np.__version__, "cyclosweep": cs.__version__}
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "cores": os.cpu_count(),
        "memory_gib": round(memory),
        "architecture": platform.machine(),
        "load": os.getloadavg()[0],
        "versions": versions,
    }


def _agreement() -> dict[str, float]:
    """Largest relative difference of each closed form from ours; refuses to time beyond 1e-9."""
    table = cs.sweep(bench_space(2**16))
    axes = columns_of(table)
    ours = [table[name].cast(pl.Float64).fill_null(np.nan).to_numpy() for name in COLUMNS]
    found = {}
    for name, run in (("numpy", numpy_closed.run), ("numba", numba_closed.run)):
        worst = 0.0
        for mine, theirs in zip(ours, run(axes), strict=True):
            if not np.array_equal(np.isnan(mine), np.isnan(theirs)):
                raise SystemExit(f"{name} refuses other variants than cyclosweep")
            worst = max(worst, float(np.nanmax(np.abs(theirs / mine - 1.0))))
        if worst > 1e-9:
            raise SystemExit(f"{name} differs by {worst:.1e}")
        found[name] = worst
    few = tuple(axis[:500] for axis in axes)
    for name, run in (("theta numpy", theta.run_numpy), ("theta numba", theta.run_numba)):
        mean = run(few)[0]
        found[name] = float(np.nanmax(np.abs(mean / ours[0][:500] - 1.0)))
        if found[name] > 1e-2:
            raise SystemExit(f"{name} differs by {found[name]:.1e}")
    return found


def _in_memory(count: int, rounds: int) -> dict[str, Any]:
    """Whole tables in memory, ours and the opponents' in turn."""
    study = cs.Study.of(bench_space(count))
    table = cs.sweep(study)
    axes = columns_of(table)
    given = cs.Study.of(cs.Space.table(DRIVE, table.select([a.name for a in study.space.axes])))
    names = list(study.outputs)
    few, fewer = 4_000, 1_000
    return _rates(
        alternate(
            {
                "cyclosweep, sweep to a frame": (count, lambda: cs.sweep(study)),
                "cyclosweep, kernel": (
                    count,
                    lambda: study.core.evaluate_range(0, count, names),
                ),
                "cyclosweep, kernel, inputs given": (
                    count,
                    lambda: given.core.evaluate_range(0, count, names),
                ),
                "Numba parallel, closed form": (count, lambda: numba_closed.run(axes)),
                "NumPy, closed form": (count, lambda: numpy_closed.run(axes)),
                "Numba parallel, 720 positions": (
                    few,
                    lambda: theta.run_numba(tuple(axis[:few] for axis in axes)),
                ),
                "NumPy, 720 positions": (
                    fewer,
                    lambda: theta.run_numpy(tuple(axis[:fewer] for axis in axes)),
                ),
            },
            rounds,
        )
    )


def _grid(count: int, rounds: int) -> dict[str, Any]:
    """A full grid, where what depends on few axes is computed once a combination of them."""
    space = cs.Space.grid(
        DRIVE,
        eccentricity_mm=cs.linspace(0.3, 0.8, 8),
        output_pin_count=[6, 7, 8, 9, 10, 11, 12],
        output_pin_circle_radius_mm=cs.linspace(42.0, 50.0, 8),
        output_pin_diameter_mm=cs.linspace(10.0, 17.0, 8),
        output_pin_length_mm=cs.linspace(25.0, 50.0, 8),
        hole_clocking_deg=cs.linspace(-2.0, 2.0, 5),
        shaft_1_length_mm=cs.linspace(50.0, 80.0, 10),
        shaft_3_diameter_mm=cs.linspace(51.0, 59.0, 10),
    )
    core = cs.Study.of(space).core
    total = min(len(space), 4 * count)
    names = list(COMPLIANCE)
    twists = [name for name in COMPLIANCE if name.startswith("twist_")]
    return _rates(
        alternate(
            {
                "grid, compliance and twist": (
                    total,
                    lambda: core.evaluate_range(0, total, names),
                ),
                "grid, twist only": (total, lambda: core.evaluate_range(0, total, twists)),
                "grid, every column": (
                    count,
                    lambda: core.evaluate_range(0, count, list(COLUMNS)),
                ),
            },
            rounds,
        )
    )


def _codecs(count: int, rounds: int, folder: Path) -> list[dict[str, Any]]:
    """Each compression on the same table: size and rate of polars alone."""
    table = cs.sweep(bench_space(count))
    path = folder / "codec.parquet"

    def writer(codec: Codec) -> Any:
        return lambda: table.write_parquet(
            path, compression=codec, row_group_size=ROWS_PER_PART, statistics=True
        )

    timings = alternate({codec: (count, writer(codec)) for codec in CODECS}, rounds)
    rows = []
    for codec in CODECS:
        writer(codec)()
        size, timing = path.stat().st_size / count, timings[codec]
        rows.append(
            {
                "codec": codec,
                "bytes_per_variant": size,
                "rate": timing.rate,
                "best": timing.best,
            }
        )
    path.unlink()
    return rows


def _parquet(count: int, rounds: int, folder: Path) -> dict[str, Any]:
    """The sweep to a dataset, kernel included, against polars writing the finished table."""
    study = cs.Study.of(bench_space(2 * count))
    names = list(study.outputs)
    table = cs.sweep(study)
    path = folder / "alone.parquet"
    timings = alternate(
        {
            "kernel": (
                len(study),
                lambda: study.core.evaluate_range(0, len(study), names),
            ),
            "sweep to a frame": (len(study), lambda: cs.sweep(study)),
            "polars, write alone": (
                len(study),
                lambda: table.write_parquet(
                    path, compression=COMPRESSION, row_group_size=ROWS_PER_PART
                ),
            ),
            "sweep to a dataset": (
                len(study),
                lambda: cs.sink(study, folder / "dataset", fresh=True, progress=False),
            ),
        },
        rounds,
    )
    found = _rates(timings)
    ours, writer = timings["sweep to a dataset"], timings["polars, write alone"]
    found["share_of_fastest"] = ours.best / writer.best
    found["share_of_a_core"] = ours.rate_of_a_core / writer.rate_of_a_core
    found["compression"] = COMPRESSION
    return found


def _streams(arguments: argparse.Namespace, folder: Path) -> list[dict[str, Any]]:
    """Filter, select, sink at growing counts, each in a process of its own."""
    sizes = [10**5, 10**6] if arguments.quick else [10**5, 10**6, 10**7]
    if arguments.full:
        sizes.append(10**8)
    rows = []
    for size in sizes:
        # Small ones are repeated: their time is otherwise one reading of a noisy clock.
        runs = []
        for _ in range(3 if size <= 10**6 else 1):
            command = [sys.executable, str(BENCHES / "stream.py"), str(size), str(folder)]
            done = subprocess.run(command, check=True, capture_output=True, text=True)
            runs.append(json.loads(done.stdout))
        rows.append(sorted(runs, key=lambda run: float(run["seconds"]))[len(runs) // 2])
        print(f"  {size:.0e}: {rows[-1]['seconds']:.1f} s")
    return rows


def _rates(timings: dict[str, Timing]) -> dict[str, Any]:
    return {
        name: {
            "rate": timing.rate,
            "best": timing.best,
            "rate_of_a_core": timing.rate_of_a_core,
        }
        for name, timing in timings.items()
    }


if __name__ == "__main__":
    main()
