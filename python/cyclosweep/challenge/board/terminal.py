"""The score in a terminal."""

from __future__ import annotations

import math

from rich.console import Console
from rich.table import Table

from cyclosweep.challenge.scoring.figures import Figure
from cyclosweep.challenge.scoring.intervals import Estimate
from cyclosweep.challenge.scoring.score import Curve, Score


def as_text(estimate: Estimate) -> str:
    """Estimate with its interval, or a dash."""
    if estimate.count == 0 or math.isnan(estimate.value):
        return "-"
    return f"{estimate.value:.3g} [{estimate.low:.3g}, {estimate.high:.3g}]"


def within_reach(needed: Estimate) -> str:
    """Visibility needed, or that it lies beyond what was tried."""
    return "> 20" if needed.value > 20.0 else as_text(needed)


def needed_by(score: Score, curve: Curve) -> str:
    """Visibility that the diagnosis, or the test that knows the effect, needs."""
    names = {
        "detected": f"d for 90 % power, {curve.programme}",
        "test that knows the effect": (
            f"the same of the test that knows the effect, {curve.programme}"
        ),
    }
    found = [f.estimate for f in score.figures if f.name == names.get(curve.who)]
    return as_text(found[0]) if found else ""


def _mark(figure: Figure) -> str:
    """Words for whether a figure is reached."""
    if figure.met is None:
        return "" if figure.target == "none" else "too few cases"
    if figure.met:
        return "[green]reached[/green]"
    if figure.met_required:
        return "[yellow]required only[/yellow]"
    return "[red]missed[/red]"


def print_board(score: Score, console: Console) -> None:
    """Print the table of figures and the opponents' power."""
    about = score.about
    table = Table(title=f"Challenge: {about['cases']} cases, seed {about['seed']}")
    for heading in ("figure", "reached [95 %]", "cases", "target", "required", ""):
        table.add_column(heading, justify="right" if heading == "cases" else "left")
    for figure in score.figures:
        table.add_row(
            figure.name,
            as_text(figure.estimate),
            str(figure.estimate.count),
            "" if figure.target == "none" else figure.target,
            figure.required,
            _mark(figure),
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
    table.add_column("false alarms at defaults")
    table.add_column("d for 90 %")
    for d in levels:
        table.add_column(f"{d:g}")
    for curve in score.curves:
        shares = dict(curve.points)
        cells = [f"{shares[d].value:.2f}" if d in shares else "" for d in levels]
        table.add_row(curve.who, curve.programme, "", needed_by(score, curve), *cells)
    for opponent in score.opponents:
        shares = dict(opponent.own.power)
        cells = [f"{shares[d].value:.2f}" if d in shares else "" for d in levels]
        table.add_row(
            opponent.who,
            opponent.programme,
            as_text(opponent.default_alarms),
            within_reach(opponent.own.needed),
            *cells,
        )
    return table
