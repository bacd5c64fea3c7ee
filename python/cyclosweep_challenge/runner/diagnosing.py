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
DRIVE_FILE = "drive.toml"
"""Drive file beside a recording of a drive that is not built in."""
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
            shown = lay_out(model, later, work / str(k))
            calls.append(["simulate", *(f"{k}/{name}" for name in shown), "--out", f"out-{k}.csv"])
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


def lay_out(model: Path, later: Path, folder: Path) -> tuple[str, str]:
    """Copy a model and a programme, with its TOML and drive file, to where a process works.

    Parameters
    ----------
    model, later : pathlib.Path
        Model file, and CSV of the programme.
    folder : pathlib.Path
        Where they go.

    Returns
    -------
    tuple of str
        Names of model and programme there.
    """
    folder.mkdir(exist_ok=True)
    shutil.copy(model, folder / "model.json")
    shutil.copy(later, folder / "program.csv")
    if later.with_suffix(".toml").exists():
        shutil.copy(later.with_suffix(".toml"), folder / "program.toml")
    if (later.parent / DRIVE_FILE).exists():
        shutil.copy(later.parent / DRIVE_FILE, folder / DRIVE_FILE)
    return "model.json", "program.csv"


def predict(model: Path, later: Path, out: Path, limit_s: float, program: Sequence[str]) -> str:
    """Let a repaired model predict a programme it has not seen; return what went wrong, if so."""
    with tempfile.TemporaryDirectory(prefix="prediction-") as scratch:
        work = Path(scratch)
        shown = lay_out(model, later, work)
        arguments = ["simulate", *shown, "--out", "prediction.csv"]
        message = _run(program, arguments, work, limit_s)
        if not message and (work / "prediction.csv").exists():
            shutil.copy(work / "prediction.csv", out)
            return ""
        return message or "no prediction was written"
