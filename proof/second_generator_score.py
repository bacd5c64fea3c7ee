"""Diagnose a set of the second generator and print the figures that its tier is judged by.

    python -m cyclosweep_challenge.second_generator --tier C8 --cases 20 --seed 1 --out DIR
    python -m proof.second_generator_score DIR

The diagnosis runs in processes of its own, which are shown recordings and nothing else; with
``--without`` where the answer says that an effect is taken out. Its answers stay in DIR/diagnoses,
and a second run goes on where the first stopped. Shares are printed with the number of cases.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

from cyclosweep_challenge.runner.diagnosing import (
    command,
    diagnose_batch,
    predict,
    read_diagnosis,
)

LIMIT_S = 300.0
"""Time allowed for one recording [s]."""
ENOUGH = 0.95
"""Part to reach of what the generator's own law removes on the unseen programme [-]."""
QUIET = ("NOTHING_MISSING", "INSUFFICIENT_DATA")
"""Verdicts that claim no physics."""


def diagnose(folder: Path, answers: dict[str, Any]) -> None:
    """Diagnose what has no answer yet and let the repaired models predict the unseen programmes."""
    results = folder / "diagnoses"
    for key, truth in answers.items():
        case = folder / key
        if not (results / key / "diagnosis.json").exists():
            removed = truth.get("removed", "")
            flags = ["--quick", *(["--without", removed] if removed else [])]
            drive = case / "drive.toml"
            beside = drive if drive.exists() else None
            diagnose_batch({key: case}, results, flags, LIMIT_S, command(), beside)
        out = results / key / "prediction.csv"
        if not out.exists() and (results / key / "model.json").exists():
            predict(results / key / "model.json", case / "program.csv", out, LIMIT_S, command())


def removed_share(folder: Path, key: str, truth: dict[str, Any]) -> float:
    """Part of the mismatch removed on the unseen programme over what the true law removes [-].

    Zero without a prediction; not-a-number where the true law itself removes less than half, as
    where its course is chance.
    """
    if truth["held_out_removed_by_truth"] < 0.5:
        return float("nan")
    out = folder / "diagnoses" / key / "prediction.csv"
    if not out.exists():
        return 0.0
    clean = pl.read_csv(folder / "truth" / f"{key}-program.csv")["clean_deg"].to_numpy()
    angle = pl.read_csv(out)["angle_deg"].to_numpy()
    rms = float(np.sqrt(np.mean((angle - clean) ** 2)))
    share = 1.0 - rms / truth["held_out_calibrated_rms_deg"]
    return float(max(share, 0.0) / truth["held_out_removed_by_truth"])


def judge(folder: Path, key: str, truth: dict[str, Any]) -> dict[str, float]:
    """Figures of one case: each one or zero, or not-a-number where it does not apply."""
    answer = read_diagnosis(folder / "diagnoses", key)
    verdict = str(answer.get("verdict", "FAILURE"))
    named = {str(effect["name"]) for effect in answer.get("effects") or []}
    true = set(truth["effects"])
    wanted = {c["name"] for c in truth["causes"] if c["above_hundredth"] and c["kind"] == "effect"}
    dominant = {c["name"] for c in truth["causes"] if c["dominant"]}
    clean = not named - true
    share = removed_share(folder, key, truth)
    figures = {"false name": float(not clean), "seconds": float(answer["challenge_elapsed_s"])}
    if truth["tier"] == "nothing":
        figures["alarm"] = float(verdict not in QUIET)
    if truth["tier"] == "C9":
        right = named == true and (bool(true) == (verdict not in QUIET))
        figures["right or insufficient"] = float(right or verdict == "INSUFFICIENT_DATA")
    if truth["tier"] in ("stranger", "deleted"):
        figures["unknown or mostly explained"] = float(
            verdict in ("UNKNOWN_PHYSICS", "MOSTLY_EXPLAINED")
        )
    if truth["tier"] == "single":
        figures["named right"] = float(named == true)
    if truth["tier"] == "C8":
        figures["dominant named"] = float(dominant <= named)
        figures["dominant named, nothing false"] = float(dominant <= named and clean)
        figures["all above a hundredth named, nothing false"] = float(wanted <= named and clean)
        figures["removed of what the true law removes"] = share
        figures[f"the same at least {ENOUGH:g}"] = (
            float(share >= ENOUGH) if np.isfinite(share) else share
        )
    return figures


def table(rows: Sequence[tuple[str, dict[str, float]]]) -> str:
    """Markdown table of means by group, and over all cases."""
    groups: dict[str, list[dict[str, float]]] = defaultdict(list)
    for group, figures in rows:
        groups[group].append(figures)
        groups["all"].append(figures)
    names = list(dict.fromkeys(name for _, figures in rows for name in figures))
    lines = [
        "| cases of | number | " + " | ".join(names) + " |",
        "|---|" + "---|" * (len(names) + 1),
    ]
    for group in sorted(groups, key=lambda g: (g == "all", g)):
        found = groups[group]
        cells = []
        for name in names:
            values = [f[name] for f in found if name in f and np.isfinite(f[name])]
            cells.append(f"{np.mean(values):.2f}" if values else "–")
        lines.append(f"| {group} | {len(found)} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main() -> None:
    """Diagnose, judge and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    given = parser.parse_args()
    answers = json.loads((given.folder / "truth.json").read_text())
    diagnose(given.folder, answers)
    # The number of effects is of no interest beside the family of friction.
    rows = [
        (truth["stratum"].split("/effects=")[0], judge(given.folder, key, truth))
        for key, truth in answers.items()
    ]
    print(table(rows))


if __name__ == "__main__":
    main()
