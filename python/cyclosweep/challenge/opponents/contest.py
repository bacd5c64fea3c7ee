"""Opponents meet the recordings, in processes of their own, and their words are kept."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from cyclosweep.challenge.plan import Entry

CHEAP = ("runs_test", "ljung_box", "aic_subset", "bic_subset", "stlsq", "error_ladder")
COSTLY = ("lasso_cv", "bagged_stlsq", "gaussian_process")


def _entrants(names: Sequence[str]) -> dict[str, Callable[..., Any]]:
    """Return the opponents asked for; imported here because their libraries are an extra."""
    from cyclosweep.challenge.opponents.gaussian_process import gaussian_process
    from cyclosweep.challenge.opponents.ladder import error_ladder
    from cyclosweep.challenge.opponents.lasso import lasso_cv
    from cyclosweep.challenge.opponents.ljung_box import ljung_box
    from cyclosweep.challenge.opponents.runs_test import runs_test
    from cyclosweep.challenge.opponents.stlsq import bagged_stlsq, stlsq
    from cyclosweep.challenge.opponents.subset import aic_subset, bic_subset

    every: dict[str, Callable[..., Any]] = {
        "runs_test": runs_test,
        "ljung_box": ljung_box,
        "aic_subset": aic_subset,
        "bic_subset": bic_subset,
        "lasso_cv": lasso_cv,
        "stlsq": stlsq,
        "bagged_stlsq": bagged_stlsq,
        "gaussian_process": gaussian_process,
        "error_ladder": error_ladder,
    }
    return {name: every[name] for name in names}


def meet(recording: Path, results: Path, key: str, names: tuple[str, ...]) -> None:
    """Let opponents see one recording; those that have seen it before are left out."""
    from cyclosweep.challenge.opponents.seen import Seen

    file = results / f"{key}.json"
    said: dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    missing = [name for name in names if name not in said]
    if not missing:
        return
    seen = Seen.read(recording)
    for name, opponent in _entrants(missing).items():
        said[name] = asdict(opponent(seen))
    partial = file.with_suffix(".tmp")
    partial.write_text(json.dumps(said))
    partial.replace(file)


def meet_opponents(
    plan: Sequence[Entry], recordings: Path, results: Path, who: str, costly_limit: int
) -> list[tuple[Callable[..., None], tuple[Any, ...]]]:
    """List the meetings of a challenge: single effects in the open, and nothing missing.

    Parameters
    ----------
    plan : sequence of Entry
        The challenge's cases.
    recordings, results : pathlib.Path
        Folder of the recordings, and where the opponents' words go.
    who : {"all", "cheap", "none"}
        Which opponents.
    costly_limit : int
        Recordings of each stratum that the costly ones see.

    Raises
    ------
    ValueError
        If ``who`` is none of these.
    """
    if who not in {"all", "cheap", "none"}:
        raise ValueError(f"opponents: found {who!r}, expected all, cheap or none")
    if who == "none":
        return []
    count: Counter[str] = Counter()
    jobs: list[tuple[Callable[..., None], tuple[Any, ...]]] = []
    for entry in plan:
        stratum = entry.stratum
        plain = stratum.noise == "white" and stratum.programme in {"rich", "poor"}
        if stratum.tier not in {"C0", "C6"} or not plain:
            continue
        count[stratum.name] += 1
        costly = COSTLY if who == "all" and count[stratum.name] <= costly_limit else ()
        jobs.append((meet, (recordings / entry.key, results, entry.key, (*CHEAP, *costly))))
    return jobs
