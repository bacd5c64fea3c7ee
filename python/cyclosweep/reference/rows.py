"""Every row of the validation in one table, and which rows deliberate errors break."""

from __future__ import annotations

from dataclasses import asdict

import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.errors import instance_of
from cyclosweep.reference import (
    contacts,
    criteria,
    dynamics,
    equilibria,
    identities,
    independent,
    paper_87,
    solved_problems,
)
from cyclosweep.reference.broken_models import BROKEN_MODELS, broken_model
from cyclosweep.reference.facts import COUNTED, KINDS, Fact
from cyclosweep.reference.model import Model

__all__ = ["broken_rows", "broken_table", "tally", "validate"]

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
    "kind": pl.String,
    "counted": pl.Boolean,
    "explanation": pl.String,
    "source": pl.String,
}


def validate(drive: Drive | None = None, *, broken: str | None = None) -> pl.DataFrame:
    """Compare the library with what is published, solved elsewhere or must hold.

    Parameters
    ----------
    drive : Drive, optional
        The built-in 87:1 drive by default. What the paper says of its own drive is asked only of
        one of 87:1. Rows on formulas and on other people's drives do not depend on it.
    broken : str, optional
        Put a deliberate error into the model first, for example ``"E halved"``; see
        :data:`cyclosweep.reference.broken_models.BROKEN_MODELS`.

    Returns
    -------
    polars.DataFrame
        ``group``, ``fact``, ``published``, ``computed``, ``unit``, ``mark``, ``tolerance``,
        ``ok``, ``note``, ``kind``, ``counted``, ``explanation``, ``source``. ``published`` is the
        number that is compared with; ``source`` says where it comes from. ``computed`` is null
        where the model cannot compute the fact, ``ok`` where there is nothing to decide; ``note``
        says why. ``kind`` says what a row is worth: only ``evidence``, whose number a named
        publication prints, ``independent solution``, whose number none prints, and ``identity``
        count.
        ``explanation`` stands where the two numbers are known to disagree, and says why; it is
        empty where they disagree by more or less than it explains.

    Raises
    ------
    DesignError
        When the drive cannot be built.
    InputError
        When there is no such deliberate error.

    Examples
    --------
    >>> validate().filter(pl.col("fact") == "nominal input torque T_N")["ok"].item()
    True
    >>> wrong = validate(broken="speed in rad/s")
    >>> wrong.filter(pl.col("fact") == "nominal input torque T_N")["ok"].item()
    False
    """
    if drive is not None:
        instance_of("drive", drive, Drive)
    model = Model() if broken is None else broken_model(broken)
    rows = [
        {
            **asdict(fact),
            "ok": fact.ok,
            "counted": fact.counted,
            "explanation": fact.explanation if fact.is_explained else "",
        }
        for fact in _facts(model, drive or Drive.reference_87())
    ]
    table = pl.DataFrame(rows, schema=_SCHEMA)
    return table.with_columns(pl.col("computed").fill_nan(None))  # not there at all: not ok


def _facts(model: Model, drive: Drive) -> list[Fact]:
    return [
        *paper_87.facts(model, drive),
        *identities.facts(model),
        *solved_problems.facts(model),
        *independent.facts(model),
        *contacts.facts(model),
        *equilibria.facts(model),
        *dynamics.facts(model),
        *criteria.mciver(model),
        *criteria.facts(model, drive),
    ]


def tally(table: pl.DataFrame) -> dict[str, dict[str, int]]:
    """Rows of a validation by kind and outcome.

    Parameters
    ----------
    table : polars.DataFrame
        As :func:`validate` returns it.

    Returns
    -------
    dict
        For each kind ``agree``, ``explained`` (disagree, and the row says why), ``fail``
        (disagree, and nothing says why) and ``undecided``.
    """
    outcome = (
        pl.when(pl.col("ok").is_null())
        .then(pl.lit("undecided"))
        .when("ok")
        .then(pl.lit("agree"))
        .when(pl.col("explanation") != "")
        .then(pl.lit("explained"))
        .otherwise(pl.lit("fail"))
    )
    counts = {
        (kind, found): number
        for kind, found, number in table.group_by("kind", outcome.alias("found")).len().iter_rows()
    }
    outcomes = ("agree", "explained", "fail", "undecided")
    return {kind: {found: counts.get((kind, found), 0) for found in outcomes} for kind in KINDS}


def broken_rows() -> pl.DataFrame:
    """Which counted rows each deliberate error breaks.

    Returns
    -------
    polars.DataFrame
        One row for each row of the validation that counts and does not fail: ``kind``, ``group``,
        ``fact``, and one column for each deliberate error, true where the row then fails: it
        disagrees, and by other numbers than it explains.

    Examples
    --------
    >>> rows = broken_rows()
    >>> rows.filter(pl.col("fact").str.starts_with("Eq. (12)"))["i^2 forgotten"].item()
    True
    """
    intact = validate()
    met = intact["counted"] & ~_failed(intact)
    columns = {
        model.name: _failed(validate(broken=model.name)).filter(met) for model in BROKEN_MODELS
    }
    return intact.filter(met).select("kind", "group", "fact").with_columns(**columns)


def _failed(table: pl.DataFrame) -> pl.Series:
    """Rows whose numbers disagree without an explanation, or that have no number."""
    return ~table["ok"].fill_null(value=False) & (table["explanation"] == "")


def broken_table(rows: pl.DataFrame) -> pl.DataFrame:
    """How many counted rows each deliberate error breaks.

    Parameters
    ----------
    rows : polars.DataFrame
        As :func:`broken_rows` returns it.

    Returns
    -------
    polars.DataFrame
        ``model``, ``error``, rows broken of each kind that counts and ``first``, one of them.
    """
    table = []
    for model in BROKEN_MODELS:
        hit = rows.filter(pl.col(model.name))
        row: dict[str, str | int] = {"model": model.name, "error": model.meaning}
        row |= {kind: hit.filter(kind=kind).height for kind in COUNTED}
        table.append({**row, "first": hit["fact"].first() or ""})
    return pl.DataFrame(table)
