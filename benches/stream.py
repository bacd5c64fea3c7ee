"""One sweep through filter, select and sink in a process of its own: seconds and peak memory.

``python benches/stream.py VARIANTS FOLDER`` prints one JSON object.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import polars as pl

import cyclosweep as cs
from study import bench_space


def peak_kib() -> int:
    """Peak resident memory of this process; `getrusage` would count its parent's."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return int(status.split("VmHWM:")[1].split()[0])


def main() -> None:
    """Run and report."""
    count, folder = int(sys.argv[1]), Path(sys.argv[2])
    baseline = peak_kib()
    began = time.perf_counter()
    query = (
        cs.scan(bench_space(count))
        .filter(pl.col("output_pin_count") >= 8, pl.col("hole_web_mm") > 2.0)
        .select("variant", "output_pin_count", "reflected_compliance_rad_per_nm", "twist_4tn_deg")
    )
    query.sink_parquet(folder / "stream.parquet", compression="lz4")
    seconds = time.perf_counter() - began
    peak = peak_kib()
    rows = pl.scan_parquet(folder / "stream.parquet").select(pl.len()).collect().item()
    print(
        json.dumps(
            {
                "variants": count,
                "seconds": seconds,
                "rows": rows,
                "baseline_mib": baseline / 1024,
                "over_baseline_mib": (peak - baseline) / 1024,
            }
        )
    )


if __name__ == "__main__":
    main()
