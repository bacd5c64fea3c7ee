"""The validation as one table: published facts, identities, criteria, independent cases."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.reference import criteria, identities, independent, paper_87

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import RenderableType

    from cyclosweep.reference.facts import Fact

__all__ = ["report_json", "report_tables", "validate"]

_SCHEMA = {
    "group": pl.String,
    "fact": pl.String,
    "published": pl.Float64,
    "computed": pl.Float64,
    "unit": pl.String,
    "mark": pl.String,
    "tolerance": pl.Float64,
    "ok": pl.Boolean,
    "note": pl.String,
}


def validate(drive: Drive | None = None) -> pl.DataFrame:
    """Compare the library with everything published that it can be compared with.

    Parameters
    ----------
    drive : Drive, optional
        The 87:1 drive; the built-in one by default.

    Returns
    -------
    polars.DataFrame
        ``group``, ``fact``, ``published``, ``computed``, ``unit``, ``mark``, ``tolerance``,
        ``ok``, ``note``. ``computed`` is null where the model cannot compute the fact, ``ok``
        where there is nothing to decide; ``note`` says why.

    Raises
    ------
    DesignError
        When the drive cannot be built.

    Examples
    --------
    >>> validate().filter(pl.col("fact") == "nominal input torque T_N")["ok"].item()
    True
    """
    table = pl.DataFrame([{**asdict(f), "ok": f.ok} for f in _facts(drive)], schema=_SCHEMA)
    return table.with_columns(pl.col("computed").fill_nan(None))  # not there at all: not ok


def _facts(drive: Drive | None) -> list[Fact]:
    drive = drive or Drive.reference_87()
    return [
        *paper_87.facts(drive),
        *identities.facts(drive),
        *criteria.facts(drive),
        *independent.facts(),
    ]


def report_json(drive: Drive | None = None) -> dict[str, Any]:
    """Return the validation as plain JSON values, sector lists and pulsation included."""
    table = validate(drive)
    mean, sectors = paper_87.ideal_sectors()
    drive = drive or Drive.reference_87()
    return {
        "schema": "cyclosweep.validation/1",
        "drive": drive.name,
        "ok": not table["ok"].eq(False).any(),
        "facts": table.to_dicts(),
        "sectors": {
            "published": list(paper_87.IDEAL_SECTORS),
            "reconstruction_ideal": sectors,
            "reconstruction_ideal_mean": mean,
            "this_drive": drive.active_pins("published-map").sectors.to_dicts(),
        },
        "pulsation": criteria.pulsation(drive).to_dicts(),
    }


def report_tables(drive: Drive | None = None) -> Iterable[RenderableType]:
    """Tables for a terminal."""
    from rich import box
    from rich.table import Table

    table = validate(drive)
    for (group,), rows in table.group_by("group", maintain_order=True):
        shown = Table(title=str(group), box=box.SIMPLE_HEAD, title_justify="left")
        shown.add_column("fact", ratio=3)
        shown.add_column("published", justify="right")
        shown.add_column("computed", justify="right")
        shown.add_column("unit")
        shown.add_column("mark")
        shown.add_column("ok")
        for row in rows.iter_rows(named=True):
            ok = {True: "yes", False: "[bold red]NO[/]", None: "-"}[row["ok"]]
            shown.add_row(
                row["fact"] + (f"\n[dim]{row['note']}[/]" if row["note"] else ""),
                _number(row["published"]),
                _number(row["computed"]),
                row["unit"],
                row["mark"],
                ok,
            )
        yield shown
    shown = Table(
        title="McIver's claim: (greatest - least) / mean over one turn",
        box=box.SIMPLE_HEAD,
        title_justify="left",
    )
    pulsation = criteria.pulsation(drive or Drive.reference_87())
    for name in pulsation.columns:
        shown.add_column(name.replace("_", " "), justify="right")
    for cells in pulsation.iter_rows():
        shown.add_row(*(f"{v:.3f}" if isinstance(v, float) else f"{v}" for v in cells))
    yield shown


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"
