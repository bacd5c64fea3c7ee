"""`cyclosweep evaluate`: a table of designs, or one drive, with its results as a table."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Annotated, Literal

import typer

from cyclosweep.cli.exploring import check_out
from cyclosweep.cli.output import AsJson, print_json
from cyclosweep.errors import InputError


def evaluate(
    designs: Annotated[
        str,
        typer.Argument(
            metavar="DESIGNS",
            help="Table of designs (.csv, .xlsx, .parquet), or one drive: a name or .toml file.",
        ),
    ],
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="Results: .csv, .xlsx or .parquet.")
    ],
    drive: Annotated[
        str, typer.Option(metavar="NAME|FILE", help="Drive that gives what the table leaves out.")
    ] = "reference-87",
    model: Annotated[
        Literal["published", "components"], typer.Option(help="Whose results are computed.")
    ] = "published",
    loads: Annotated[
        str | None, typer.Option(metavar="A,B,...", help="Loads of the twists [T_N].")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Evaluate a table of designs, labels passed through; a bad design keeps its row and reason."""
    import polars as pl

    from cyclosweep.design.drive import Drive
    from cyclosweep.sweep.design_table import evaluate_table
    from cyclosweep.sweep.table_files import read_filled_rows, write_table

    check_out(out, designs)
    loads_tn = None if loads is None else _loads(loads)
    logging.getLogger("cyclosweep").addHandler(handler := _Notes())
    try:
        if designs.endswith(".toml") or not Path(designs).suffix:
            one = Drive.load(designs)
            names = [name for name, value in one.values().items() if value == value]
            row = {name: [getattr(one, name)] for name in names if not name.startswith("shaft_")}
            base, table = one, pl.DataFrame({"name": [one.name], **row})
            rows = [2]
        else:
            base = Drive.load(drive)
            table, rows = read_filled_rows(designs)
        found = evaluate_table(
            base,
            table,
            model=model,
            loads_tn=loads_tn,
            row_name=lambda index: f"row {rows[index]}",
        )
    except InputError as error:
        text = str(error)
        raise InputError(text if text.startswith(designs) else f"{designs}, {text}") from None
    finally:
        logging.getLogger("cyclosweep").removeHandler(handler)
    for note in handler.notes:
        typer.echo(f"cyclosweep: {designs}, {note}", err=True)
    write_table(found, out)
    counts = found["status"].value_counts(sort=True)
    status = dict(zip(counts["status"].to_list(), counts["count"].to_list(), strict=True))
    if as_json:
        print_json(
            {
                "schema": "cyclosweep.evaluation/1",
                "file": str(out),
                "rows": found.height,
                "status": status,
                "notes": handler.notes,
            }
        )
    else:
        said = ", ".join(f"{count:,} {name}" for name, count in status.items())
        print(f"{found.height:,} designs in {out}: {said}")


class _Notes(logging.Handler):
    """Keeps what is said of columns that are passed through."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.notes: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep one message."""
        self.notes.append(record.getMessage())


def _loads(text: str) -> list[float]:
    try:
        return [float(each) for each in text.split(",")]
    except ValueError:
        raise InputError(f"--loads: found {text!r}, expected numbers such as 1,2,4.5") from None
