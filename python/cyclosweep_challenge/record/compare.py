"""Compare the figures of a run with those of a record, within their intervals."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

FEWEST = 10
"""Figures that rest on fewer cases are not compared."""


@dataclass(frozen=True)
class Pair:
    """One figure of two runs.

    Attributes
    ----------
    name : str
        The figure.
    ours, record : dict
        Estimate of this run and of the record: value, low, high, count.
    fits : bool
        Whether their difference is within its own 95 % interval.
    """

    name: str
    ours: Mapping[str, Any]
    record: Mapping[str, Any]
    fits: bool


def fits(a: Mapping[str, Any], b: Mapping[str, Any]) -> bool:
    """Whether two estimates differ by no more than their intervals, added in quadrature."""
    high, low = (a, b) if a["value"] >= b["value"] else (b, a)
    reach = math.hypot(high["value"] - high["low"], low["high"] - low["value"])
    return bool(high["value"] - low["value"] <= reach + 1e-9)


def pairs(ours: Mapping[str, Any], record: Mapping[str, Any]) -> list[Pair]:
    """Figures that both runs have and that runs of another size should share."""
    known = {f["name"]: f["estimate"] for f in record["figures"]}
    found = []
    for figure in ours["figures"]:
        name, here = figure["name"], figure["estimate"]
        there = known.get(name)
        if there is None or not figure["comparable"] or here["value"] is None:
            continue
        whole = all(e[k] is not None for e in (here, there) for k in ("value", "low", "high"))
        if whole and min(here["count"], there["count"]) >= FEWEST:
            found.append(Pair(name, here, there, fits(here, there)))
    return found


def compare(out: Path, against: Path, screen: Console) -> list[Pair]:
    """Print the figures of a run beside those of record.

    Parameters
    ----------
    out : pathlib.Path
        Folder of the run.
    against : pathlib.Path
        ``proof.json`` of the record.
    screen : rich.console.Console
        Where the table goes.

    Returns
    -------
    list of Pair
        Every figure compared; empty where there is no record yet.
    """
    if not against.exists():
        screen.print(f"{against}: no record to compare with yet")
        return []
    record = json.loads(against.read_text())
    found = pairs(json.loads((out / "score.json").read_text()), record)
    table = Table(title=f"Against the record of seed {record['about']['seed']}")
    for heading in ("figure", "here [95 %]", "record [95 %]", ""):
        table.add_column(heading)
    for pair in found:
        words = "" if pair.fits else "[red]differs[/red]"
        table.add_row(pair.name, _text(pair.ours), _text(pair.record), words)
    screen.print(table)
    apart = sum(not pair.fits for pair in found)
    screen.print(
        f"{len(found) - apart} of {len(found)} figures agree within their intervals; "
        f"by chance alone about {math.ceil(0.05 * len(found))} would not"
    )
    own = json.loads((out / "record.json").read_text())
    if own["diagnosis"] != record["record"]["diagnosis"]:
        screen.print("the code of the diagnosis is another than that of the record")
    return found


def _text(e: Mapping[str, Any]) -> str:
    """Estimate with its interval."""
    return f"{e['value']:.3g} [{e['low']:.3g}, {e['high']:.3g}]"
