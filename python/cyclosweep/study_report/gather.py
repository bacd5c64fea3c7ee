"""Everything that the report of a study says, gathered in a few readings of its rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from cyclosweep.choose.best import best_variants
from cyclosweep.choose.comparison import Comparison, compare
from cyclosweep.errors import InputError
from cyclosweep.explore.pareto import objectives_of, pareto_front
from cyclosweep.explore.tables import Conditions, Rows, open_table
from cyclosweep.study_report.aggregate import Aggregate, aggregate
from cyclosweep.study_report.candidates import (
    Robust,
    assumed_tolerances,
    choose_variants,
    robust_variants,
    spread,
)
from cyclosweep.sweep.expressions import names_in, number
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.stored import StoredStudy, open_study
from cyclosweep.sweep.tolerances import Tolerances

__all__ = ["StudyFacts", "gather"]

FRONT_ROWS = 200
"""Rows of the front in the page: what a reader scrolls through, and some 100 kB."""
CANDIDATES = 12
"""Variants of the front that are made within tolerances."""
OTHER_OUTCOMES = (
    "output_stiffness_nm_per_arcmin",
    "pin_bending_stress_mpa",
    "hole_web_mm",
    "torque_transfer_efficiency",
    "loaded_twist_arcmin",
    "ring_contact_pressure_max_mpa",
    "efficiency",
)
"""Results whose drivers are shown besides the objectives, where the study has them."""
MOST_OUTCOMES = 6
OPPOSED = -0.1
"""Correlation below which a result stands against the objective; else an input is taken."""
OPPONENTS = (
    Objective("hole_web_mm", maximise=True),
    Objective("pin_bending_stress_mpa"),
    Objective("drive_volume_mm3"),
    Objective("ring_contact_pressure_max_mpa"),
    Objective("output_pin_diameter_mm"),
    Objective("output_stiffness_nm_per_arcmin", maximise=True),
)
"""What may stand against a study's objective: the one most opposed to it is taken, so that the
front shows what a better value costs."""


@dataclass(frozen=True)
class StudyFacts:
    """What the report of a study is made of.

    Attributes
    ----------
    study : StoredStudy
        The study.
    objectives : list of Objective
        What matters.
    limits : list of str
        Conditions besides the study's own limits.
    outcomes : list of str
        The objectives, then other results whose drivers are shown.
    aggregate : Aggregate
        Counts, means and spreads by input.
    front : polars.DataFrame
        At most :data:`FRONT_ROWS` rows of the front, evenly spread.
    front_size : int
        How many variants are on it.
    chosen : dict of int to str
        Variants and why they were chosen.
    comparison : Comparison or None
        The chosen ones as drives.
    robust : list of Robust
        Candidates made within tolerances, the best first.
    tolerances : Tolerances or None
        Those tolerances.
    are_assumed : bool
        Whether they are ours.
    """

    study: StoredStudy
    objectives: list[Objective]
    limits: list[str]
    outcomes: list[str]
    aggregate: Aggregate
    front: pl.DataFrame
    front_size: int
    chosen: dict[int, str]
    comparison: Comparison | None
    robust: list[Robust]
    tolerances: Tolerances | None
    are_assumed: bool

    @property
    def statuses(self) -> dict[str, int]:
        """How many variants have each status; of those that are ok, the limits may refuse some."""
        found = dict(self.study.summary.status)
        beyond = found.get("ok", 0) - self.aggregate.feasible
        if self.limits and beyond > 0:
            found |= {"ok": self.aggregate.feasible, f"not {' and '.join(self.limits)}": beyond}
        return {name: count for name, count in found.items() if count}


def gather(
    folder: str | Path,
    objectives: Sequence[str] = (),
    limits: Sequence[str] = (),
    variants: Sequence[int] = (),
    tolerances: Tolerances | None = None,
    progress: bool | None = None,
) -> StudyFacts:
    """Gather what the report of a study says.

    Parameters
    ----------
    folder : str or Path
        The study.
    objectives : sequence of str
        ``min A`` or ``max B``; by default the study's own; of a single one also what
        stands against it.
    limits : sequence of str
        Conditions besides the study's limits, such as ``hole_web_mm > 3``.
    variants : sequence of int
        Further variants to show.
    tolerances : Tolerances, optional
        How far pieces deviate.
    progress : bool, optional
        Whether there are progress bars.

    Returns
    -------
    StudyFacts

    Raises
    ------
    InputError
        For a folder without a study, unknown columns, or a variant that is not there.
    """
    study = open_study(folder)
    rows = open_table(folder)
    wanted = objectives_of(list(objectives) or _default(study, rows), rows.schema)
    texts = [each.column for each in wanted]
    others = [name for name in OTHER_OUTCOMES if name in rows.schema and name not in texts]
    outcomes = [*texts, *others][: max(MOST_OUTCOMES, len(texts))]
    found = aggregate(study, rows, outcomes, limits, progress=progress)
    front = _front(folder, wanted, limits, progress)
    chosen = choose_variants(front, wanted)
    chosen.update({each: _asked_for(study, each) for each in variants if each not in chosen})
    drives = [study.drive_of(variant, name=f"variant {variant}") for variant in chosen]
    held = tolerances or assumed_tolerances(study)
    candidates = list(dict.fromkeys([*chosen, *spread(front, CANDIDATES)["variant"].to_list()]))
    candidates = [variant for variant in candidates if study.row(variant)["status"] == "ok"]
    return StudyFacts(
        study,
        wanted,
        list(limits),
        outcomes,
        found,
        spread(front, FRONT_ROWS),
        front.height,
        chosen,
        compare(drives) if drives else None,
        robust_variants(study, candidates, wanted, held) if held and candidates else [],
        held,
        tolerances is None,
    )


def _asked_for(study: StoredStudy, variant: int) -> str:
    """Why a variant is shown that was asked for, and what speaks against it."""
    status = study.row(variant)["status"]
    return "asked for" if status == "ok" else f"asked for, not feasible: {status}"


def _front(
    folder: str | Path,
    objectives: list[Objective],
    limits: Conditions,
    progress: bool | None,
) -> pl.DataFrame:
    """Front over several objectives; the best variants by a single one."""
    if len(objectives) == 1:
        return best_variants(folder, objectives[0], limits, rows=FRONT_ROWS).table
    return pareto_front(folder, objectives, limits, progress=progress)


def _default(study: StoredStudy, rows: Rows) -> list[Objective]:
    """The study's objectives; of a single one also the result that stands most against it."""
    if len(study.objectives) > 1:
        return list(study.objectives)
    first = study.objective or Objective("output_stiffness_nm_per_arcmin", maximise=True)
    if study.objective is None and first.column not in rows.schema:
        raise InputError(f"{study.folder}: the study has no objective, expected --pareto A,B")
    read = names_in(first.column)
    others = [each for each in OPPONENTS if each.column in rows.schema and each.column not in read]
    goods = {each.column: _goodness(each, rows) for each in (first, *others)}
    pairs = {each: goods[first.column] * goods[each.column] for each in others}
    if not pairs:
        return [first]
    ok = rows.frame.filter(pl.col("status").cast(pl.String) == "ok")
    means = ok.select(
        *(value.mean().alias(name) for name, value in goods.items()),
        *((value**2).mean().alias(f"{name}^2") for name, value in goods.items()),
        *(pair.mean().alias(f"{each.column}*") for each, pair in pairs.items()),
    )
    moments = means.collect(engine="streaming").row(0, named=True)

    def correlation(each: Objective) -> float:
        a, b = first.column, each.column
        if any(moments[name] is None for name in (a, b, f"{b}*")):
            return 1.0
        spread_a = max(moments[f"{a}^2"] - moments[a] ** 2, 0.0)
        spread_b = max(moments[f"{b}^2"] - moments[b] ** 2, 0.0)
        if spread_a <= 1e-12 * moments[f"{a}^2"] or spread_b <= 1e-12 * moments[f"{b}^2"]:
            return 1.0
        return float((moments[f"{b}*"] - moments[a] * moments[b]) / (spread_a * spread_b) ** 0.5)

    results = [each for each in pairs if each.column not in study.axes]
    most = min(results or list(pairs), key=correlation)
    return [first, most if correlation(most) < OPPOSED else min(pairs, key=correlation)]


def _goodness(objective: Objective, rows: Rows) -> pl.Expr:
    value = number(objective.column, rows.schema, where="objective")
    return value if objective.maximise else -value
