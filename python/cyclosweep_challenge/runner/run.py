"""Run a challenge, or go on with one that was interrupted."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from rich.console import Console

from cyclosweep_challenge.board.page import write_page
from cyclosweep_challenge.board.terminal import print_board
from cyclosweep_challenge.opponents.contest import absent, meet_opponents
from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.runner.folders import Folders, alone
from cyclosweep_challenge.runner.stages import (
    diagnose,
    gallery,
    opponent_replies,
    predict_all,
    prepare,
    reveal_answers,
)
from cyclosweep_challenge.runner.work import Options, work
from cyclosweep_challenge.scoring.score import Score, make_score
from cyclosweep_challenge.trial.plan import Entry, make_plan
from cyclosweep_challenge.trial.tiers import Stratum

RECORD_SEED = 100_000
"""Records use seeds from here on; development uses seeds below ten thousand."""


def plan_of(about: Mapping[str, Any], cases: int) -> list[Entry]:
    """Lay out the first cases of a challenge as its folder describes it.

    Parameters
    ----------
    about : mapping
        Seed, mix and samples, as ``plan.make_plan`` takes them; with ``noise``, a family of
        noise that takes the place of white noise; with ``programme``, one that takes the place
        of every other.
    cases : int
        Number of cases.
    """
    plan = make_plan(cases, about["seed"], about["mix"], about["samples"])
    noise, programme = about.get("noise", "white"), about.get("programme")

    def described(stratum: Stratum) -> Stratum:
        return replace(
            stratum,
            noise=noise if stratum.noise == "white" else stratum.noise,
            programme=programme or stratum.programme,
        )

    return [replace(entry, stratum=described(entry.stratum)) for entry in plan]


def run_challenge(
    cases: int,
    seed: int,
    out: str | Path,
    workers: int = 1,
    *,
    mix: str = "all",
    noise: str = "white",
    samples: int = 3000,
    options: Options | None = None,
    console: Console | None = None,
) -> Score:
    """Run a challenge, or go on with one that was interrupted.

    Parameters
    ----------
    cases : int
        Number of cases; a larger number on the same folder adds to it.
    seed : int
        Seed of the challenge.
    out : str or pathlib.Path
        Folder of the run.
    workers : int
        Processes at a time.
    mix : {"all", "null", "open", "concealed", "contest", "tuning"}
        Which strata take part.
    noise : str
        Family of noise that takes the place of white noise, of ``noise.NOISES``.
    samples : int
        Readings of each recording.
    options : Options, optional
        Everything else; ``workers`` above wins.
    console : rich.console.Console, optional
        Where progress, root hash and table go; standard error if absent.

    Returns
    -------
    Score
        Figures, curves and tables; also in ``score.json`` and ``score.html`` of the folder.

    Raises
    ------
    SealError
        If an answer was changed after its hash was published.
    OutOfTimeError
        If ``options.until`` is over before the last case; what is done is kept.
    ValueError
        If the folder holds a challenge of another seed, mix, noise or size, or another process
        is at work there.
    """
    if noise not in NOISES:
        raise ValueError(f"noise: found {noise!r}, expected one of {', '.join(NOISES)}")
    chosen = Options(**(vars(options or Options()) | {"workers": max(1, workers)}))
    about = {"seed": seed, "mix": mix, "samples": samples}
    if noise != "white":
        about["noise"] = noise
    plan = plan_of(about, cases)
    with alone(Path(out)):
        return _run(plan, about, Folders(Path(out)), chosen, console or Console(stderr=True))


def _run(
    plan: Sequence[Entry],
    about: dict[str, Any],
    folders: Folders,
    options: Options,
    screen: Console,
) -> Score:
    """Run a challenge whose folder nobody else uses."""
    _claim(folders.out, about)
    root = prepare(plan, folders, options, screen)
    screen.print(f"answers committed: SHA-256 {root} over {len(folders.hashes())} answers")
    diagnose(plan, folders, options, screen)
    predict_all(plan, folders, options, screen)
    if options.opponents != "none" and absent():
        screen.print(f"without their libraries (extra: challenge): {', '.join(absent())}")
    meetings = meet_opponents(
        plan,
        folders.recordings,
        folders.opponents,
        options.opponents,
        options.costly_limit,
        home=about.get("noise", "white"),
    )
    work("opponents", options.workers, meetings, screen, until=options.until)
    outcomes = reveal_answers(plan, folders)
    score = make_score(outcomes, opponent_replies(folders), about | {"root": root})
    (folders.out / "outcomes.json").write_text(json.dumps([asdict(o) for o in outcomes]))
    (folders.out / "score.json").write_text(json.dumps(score.as_dict(), indent=1))
    exhibits = gallery(outcomes, folders, options)
    write_page(score, exhibits, folders.out / "score.html")
    print_board(score, screen)
    return score


def _claim(out: Path, own: dict[str, Any]) -> None:
    """Make sure that a folder holds one challenge only."""
    file = out / "challenge.json"
    if file.exists():
        found = json.loads(file.read_text())
        if found != own:
            raise ValueError(f"{file}: found {found}, expected {own}; use another folder")
    else:
        file.write_text(json.dumps(own))
