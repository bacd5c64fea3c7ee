"""Whether `cyclosweep inspect` leads every shared recording to the verdict of its own metadata.

    python proof/lab_files.py SHARED/recordings OUT.json            all, as they are and rewritten
    python proof/lab_files.py SHARED/recordings OUT.json --only foot
    python proof/lab_files.py SHARED/recordings OUT.json --no-diagnosis

Each recording is read three times: by the metadata file that belongs to it, by the one that
inspect proposes given its drive, and, rewritten as laboratories write (other names, units,
separators, format; tests/support/lab_files.py), by the one that inspect proposes for that. Where
readings and settings agree to one part in a million, so does the diagnosis, which is a function of
them; where settings differ, both are diagnosed and the verdicts compared. Repeated on the same
OUT.json, it goes on where it stopped.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import cyclosweep as cs
from cyclosweep.recording.inspection import Inspection, inspect
from cyclosweep.recording.proposed import Known
from tests.support.lab_files import STYLES, rewrite

EXAMPLE = Path(__file__).parents[1] / "examples" / "measured-13-to-1"
SETTINGS = ("side", "history", "conditioning_runs", "holdout_runs", "torque_from",
            "reset_between_runs")  # fmt: skip
ARRAYS = ("torque_nm", "angle_deg", "time_s", "run", "crank_deg", "temperature_c", "unscored")
SAME = 1e-6
"""Largest difference of two readings of one thing, of the largest of them."""
RAW = {"TIME": "time_s", "TORQUE": "torque_nm", "POSITION": "angle_deg", "test_nr": "run",
       "CONTROL_TORQUE": "command", "Q_CURRENT": "current"}  # fmt: skip


def recordings_in(shared: Path) -> dict[Path, Path]:
    """Every measured and practice recording, with its own metadata file."""
    found = dict.fromkeys(sorted(shared.glob("cycloidal*/*.csv.gz")), EXAMPLE / "recording.toml")
    found |= {p: p.with_suffix(".toml") for p in sorted(shared.glob("other-rigs/*.csv"))}
    found |= {p: p.with_suffix(".toml") for p in sorted(shared.glob("practice/*/recording.csv"))}
    series = sorted(shared.glob("cycloidal*/preload-series/*.csv.gz"))
    return found | dict.fromkeys(series, EXAMPLE / "recording.toml")


def differences(a: cs.Recording, b: cs.Recording) -> list[str]:
    """What two readings of one recording do not have in common."""
    found = [name for name in SETTINGS if getattr(a, name) != getattr(b, name)]
    if not np.isclose(a.angle_resolution_deg, b.angle_resolution_deg, rtol=1e-4):
        found.append("angle_resolution_deg")
    for name in ARRAYS:
        x, y = getattr(a, name), getattr(b, name)
        if (x is None) != (y is None):
            found.append(name)
        elif x is not None:
            x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
            if name in ("time_s", "angle_deg"):  # a clock may begin anywhere; so may an encoder
                x, y = x - x[:1], y - y[:1]
            if x.shape != y.shape or np.abs(x - y).max() > SAME * max(np.abs(x).max(), 1e-12):
                found.append(name)
    return found


def raw_table(path: Path) -> dict[str, Any]:
    """Columns of a file by role, in canonical units, nothing selected or averaged."""
    import polars as pl

    frame = pl.read_csv(path)
    table = {RAW.get(name, name): frame[name].to_numpy().astype(float) for name in frame.columns}
    if "POSITION" in frame.columns:
        table["angle_deg"] = 360.0 * table["angle_deg"]
    table.pop("FAULT", None)
    return table


def verdict(recording: cs.Recording, drive: cs.Drive) -> dict[str, Any]:
    """Verdict and named effects of a quick diagnosis."""
    from cyclosweep.diagnosis import diagnose

    found = diagnose(recording, drive, full=False)
    return {"verdict": found.verdict, "effects": sorted(str(e["name"]) for e in found.effects)}


def proposed(path: Path, own: cs.Recording, drive: cs.Drive) -> Inspection:
    """Inspection of a file of which drive and side are told."""
    return inspect(path, Known(drive, own.drive, own.side), {})


def examine(path: Path, meta: Path, style: str, diagnose: bool) -> dict[str, Any]:
    """Read one recording in three ways, and diagnose where they differ."""
    own = cs.Recording.read(path, meta)
    assert own.drive is not None
    drive = cs.Drive.load(own.drive)
    row: dict[str, Any] = {"style": style}
    with tempfile.TemporaryDirectory() as folder:
        rewritten = rewrite(raw_table(path), style, Path(folder), "rewritten")
        for key, file in (("as it is", path), ("rewritten", rewritten)):
            found = proposed(file, own, drive)
            if found.recording is None:
                row[key] = {"open": found.proposal.open}
                continue
            row[key] = {"differs": differences(own, found.recording), "metadata": found.toml}
            if key == "rewritten":
                plain = proposed(path, own, drive).recording
                assert plain is not None
                row[key]["differs_from_as_it_is"] = differences(plain, found.recording)
            if diagnose and row[key]["differs"]:
                row.setdefault("own", verdict(own, drive))
                same = key == "rewritten" and not row[key]["differs_from_as_it_is"]
                row[key] |= row["as it is"] if same and "verdict" in row["as it is"] else {}
                if "verdict" not in row[key]:
                    row[key] |= verdict(found.recording, drive)
    return row


def outcome(row: dict[str, Any], key: str) -> str:
    """One word for a row of the table."""
    found = row[key]
    if "open" in found:
        return "asks"
    if not found["differs"]:
        return "same readings"
    if "verdict" not in found:
        return f"differs in {', '.join(found['differs'])}"
    agree = found["verdict"] == row["own"]["verdict"]
    return f"{found['verdict']}{'' if agree else ' instead of ' + row['own']['verdict']}"


def main() -> int:
    """Run the command; status 1 where a verdict differs or something is asked."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("shared", type=Path, help="folder of the shared recordings")
    parser.add_argument("out", type=Path, help="file of the answers")
    parser.add_argument("--only", default="", help="part of a path")
    parser.add_argument("--no-diagnosis", action="store_true", help="compare readings alone")
    given = parser.parse_args()
    rows: dict[str, Any] = json.loads(given.out.read_text()) if given.out.exists() else {}
    styles = list(STYLES)
    for number, (path, meta) in enumerate(recordings_in(given.shared).items()):
        name = path.relative_to(given.shared).as_posix()
        done = name in rows and (
            given.no_diagnosis or outcome(rows[name], "as it is")[:6] != "differ"
        )
        if given.only not in name or done:
            continue
        rows[name] = examine(path, meta, styles[number % len(styles)], not given.no_diagnosis)
        given.out.write_text(json.dumps(rows, indent=1))
        row = rows[name]
        print(f"{name} | {outcome(row, 'as it is')} | {row['style']} | {outcome(row, 'rewritten')}",
              flush=True)  # fmt: skip
    wrong = [
        name for name, row in rows.items() for key in ("as it is", "rewritten")
        if outcome(row, key) == "asks" or " instead of " in outcome(row, key)
    ]  # fmt: skip
    print(f"{len(rows)} recordings, {len(rows) - len(set(wrong))} with the same verdict")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
