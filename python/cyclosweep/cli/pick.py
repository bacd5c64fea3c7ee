"""`cyclosweep pick`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from cyclosweep.cli.output import refuse_drive_name, refuse_output, refuse_overwriting


def pick(
    study: Annotated[Path, typer.Argument(metavar="STUDY_DIR", help="Folder of a sweep.")],
    variant: Annotated[int, typer.Argument(metavar="N", help="Number of the variant.")],
    out: Annotated[Path, typer.Option("--out", metavar="DRIVE.toml", help="File to write.")],
    name: Annotated[str | None, typer.Option("--name", help="What the drive is called.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace DRIVE.toml.")] = False,
) -> None:
    """Write one variant of a study as a drive file.

    The file gives the same results as the variant's row. What the study varied is marked as
    derived from it; every other mark is that of the study's drive. A file that exists is not
    overwritten: it may have been edited by hand.
    """
    from cyclosweep.sweep.stored import open_study

    refuse_output(out)
    refuse_drive_name(out)
    refuse_overwriting(out, force=force)
    stored = open_study(study)
    drive = stored.drive_of(variant, name=name)
    status = stored.row(variant)["status"]
    drive.to_toml(out)
    if status != "ok":
        print(f"cyclosweep: variant {variant} has the status {status}", file=sys.stderr)
    values = ", ".join(f"{axis} {getattr(drive, axis, None):g}" for axis in stored.axes
                       if isinstance(getattr(drive, axis, None), (int, float)))  # fmt: skip
    print(f"Written: {out} ({values})" if values else f"Written: {out}")
