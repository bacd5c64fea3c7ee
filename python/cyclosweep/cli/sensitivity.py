"""`cyclosweep sensitivity`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cyclosweep.cli.exploring import (
    Limits,
    OutTable,
    check_out,
    plain_rows,
    say_if_unfinished,
    write_out,
)
from cyclosweep.cli.frames import FrameTable
from cyclosweep.cli.output import AsJson, interruptible, print_json, print_tables
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    import polars as pl

LEAST_SHOWN = 0.01
"""Index [1] from which an input is named in the terminal's table."""
FEW_USED = 0.95
"""Share of draws that can be built below which the indices are marked."""


def sensitivity(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="Study file, or folder of a sweep.")
    ],
    results: Annotated[
        str | None, typer.Option("--results", metavar="A,B", help="Results; all by default.")
    ] = None,
    half_width: Annotated[
        float, typer.Option("--half-width", help="Of the 95 % confidence interval to reach.")
    ] = 0.05,
    most_draws: Annotated[
        int, typer.Option("--most-draws", min=32, help="Sample size not to go beyond.")
    ] = 2**15,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the sample.")] = 0,
    limit: Limits = None,
    out: OutTable = None,
    as_json: AsJson = False,
) -> None:
    """Say which input drives which result.

    For a study file: first-order and total Sobol indices, from a sample that is doubled until the
    confidence interval is as narrow as asked for; limits do not count. For the folder of a sweep:
    the share of each result's variance that goes with each input by itself, from the feasible
    rows that are there.
    """
    from cyclosweep.explore import input_influence, sobol_indices
    from cyclosweep.sweep.study import Study

    check_out(out)
    wanted = [name.strip() for name in results.split(",") if name.strip()] if results else None
    if study.is_dir():
        say_if_unfinished(study)
    with interruptible("nothing was written"):
        if study.is_dir():
            table = input_influence(study, wanted, limit)
            kind, shown = "influence", _shares(table)
        else:
            if limit:
                raise InputError("--limit: for the folder of a sweep alone, Sobol indices need all")
            table = sobol_indices(
                Study.from_toml(study),
                wanted,
                half_width=half_width,
                most_draws=most_draws,
                seed=seed,
            )
            kind, shown = "sobol", _totals(table)
    write_out(table, out)
    if as_json:
        print_json(
            {"schema": "cyclosweep.sensitivity/1", "kind": kind, "indices": plain_rows(table)}
        )
        return
    title = "Share of variance by itself" if kind == "influence" else "Total Sobol index"
    print_tables([FrameTable(title, shown)])
    if kind == "sobol":
        _say_what_is_open(table, half_width)
    if out is not None:
        print(f"written: {out}")


def _totals(table: pl.DataFrame) -> pl.DataFrame:
    """Each result with the inputs that matter, the greatest total index first."""
    import polars as pl

    named = pl.format("{} {}", "input", pl.col("total").round(2))
    matters = pl.col("total") >= LEAST_SHOWN
    driven_by = (
        pl.when(pl.col("named") != "")
        .then("named")
        .when(pl.col("share_used") == 0.0)
        .then(pl.lit("no variant has it"))
        .otherwise(pl.lit("does not vary"))
    )
    return (
        table.sort("total", descending=True, maintain_order=True)
        .group_by("result", maintain_order=True)
        .agg(
            named.filter(matters).str.join(", ").alias("named"),
            pl.col("draws", "share_used").first(),
        )
        .join(table.select("result").unique(maintain_order=True).with_row_index(), on="result")
        .sort("index")
        .select("result", driven_by.alias("driven by"), "draws")
    )


def _shares(table: pl.DataFrame) -> pl.DataFrame:
    """Each result with the inputs that matter, the greatest share first."""
    import polars as pl

    rows = []
    for row in table.drop("driven_by").rows(named=True):
        shares = {k: v for k, v in row.items() if k != "result" and v is not None}
        best = sorted(shares.items(), key=lambda item: -item[1])
        text = ", ".join(f"{k} {v:.2f}" for k, v in best if v >= LEAST_SHOWN)
        rows.append((row["result"], text or "does not vary"))
    return pl.DataFrame(rows, schema=["result", "goes with"], orient="row")


def _say_what_is_open(table: pl.DataFrame, half_width: float) -> None:
    """Say which indices are less accurate than asked for, and what was left out."""
    import polars as pl

    worst = pl.max_horizontal("first_order_half_width", "total_half_width")
    wide = table.filter(worst > half_width)["result"].unique(maintain_order=True)
    if len(wide):
        print(
            f"half-width above {half_width:g} after the most draws: {', '.join(wide)}; "
            "--most-draws allows more"
        )
    # A result that no variant has is said to be absent in the table.
    there = table.filter(pl.col("share_used") > 0.0).sort("share_used", maintain_order=True)
    for name, used in there.select("result", "share_used").head(1).iter_rows():
        if used < FEW_USED:
            print(
                f"in {1 - used:.0%} of the draws a variant cannot be built or has no {name}; these "
                "are left out, and the indices are those of what is left, where the inputs are "
                "not independent: narrower ranges say more"
            )
