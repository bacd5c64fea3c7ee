"""Run the opponents on the recordings and store their replies."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from cyclosweep_challenge.opponents.ladder import error_ladder
from cyclosweep_challenge.opponents.runs_test import runs_test
from cyclosweep_challenge.opponents.subset import aic_subset, bic_subset
from cyclosweep_challenge.opponents.view import RecordingView
from cyclosweep_challenge.trial.plan import Entry

CHEAP = ("runs_test", "ljung_box", "aic_subset", "bic_subset", "stlsq", "error_ladder")
CHEAPEST = ("runs_test", "ljung_box", "aic_subset", "bic_subset", "error_ladder")
"""These see recordings with nothing missing under every family of noise, not white alone."""
COSTLY = ("lasso_cv", "bagged_stlsq", "gaussian_process")
OTHER_LIBRARY = tuple(
    f"{name}_{kind}"
    for name in ("bic_subset", "lasso_cv", "stlsq")
    for kind in ("project", "whitened")
)
"""The same regressions with the project's library, and with its whitening as well."""
LIBRARIES_APART = ("bic_subset", "lasso_cv", "stlsq", *OTHER_LIBRARY, "kennedy_ohagan")
"""Opponents of a campaign, which tell what the library adds and what the search adds."""
NEEDS = {
    "ljung_box": "statsmodels",
    "lasso_cv": "sklearn",
    "gaussian_process": "sklearn",
    "kennedy_ohagan": "sklearn",
    "lasso_cv_project": "sklearn",
    "lasso_cv_whitened": "sklearn",
    "stlsq_project": "pysindy",
    "stlsq_whitened": "pysindy",
    "stlsq": "pysindy",
    "bagged_stlsq": "pysindy",
}
"""Libraries of the extra ``challenge`` that an opponent needs."""


def absent() -> list[str]:
    """Return the opponents whose library is not installed."""
    return [name for name, library in NEEDS.items() if find_spec(library) is None]


def libraries_apart(who: str) -> tuple[str, ...]:
    """Opponents of a campaign whose libraries are installed; none where ``who`` is ``none``."""
    left_out = absent()
    return tuple(n for n in LIBRARIES_APART if n not in left_out) if who != "none" else ()


def _entrants(names: Sequence[str]) -> dict[str, Callable[..., Any]]:
    """Return the opponents asked for, each imported only now: their libraries are an extra."""
    every: dict[str, Callable[..., Any]] = {
        "runs_test": runs_test,
        "aic_subset": aic_subset,
        "bic_subset": bic_subset,
        "error_ladder": error_ladder,
    }
    if "ljung_box" in names:
        from cyclosweep_challenge.opponents.ljung_box import ljung_box

        every["ljung_box"] = ljung_box
    if "lasso_cv" in names:
        from cyclosweep_challenge.opponents.lasso import lasso_cv

        every["lasso_cv"] = lasso_cv
    if "gaussian_process" in names:
        from cyclosweep_challenge.opponents.gaussian_process import gaussian_process

        every["gaussian_process"] = gaussian_process
    if "kennedy_ohagan" in names:
        from cyclosweep_challenge.opponents.kennedy_ohagan import kennedy_ohagan

        every["kennedy_ohagan"] = kennedy_ohagan
    if "stlsq" in names or "bagged_stlsq" in names:
        from cyclosweep_challenge.opponents.stlsq import bagged_stlsq, stlsq

        every |= {"stlsq": stlsq, "bagged_stlsq": bagged_stlsq}
    return {name: every[name] for name in names}


def meet(recording: Path, results: Path, key: str, names: tuple[str, ...]) -> None:
    """Run opponents on one recording, except those whose reply is stored already."""
    file = results / f"{key}.json"
    replies: dict[str, Any] = json.loads(file.read_text()) if file.exists() else {}
    missing = [name for name in names if name not in replies]
    if not missing:
        return
    view = RecordingView.read(recording)
    others = [name for name in missing if name in OTHER_LIBRARY]
    for name, opponent in _entrants([n for n in missing if n not in OTHER_LIBRARY]).items():
        replies[name] = asdict(opponent(view))
    if others:
        from cyclosweep_challenge.opponents.project_library import replies as with_project_library

        for name, reply in with_project_library(recording, tuple(others)).items():
            replies[name] = asdict(reply)
    partial = file.with_suffix(".tmp")
    partial.write_text(json.dumps(replies))
    partial.replace(file)


def meet_opponents(
    plan: Sequence[Entry],
    recordings: Path,
    results: Path,
    who: str,
    costly_limit: int,
    first: int = 0,
    home: str = "white",
) -> list[tuple[Callable[..., None], tuple[Any, ...]]]:
    """List the jobs of a challenge: recordings with one effect in the open, or with none.

    Parameters
    ----------
    plan : sequence of Entry
        The challenge's cases.
    recordings, results : pathlib.Path
        Folder of the recordings, and where the opponents' replies go.
    who : {"all", "cheap", "none"}
        Which opponents; those whose library is absent stay away.
    costly_limit : int
        Recordings of each stratum that the costly ones see, and of each stratum under another
        noise that the cheapest do.
    first : int
        Place in the plan from which recordings are shown; those before are only counted.
    home : str
        Family of noise under which all opponents meet; under the others only the cheapest do.

    Raises
    ------
    ValueError
        If ``who`` is none of these.
    """
    if who not in {"all", "cheap", "none"}:
        raise ValueError(f"opponents: found {who!r}, expected all, cheap or none")
    if who == "none":
        return []
    left_out = absent()
    count: Counter[str] = Counter()
    jobs: list[tuple[Callable[..., None], tuple[Any, ...]]] = []
    for entry in plan:
        stratum = entry.stratum
        if stratum.tier not in {"C0", "C6"} or stratum.programme not in {"rich", "poor"}:
            continue
        count[stratum.name] += 1
        early = count[stratum.name] <= costly_limit
        names: tuple[str, ...] = CHEAPEST if early else ()
        if stratum.noise == home:
            names = (*CHEAP, *(COSTLY if who == "all" and early else ()))
        there = tuple(name for name in names if name not in left_out)
        if entry.number < first or not there:
            continue
        jobs.append((meet, (recordings / entry.key, results, entry.key, there)))
    return jobs
