"""The report's sentences: what there is, what is best, what drives it, what stays good."""

from __future__ import annotations

import math

from cyclosweep.design.units import quantity
from cyclosweep.study_report.gather import StudyFacts
from cyclosweep.sweep.objective import Objective

__all__ = [
    "label",
    "limit_words",
    "method_words",
    "number",
    "summary",
    "why_not_robust",
    "wish",
]

NOTHING = "–"


def number(value: object, digits: int = 4) -> str:
    """Write a number with so many digits; a dash for none."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return NOTHING
    if isinstance(value, float):
        return f"{value:.{digits}g}".replace("-", "−")
    return f"{value:,}" if isinstance(value, int) and abs(value) > 9999 else str(value)


def label(name: str) -> str:
    """Name of a column with its unit, for an axis."""
    unit = _unit(name)
    return f"{name} [{unit}]" if unit else name


def _unit(name: str) -> str:
    try:
        unit = quantity(name).unit
    except KeyError:  # an expression, or a column of the user's own
        return ""
    return "" if unit == "1" else unit


def with_unit(name: str, value: object) -> str:
    """A column's value with its unit."""
    unit = _unit(name)
    return f"{number(value)} {unit}" if unit else number(value)


def wish(objective: Objective) -> str:
    """What is wanted of a column, as ``greatest hole_web_mm``."""
    return f"{'greatest' if objective.maximise else 'least'} {objective.column}"


def limit_words(name: str, low: str, high: str) -> str:
    """A limit of a study, whose ends are infinite where it has none.

    Parameters
    ----------
    name : str
        Column or expression.
    low, high : str
        Least and greatest value, as a study's definition writes them.

    Examples
    --------
    >>> limit_words("hole_web_mm", "2.0", "inf"), limit_words("mass_kg", "1.0", "3.0")
    ('hole_web_mm at least 2.0', 'mass_kg 1.0 to 3.0')
    """
    if math.isinf(float(high)):
        return name if math.isinf(float(low)) else f"{name} at least {low}"
    return f"{name} at most {high}" if math.isinf(float(low)) else f"{name} {low} to {high}"


def method_words(facts: StudyFacts) -> str:
    """How the variants were drawn."""
    words = {
        "grid": "every combination of the inputs' values",
        "sobol": "Sobol points",
        "latin-hypercube": "a Latin hypercube",
        "random": "independent random points",
        "table": "the rows of a table",
    }
    method = str(facts.study.definition["method"])
    return words.get(method, method)


def summary(facts: StudyFacts) -> list[str]:
    """Sentences of the summary.

    Parameters
    ----------
    facts : StudyFacts
        What the report is made of.

    Returns
    -------
    list of str
    """
    return [_size(facts), *_best(facts), *_drivers(facts), *_robust(facts)]


def _size(facts: StudyFacts) -> str:
    study, found = facts.study, facts.aggregate
    share = found.feasible / max(found.rows, 1)
    text = (
        f"{found.rows:,} variants of {study.drive.name} were computed, {method_words(facts)} over "
        f"{len(study.axes)} inputs; {found.feasible:,} ({share:.1%}) can be built and keep the "
        "limits."
    )
    if not study.complete:
        text = text.replace("were computed", f"of {study.variants:,} are computed so far")
    refused = {name: count for name, count in facts.statuses.items() if name != "ok"}
    if refused:
        name = max(refused, key=lambda each: refused[each])
        text += f" Most of the others: {name} ({refused[name]:,})."
    return text


def _best(facts: StudyFacts) -> list[str]:
    if facts.front.is_empty():
        return ["No feasible variant lies within the limits."]
    found = []
    if len(facts.objectives) > 1:
        found.append(
            f"{facts.front_size:,} variants are on the Pareto front of "
            f"{' and '.join(map(wish, facts.objectives))}: no other variant is better in one and "
            "as good in the others."
        )
    for variant, why in facts.chosen.items():
        row = facts.study.row(variant)
        shown = [o.column for o in facts.objectives if o.column in row]
        values = ", ".join(f"{name} {with_unit(name, row[name])}" for name in shown)
        found.append(f"Variant {variant}, {why}: {values}.")
    return found


def _drivers(facts: StudyFacts) -> list[str]:
    found = []
    for objective in facts.objectives:
        shares = {axis.name: axis.shares[objective.column] for axis in facts.aggregate.axes}
        if objective.column in shares or not shares or max(shares.values()) < 0.01:
            continue
        name = max(shares, key=lambda each: shares[each])
        found.append(f"Of the variance of {objective.column}, {shares[name]:.0%} goes with {name}.")
    return found


def _robust(facts: StudyFacts) -> list[str]:
    if not facts.robust:
        return []
    first = facts.objectives[0]
    best = facts.robust[0]
    low, _, high = best.percentiles[first.column]
    bad = low if first.maximise else high
    return [
        f"Made within {'assumed ' if facts.are_assumed else ''}tolerances, variant {best.variant} "
        f"stays the best of {len(facts.robust)} candidates: 95 of 100 pieces keep {first.column} "
        f"{'above' if first.maximise else 'below'} {with_unit(first.column, bad)}, and "
        f"{best.usable:.1%} are usable"
        + (f" (most of the others: {best.refused})." if best.refused else ".")
    ]


def why_not_robust(facts: StudyFacts) -> str:
    """Why no candidates were made within tolerances."""
    if facts.tolerances is None:
        return "None: no dimension varies that could deviate; --tolerances FILE.toml gives some."
    if not facts.aggregate.feasible:
        return "None: no variant can be built and keeps the limits."
    return (
        "None: an objective or limit reads a column of your own, which a stored study does not "
        "tell how to compute; --pareto and --limit take the expression itself."
    )
