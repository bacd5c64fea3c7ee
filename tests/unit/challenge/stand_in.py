"""A stand-in for the command line: says friction where the residual follows the direction."""

import json
import sys
from pathlib import Path

import numpy as np
import polars as pl


def diagnose(file: Path, out: Path) -> None:
    seen = {p.name for p in file.parent.iterdir()}
    assert not any("answer" in name or "HASHES" in name for name in seen), seen
    table = pl.read_csv(file)
    torque, angle = table["torque_nm"].to_numpy(), table["angle_deg"].to_numpy()
    basis = np.column_stack([np.ones_like(torque), np.sign(torque), torque])
    left = angle - basis @ np.linalg.lstsq(basis, angle)[0]
    direction = np.sign(np.diff(torque, prepend=0.0))
    hit = abs(direction @ left) / np.std(left) / np.sqrt(left.size) > 3.5
    effect = {"name": "friction_hysteresis", "size_deg": {"estimate": 0.1, "ci95": [0.05, 0.2]}}
    answer = {
        "verdict": "IDENTIFIED" if hit else "NOTHING_MISSING",
        "effects": [effect] if hit else [],
        "explanation_set": [{"effects": ["friction_hysteresis"], "probability": 0.9}] * int(hit),
        "not_testable": [{"name": "rig_compliance"}, {"name": "torque_offset"}],
        "baseline": {"parameters": {"compliance_scale": {"estimate": 1.0}}},
    }
    out.mkdir(parents=True, exist_ok=True)
    (out / "diagnosis.json").write_text(json.dumps(answer))
    (out / "model.json").write_text("{}")


def simulate(program: Path, out: Path) -> None:
    table = pl.read_csv(program)
    torque = table["torque_nm"].to_numpy()
    table.with_columns(angle_deg=pl.Series(28.0 * np.sign(torque) + 2.73 * torque)).write_csv(out)


def main(arguments: list[str]) -> int:
    out = Path(arguments[arguments.index("--out") + 1])
    if arguments[0] == "simulate":
        simulate(Path(arguments[2]), out)
        return 0
    if "--without" in arguments and "--refuse" in arguments:
        print("no such flag", file=sys.stderr)
        return 2
    files = [Path(a) for a in arguments[1:] if a.endswith(".csv")]
    for file in files:
        diagnose(file, out if len(files) == 1 else out / file.stem)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
