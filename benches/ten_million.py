"""Ten million variants of the component model to Parquet: killed on the way, resumed, recorded.

    python benches/ten_million.py [VARIANTS] [FOLDER]

The folder is deleted at the end. Only the whole ten million are written to the record that
docs/performance.md shows; some GiB of disk are needed for them.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from datetime import UTC, datetime
from pathlib import Path

import polars as pl

import cyclosweep as cs
from components.engines import drive_87

VARIANTS = 10_000_000
RECORD = Path(__file__).with_suffix(".json")
KILLED_AT = 0.4
"""Share of the parts after which the first run is killed."""
MOST_MIB = 300.0
"""Most memory that a run may hold."""


def space_of(count: int) -> cs.Space:
    """Variants of the 87:1 drive, all of which can be built."""
    return cs.Space.sobol(
        drive_87(),
        count,
        seed=1,
        disc_width_mm=(8, 16),
        hole_clearance_mm=(0, 0.15),
        ring_clearance_mm=(0, 0.03),
        ring_pin_radius_mm=(1.6, 2.2),
        eccentric_bearing_stiffness_n_per_mm=(2e5, 8e5),
    )


def parts_in(folder: Path) -> int:
    """Whole parts."""
    return len(list(folder.glob("**/*.parquet")))


def run(count: int, folder: Path, kill_at: int | None) -> float:
    """Sweep in a process of its own; the most memory [MiB] it held."""
    command = [sys.executable, __file__, "--sink", str(count), str(folder)]
    peak = 0.0
    with subprocess.Popen(command) as process:
        status = Path(f"/proc/{process.pid}/status")
        while process.poll() is None:
            text = status.read_text(encoding="ascii")
            if "VmHWM:" in text:
                peak = max(peak, int(text.split("VmHWM:")[1].split()[0]) / 1024)
            if kill_at is not None and parts_in(folder) >= kill_at:
                process.kill()
            time.sleep(0.05)
        if kill_at is None and process.returncode:
            raise SystemExit(process.returncode)
    return peak


def main() -> None:
    """Sweep, kill, resume, check, record."""
    if sys.argv[1:2] == ["--sink"]:
        count, folder = int(sys.argv[2]), Path(sys.argv[3])
        cs.sink(space_of(count), folder, model="components", progress=False)
        return
    count = int(sys.argv[1]) if len(sys.argv) > 1 else VARIANTS
    folder = Path(sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp(dir="."))
    load = os.getloadavg()[0]
    parts = -(-count // 2**14)
    began = time.perf_counter()
    peak = run(count, folder, kill_at=max(1, int(KILLED_AT * parts)))
    before = parts_in(folder)
    peak = max(peak, run(count, folder, kill_at=None))
    seconds = time.perf_counter() - began
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    files = list(folder.glob("**/*.parquet"))
    counts = pl.scan_parquet(files).group_by("status").len().collect()
    status = {str(name): int(rows) for name, rows in counts.iter_rows()}
    found = {
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "command": "make bench-ten-million",
        "load": load,
        "variants": count,
        "columns": len(cs.Study.of(space_of(1), model="components").outputs),
        "status": status,
        "parts": len(files),
        "parts_before": before,
        "seconds": seconds,
        "cpu_seconds": used.ru_utime + used.ru_stime,
        "peak_mib": peak,
        "bytes": sum(file.stat().st_size for file in files),
    }
    shutil.rmtree(folder)
    text = json.dumps(found, indent=1) + "\n"
    print(text)
    if sum(status.values()) != count or not 0 < before < len(files):
        raise SystemExit("not every variant is there, or the sweep was not interrupted")
    if peak > MOST_MIB:
        raise SystemExit(f"{peak:.0f} MiB resident, expected at most {MOST_MIB:.0f}")
    if count == VARIANTS:
        RECORD.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
