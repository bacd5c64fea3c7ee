"""`cyclosweep challenge`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from cyclosweep.cli.output import (
    AsJson,
    folder_named,
    interruptible,
    print_json,
    refuse_folder,
)
from cyclosweep.errors import InputError


def challenge(
    cases: Annotated[
        int, typer.Option("--cases", metavar="N", min=1, help="Number of concealed recordings.")
    ],
    seed: Annotated[
        int, typer.Option("--seed", metavar="S", min=0, help="Seed; records use 100000 and above.")
    ],
    out: Annotated[
        Path, typer.Option("--out", parser=folder_named, metavar="DIR", help="Folder of the run.")
    ],
    workers: Annotated[int, typer.Option(min=1, help="Processes at a time.")] = 1,
    mix: Annotated[
        Literal["all", "null", "open", "concealed", "contest"],
        typer.Option(help="Which kinds of case take part."),
    ] = "all",
    noise: Annotated[
        str, typer.Option(metavar="FAMILY", help="Noise in place of white noise, as ar0.6.")
    ] = "white",
    opponents: Annotated[
        Literal["all", "cheap", "none"], typer.Option(help="Who else sees the recordings.")
    ] = "all",
    as_json: AsJson = False,
) -> None:
    """Conceal effects, diagnose the recordings blind, and score the diagnoses by sealed answers.

    The same command on the same DIR goes on where it stopped; a larger N adds cases.
    """
    try:
        from cyclosweep_challenge.runner.run import run_challenge
        from cyclosweep_challenge.runner.work import Options
        from cyclosweep_challenge.trial.seal import SealError
    except ModuleNotFoundError as error:
        raise InputError(
            f"challenge: {error.name} is not installed, expected: pip install "
            "'cyclosweep[challenge]'"
        ) from None

    refuse_folder(out)
    options = Options(opponents=opponents)
    try:
        with interruptible(f"the same command goes on from {out}"):
            score = run_challenge(cases, seed, out, workers, mix=mix, noise=noise, options=options)
    except SealError as error:
        raise InputError(f"{out}: {error}") from error
    except ValueError as error:
        raise InputError(str(error)) from error
    if as_json:
        print_json(score.as_dict())
