"""A stand-in for the command line: says friction where the residual follows the direction.

It uses the standard library alone, because starting with NumPy takes longer than its work.
"""

import csv
import json
import math
import sys
from pathlib import Path


def solved(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Solution of three linear equations by elimination; a column of zeros gets zero."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for k in range(3):
        best = max(range(k, 3), key=lambda i: abs(rows[i][k]))
        rows[k], rows[best] = rows[best], rows[k]
        if abs(rows[k][k]) < 1e-9:
            rows[k] = [float(j == k) for j in range(3)] + [0.0]
        for i in range(3):
            if i != k:
                share = rows[i][k] / rows[k][k]
                rows[i] = [a - share * b for a, b in zip(rows[i], rows[k], strict=True)]
    return [rows[k][3] / rows[k][k] for k in range(3)]


def sign(value: float) -> float:
    return math.copysign(1.0, value) if value else 0.0


def diagnose(file: Path, out: Path) -> None:
    seen = {p.name for p in file.parent.iterdir()}
    assert not any("answer" in name or "HASHES" in name for name in seen), seen
    with file.open() as stream:
        table = [(float(r["torque_nm"]), float(r["angle_deg"])) for r in csv.DictReader(stream)]
    basis = [(1.0, sign(torque), torque) for torque, _ in table]
    gram = [[sum(b[i] * b[j] for b in basis) for j in range(3)] for i in range(3)]
    moment = [sum(b[i] * a for b, (_, a) in zip(basis, table, strict=True)) for i in range(3)]
    weights = solved(gram, moment)
    left = [
        a - sum(w * x for w, x in zip(weights, b, strict=True))
        for b, (_, a) in zip(basis, table, strict=True)
    ]
    before = [0.0, *(torque for torque, _ in table[:-1])]
    direction = [sign(torque - b) for (torque, _), b in zip(table, before, strict=True)]
    score = abs(sum(d * r for d, r in zip(direction, left, strict=True)))
    hit = score / math.sqrt(sum(r * r for r in left)) > 3.5
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
    with program.open() as stream:
        rows = list(csv.DictReader(stream))
    with out.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, [*rows[0], "angle_deg"])
        writer.writeheader()
        for row in rows:
            torque = float(row["torque_nm"])
            writer.writerow(row | {"angle_deg": 28.0 * sign(torque) + 2.73 * torque})


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
