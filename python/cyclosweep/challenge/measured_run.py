"""The real drive: measured loops diagnosed as they are, as a null, and with effects injected."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from cyclosweep.challenge.diagnosing import command, diagnose_batch, read_diagnosis
from cyclosweep.challenge.measured import (
    INJECTABLE,
    injected,
    read_loops,
    repeated_null,
    repeats,
    write_loops,
)

ALARMS = ("IDENTIFIED", "AMBIGUOUS", "UNKNOWN_PHYSICS")


@dataclass(frozen=True)
class Row:
    """What was said of one variant of a measured file.

    Attributes
    ----------
    file, kind : str
        Measured file, and ``as measured``, ``repeated loops`` or the effect injected.
    size_deg : float
        Size of the injected effect after re-calibration, as rms [deg]; zero for none.
    verdict : str
        Verdict of the diagnosis.
    named : tuple of str
        Effects it accepted.
    found : bool or None
        Whether an injected effect was named that the file as measured does not show; for
        repeated loops, whether nothing was said to be missing; None for the file as measured.
    """

    file: str
    kind: str
    size_deg: float
    verdict: str
    named: tuple[str, ...]
    found: bool | None


def run_measured(
    source: str | Path,
    out: str | Path,
    drive_file: str | Path,
    *,
    sizes_deg: Sequence[float] = (0.05, 0.1, 0.2, 0.4),
    seed: int = 1,
    flags: Sequence[str] = (),
    limit_s: float = 120.0,
    program: Sequence[str] = (),
) -> list[Row]:
    """Diagnose measured loops, real nulls and injected effects.

    Parameters
    ----------
    source : str or pathlib.Path
        Folder with the measured ``*.csv.gz`` files.
    out : str or pathlib.Path
        Folder of the run; what is there already is not done again.
    drive_file : str or pathlib.Path
        Drive file of the measured drive.
    sizes_deg : sequence of float
        Sizes of injected effects after re-calibration, as rms [deg].
    seed : int
        Seed of the injected shapes.
    flags : sequence of str
        Further flags of ``cyclosweep diagnose``.
    limit_s : float
        Time allowed for one recording [s].
    program : sequence of str
        Command that starts ``cyclosweep``; with this interpreter if empty.

    Returns
    -------
    list of Row
        Also in ``measured.json`` of the folder; empty, with nothing written, where the data
        are absent.
    """
    files = sorted(Path(source).glob("*.csv.gz"))
    if not files:
        return []
    folder, drive = Path(out), Path(drive_file)
    plan = _write(files, folder / "recordings", drive.name, sizes_deg, seed)
    results = folder / "diagnoses"
    waiting = [key for key, *_ in plan if not (results / key / "diagnosis.json").exists()]
    for key in waiting:
        diagnose_batch(
            {key: folder / "recordings" / key},
            results,
            flags,
            limit_s,
            tuple(program) or tuple(command()),
            drive,
        )
    rows = _rows(plan, results)
    (folder / "measured.json").write_text(json.dumps([asdict(row) for row in rows], indent=1))
    return rows


def _write(
    files: Sequence[Path], target: Path, drive: str, sizes_deg: Sequence[float], seed: int
) -> list[tuple[str, str, str, float]]:
    """Write all variants; return key, file, kind and size of each."""
    plan = []
    for number, file in enumerate(files):
        loops = read_loops(file)
        variants = [("as measured", 0.0, loops)]
        null = repeated_null(loops)
        if repeats(null):
            variants.append(("repeated loops", 0.0, null))
        for name in INJECTABLE:
            # One shape a file and effect, at every size, so that only the size differs.
            for size in sizes_deg:
                rng = np.random.default_rng([seed, number, INJECTABLE.index(name)])
                variants.append((name, size, injected(loops, name, size, rng)))
        for k, (kind, size, variant) in enumerate(variants):
            key = f"file-{number}-{k:02d}"
            write_loops(variant, target / key, drive, conditioning=kind != "repeated loops")
            plan.append((key, file.name, kind, size))
    return plan


def _rows(plan: Sequence[tuple[str, str, str, float]], results: Path) -> list[Row]:
    """Lay what was said beside what was done."""
    shown: dict[str, set[str]] = {}
    rows = []
    for key, file, kind, size in plan:
        said = read_diagnosis(results, key)
        verdict = str(said.get("verdict", "FAILURE"))
        named = tuple(str(effect.get("name")) for effect in said.get("effects") or [])
        found: bool | None = None
        if kind == "as measured":
            shown[file] = set(named)
        elif kind == "repeated loops":
            found = verdict not in ALARMS and verdict != "FAILURE"
        else:
            found = kind in named and kind not in shown[file]
        rows.append(Row(file, kind, size, verdict, named, found))
    return rows
