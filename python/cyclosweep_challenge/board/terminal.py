"""The score in a terminal."""

from __future__ import annotations

import math

from rich.console import Console
from rich.table import Table

from cyclosweep_challenge.scoring.criterion import Criterion
from cyclosweep_challenge.scoring.intervals import Estimate
from cyclosweep_challenge.scoring.score import Score


def as_text(estimate: Estimate) -> str:
    """Estimate with its interval, or a dash."""
    if estimate.count == 0 or math.isnan(estimate.value):
        return "-"
    return f"{estimate.value:.3g} [{estimate.low:.3g}, {estimate.high:.3g}]"


def within_reach(needed: Estimate) -> str:
    """Visibility needed, or that it lies beyond what was tried."""
    if needed.count == 0 or (needed.value <= 20.0 and math.isfinite(needed.high)):
        return as_text(needed)
    value = "> 20" if needed.value > 20.0 else f"{needed.value:.3g}"
    return f"{value} [{min(needed.low, 20.0):.3g}, > 20]"


def _mark(criterion: Criterion) -> str:
    """Words for whether a criterion is met."""
    if criterion.met is None:
        return "" if criterion.target == "none" else "too few cases"
    if criterion.met:
        return "[green]reached[/green]"
    if criterion.met_required:
        return "[yellow]required only[/yellow]"
    return "[red]missed[/red]"


def print_board(score: Score, console: Console) -> None:
    """Print the table of figures and the opponents' power."""
    about = score.about
    table = Table(title=f"Challenge: {about['cases']} cases, seed {about['seed']}")
    for heading in ("figure", "reached [95 %]", "cases", "target", "required", ""):
        table.add_column(heading, justify="right" if heading == "cases" else "left")
    for criterion in score.criteria:
        table.add_row(
            criterion.name,
            as_text(criterion.estimate),
            str(criterion.estimate.count),
            "" if criterion.target == "none" else criterion.target,
            criterion.required,
            _mark(criterion),
        )
    console.print(table)
    if score.opponents:
        console.print(_opponents(score))


def _opponents(score: Score) -> Table:
    """Opponents' false alarms at defaults, and power at one false alarm in a hundred."""
    levels = sorted({d for o in score.opponents for d, _ in o.own.power})
    table = Table(title="Opponents on the same recordings: power at 1 % false alarms, by d")
    table.add_column("who")
    table.add_column("programme")
    table.add_column("noise")
    table.add_column("false alarms at defaults")
    table.add_column("d for 90 %")
    for d in levels:
        table.add_column(f"{d:g}")
    for curve in score.curves:
        shares = dict(curve.points)
        cells = [f"{shares[d].value:.2f}" if d in shares else "" for d in levels]
        table.add_row(
            curve.who, curve.programme, curve.noise, "", within_reach(curve.needed), *cells
        )
    for opponent in score.opponents:
        shares = dict(opponent.own.power)
        cells = [f"{shares[d].value:.2f}" if d in shares else "" for d in levels]
        table.add_row(
            opponent.who,
            opponent.programme,
            opponent.noise,
            as_text(opponent.default_alarms),
            within_reach(opponent.own.needed),
            *cells,
        )
    return table
