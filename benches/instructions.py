"""Instructions a variant, counted by callgrind: a slower kernel shows on a noisy machine.

``python benches/instructions.py [--update]`` compares with ``instructions.json``, keyed by the
compiler's version, and fails when a count has grown by more than a tenth. It says so and skips
without valgrind, cargo, or a count for this compiler.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
COUNTS = Path(__file__).parent / "instructions.json"
WORKLOADS = ("every", "compliance", "grid-every", "grid-compliance")
SMALL, LARGE = 8_192, 24_576
GROWTH = 1.10


def main() -> int:
    """Count, compare, report; the exit status."""
    for tool in ("valgrind", "cargo", "rustc"):
        if shutil.which(tool) is None:
            print(f"instruction counts skipped: no {tool} here")
            return 0
    compiler = _output("rustc", "--version").split("(")[0].strip()
    known = json.loads(COUNTS.read_text(encoding="utf-8")) if COUNTS.exists() else {}
    update = "--update" in sys.argv[1:]
    if compiler not in known and not update:
        print(f"instruction counts skipped: none for {compiler}, only for {', '.join(known)}")
        return 0
    program = _build()
    counts = {name: round(_per_variant(program, name), 1) for name in WORKLOADS}
    if update:
        known[compiler] = counts
        COUNTS.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
    grown = 0
    for name, count in counts.items():
        before = known[compiler][name]
        verdict = "grown" if count > GROWTH * before else "ok"
        grown += verdict == "grown"
        print(f"{name:16} {count:8.1f} instructions a variant, {before:8.1f} before: {verdict}")
    return 1 if grown else 0


def _output(*command: str) -> str:
    return subprocess.run(
        command, cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.strip()


def _build() -> str:
    """The program that callgrind runs, built as the benches are."""
    text = _output(
        *("cargo", "bench", "--locked", "--bench", "instructions", "--no-run"),
        *("--message-format", "json"),
    )
    messages = [json.loads(line) for line in text.splitlines()]
    return next(str(m["executable"]) for m in reversed(messages) if m.get("executable"))


def _per_variant(program: str, workload: str) -> float:
    """Two sizes: their difference leaves the process's own cost out."""
    return (_count(program, workload, LARGE) - _count(program, workload, SMALL)) / (LARGE - SMALL)


def _count(program: str, workload: str, variants: int) -> int:
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [
                *("valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out"),
                *(program, workload, str(variants)),
            ],
            check=True,
            capture_output=True,
            text=True,
            env={**os.environ, "RAYON_NUM_THREADS": "1"},
        )
    found = re.search(r"Collected : (\d+)", done.stderr)
    assert found is not None, done.stderr
    return int(found.group(1))


if __name__ == "__main__":
    sys.exit(main())
