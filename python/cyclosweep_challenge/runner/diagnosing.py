"""The diagnosis as a separate process that is shown recordings and nothing else."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

LAUNCH = "from cyclosweep.cli import main; main()"
LAUNCH_MANY = """
import json, sys
from cyclosweep.cli import app
for arguments in json.loads(sys.argv[1]):
    try:
        app(arguments, standalone_mode=False)
    except (Exception, SystemExit) as error:
        print(error, file=sys.stderr)
"""
"""Several commands in one process, one after the other; what fails leaves the others alone."""
KEPT_ENVIRONMENT = ("PATH", "HOME", "LANG", "LC_ALL", "VIRTUAL_ENV", "PYTHONPATH", "SYSTEMROOT")


def command() -> list[str]:
    """Return the command line that starts the program with this interpreter."""
    return [sys.executable, "-c", LAUNCH]


def _environment() -> dict[str, str]:
    """Environment without anything a run of the challenge may have set; one thread a process."""
    kept = {name: os.environ[name] for name in KEPT_ENVIRONMENT if name in os.environ}
    single = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")
    return kept | dict.fromkeys((*single, "POLARS_MAX_THREADS"), "1")


def _run(program: Sequence[str], arguments: Sequence[str], folder: Path, limit_s: float) -> str:
    """Run the program in a folder; return what went wrong, or nothing."""
    try:
        done = subprocess.run(
            [*program, *arguments],
            cwd=folder,
            env=_environment(),
            capture_output=True,
            text=True,
            timeout=limit_s,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {limit_s:g} s"
    if done.returncode != 0:
        tail = done.stderr.strip().splitlines()[-1:] or ["no message"]
        return f"exit status {done.returncode}: {tail[0]}"
    return ""


def diagnose_batch(
    recordings: Mapping[str, Path],
    results: Path,
    flags: Sequence[str],
    limit_s: float,
    program: Sequence[str],
    beside: Path | None = None,
) -> None:
    """Diagnose recordings in one process and keep what it wrote.

    Parameters
    ----------
    recordings : mapping
        Folder of each recording, by key. Only the CSV and its TOML are copied to where the
        process works, under the key's name.
    results : pathlib.Path
        Folder that receives ``<key>/diagnosis.json`` and ``<key>/model.json``; on failure
        ``diagnosis.json`` holds ``{"failure": message}``.
    flags : sequence of str
        Further flags of ``cyclosweep diagnose``.
    limit_s : float
        Time allowed for each recording [s].
    program : sequence of str
        Command that starts ``cyclosweep``.
    beside : pathlib.Path, optional
        Drive file that the recordings name, to be put beside them.
    """
    with tempfile.TemporaryDirectory(prefix="diagnosis-") as scratch:
        work = Path(scratch)
        for key, folder in recordings.items():
            shutil.copy(folder / "recording.csv", work / f"{key}.csv")
            shutil.copy(folder / "recording.toml", work / f"{key}.toml")
        if beside is not None:
            shutil.copy(beside, work / beside.name)
        start = time.perf_counter()
        files = [f"{key}.csv" for key in recordings]
        message = _run(
            program,
            ["diagnose", *files, "--out", "out", "--json", *flags],
            work,
            limit_s * len(recordings) + 30.0,
        )
        elapsed = (time.perf_counter() - start) / len(recordings)
        for key in recordings:
            found = work / "out" if len(recordings) == 1 else work / "out" / key
            _keep(found, results / key, elapsed, message or "no diagnosis.json")
    failed = {k: recordings[k] for k in recordings if "failure" in read_diagnosis(results, k)}
    if failed and len(recordings) > 1:
        # One bad recording must not cost its neighbours theirs.
        for key, folder in failed.items():
            diagnose_batch({key: folder}, results, flags, limit_s, program, beside)


def _keep(found: Path, target: Path, elapsed_s: float, message: str) -> None:
    """Move one diagnosis to the results, atomically."""
    target.mkdir(parents=True, exist_ok=True)
    source = found / "diagnosis.json"
    answer: dict[str, Any] = (
        json.loads(source.read_text()) if source.exists() else {"failure": message}
    )
    answer["challenge_elapsed_s"] = elapsed_s
    if (found / "model.json").exists():
        shutil.copy(found / "model.json", target / "model.json")
    partial = target / "diagnosis.tmp"
    partial.write_text(json.dumps(answer))
    partial.replace(target / "diagnosis.json")


def read_diagnosis(results: Path, key: str) -> dict[str, Any]:
    """Read back one kept diagnosis."""
    answer: dict[str, Any] = json.loads((results / key / "diagnosis.json").read_text())
    return answer


def predict_batch(
    waiting: Sequence[tuple[Path, Path, Path]], limit_s: float, program: Sequence[str]
) -> None:
    """Let repaired models predict programmes they have not seen, many in one process.

    Parameters
    ----------
    waiting : sequence of (Path, Path, Path)
        Model, programme, and where the prediction goes. A programme's TOML is shown with it.
    limit_s : float
        Time allowed for each [s].
    program : sequence of str
        Command that starts ``cyclosweep``; where empty, one process of this interpreter
        makes all predictions, because starting takes longer than predicting.
    """
    if program:
        for model, later, out in waiting:
            predict(model, later, out, limit_s, program)
        return
    with tempfile.TemporaryDirectory(prefix="prediction-") as scratch:
        work = Path(scratch)
        calls = []
        for k, (model, later, _) in enumerate(waiting):
            shutil.copy(model, work / f"model-{k}.json")
            shutil.copy(later, work / f"program-{k}.csv")
            if later.with_suffix(".toml").exists():
                shutil.copy(later.with_suffix(".toml"), work / f"program-{k}.toml")
            calls.append(
                ["simulate", f"model-{k}.json", f"program-{k}.csv", "--out", f"out-{k}.csv"]
            )
        _run(
            [sys.executable, "-c", LAUNCH_MANY],
            [json.dumps(calls)],
            work,
            limit_s * len(waiting) + 30.0,
        )
        for k, (_, _, out) in enumerate(waiting):
            if (work / f"out-{k}.csv").exists():
                partial = out.with_suffix(".tmp")
                shutil.copy(work / f"out-{k}.csv", partial)
                partial.replace(out)


def predict(model: Path, later: Path, out: Path, limit_s: float, program: Sequence[str]) -> str:
    """Let a repaired model predict a programme it has not seen; return what went wrong, if so."""
    with tempfile.TemporaryDirectory(prefix="prediction-") as scratch:
        work = Path(scratch)
        shutil.copy(model, work / "model.json")
        shutil.copy(later, work / "program.csv")
        if later.with_suffix(".toml").exists():
            shutil.copy(later.with_suffix(".toml"), work / "program.toml")
        message = _run(
            program,
            ["simulate", "model.json", "program.csv", "--out", "prediction.csv"],
            work,
            limit_s,
        )
        if not message and (work / "prediction.csv").exists():
            shutil.copy(work / "prediction.csv", out)
            return ""
        return message or "no prediction was written"
