"""Variants worth a closer look: the best, the balanced, and those that stay good when made."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.explore.robust import by_robustness, tolerance_percentiles
from cyclosweep.sweep.axes import is_count
from cyclosweep.sweep.expressions import names_in
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.stored import StoredStudy
from cyclosweep.sweep.tolerances import Tolerances

__all__ = ["Robust", "assumed_tolerances", "choose_variants", "robust_variants", "spread"]

ASSUMED_TOLERANCE = 0.005
"""Half width of the tolerance over a dimension's value, where none is given: our assumption, which
the report says; a drawing's own are given by a tolerance file."""
PIECES = {"published": 1024, "components": 128}
"""Pieces made of each candidate, by model: some thousands in a second each."""


@dataclass(frozen=True)
class Robust:
    """What becomes of one candidate when it is made within tolerances.

    Attributes
    ----------
    variant : int
        Its number.
    nominal : dict
        Each objective as drawn.
    percentiles : dict
        5th, 50th and 95th percentile of each objective over the pieces that can be built.
    usable : float
        Share of the pieces that can be built and keep the study's limits.
    refused : str
        Status of most of the other pieces; empty where all are usable.
    """

    variant: int
    nominal: dict[str, float]
    percentiles: dict[str, tuple[float, float, float]]
    usable: float
    refused: str


def spread(front: pl.DataFrame, most: int) -> pl.DataFrame:
    """Rows of a front evenly spread over it, its ends among them.

    Parameters
    ----------
    front : polars.DataFrame
        Sorted by its first objective.
    most : int
        How many rows at most.

    Returns
    -------
    polars.DataFrame
    """
    if front.height <= most:
        return front
    places = np.unique(np.linspace(0, front.height - 1, most).round().astype(int))
    rows: list[int] = places.tolist()
    return front.select(pl.all().gather(rows))


def choose_variants(front: pl.DataFrame, objectives: Sequence[Objective]) -> dict[int, str]:
    """Choose from a front the best by each objective and the most balanced one.

    Parameters
    ----------
    front : polars.DataFrame
        Its rows.
    objectives : sequence of Objective
        What it is a front of.

    Returns
    -------
    dict of int to str
        Variants and why each was chosen.
    """
    if front.is_empty():
        return {}
    columns = [front[each.column].cast(pl.Float64).to_numpy() for each in objectives]
    losses = []
    for each, values in zip(objectives, columns, strict=True):
        signed = -values if each.maximise else values
        width = signed.max() - signed.min()
        losses.append((signed - signed.min()) / width if width > 0 else np.zeros(len(signed)))
    found: dict[int, str] = {}
    variants = front["variant"].to_list()
    for each, loss in zip(objectives, losses, strict=True):
        best = variants[int(np.argmin(loss))]
        word = "greatest" if each.maximise else "least"
        why = f"{word} {each.column}"
        found[best] = f"{found[best]} and {why}" if best in found else why
    balanced = variants[int(np.argmin(np.sqrt(np.sum(np.square(losses), axis=0))))]
    if len(objectives) > 1 and balanced not in found:
        found[balanced] = "nearest to the best of every objective, each over its range on the front"
    return found


def assumed_tolerances(study: StoredStudy) -> Tolerances | None:
    """Tolerances assumed where none are given: half a percent of every dimension that varies."""
    known = study.drive.every_input()
    inputs: dict[str, float] = {}
    for name in study.axes:
        if name == "criterion" or is_count(name) or name not in known:
            continue
        value = {**study.drive.values(), **study.drive.part_values()}.get(name, math.nan)
        if math.isfinite(value) and value != 0:
            inputs[name] = abs(value) * ASSUMED_TOLERANCE
    return Tolerances(inputs) if inputs else None


def robust_variants(
    study: StoredStudy,
    variants: Sequence[int],
    objectives: Sequence[Objective],
    tolerances: Tolerances,
) -> list[Robust]:
    """Make pieces of each candidate within tolerances and say what becomes of the objectives.

    Parameters
    ----------
    study : StoredStudy
        The study, for its limits and model.
    variants : sequence of int
        Candidates.
    objectives : sequence of Objective
        What matters.
    tolerances : Tolerances
        How far pieces deviate.

    Returns
    -------
    list of Robust
        The one whose bad piece (95th percentile of the first objective, in its bad sense) is
        best comes first; those with more than one unusable piece in a hundred after the others.
        Empty where an objective or limit reads columns of the user's own, which a stored study
        does not tell how to compute.
    """
    texts = [each.column for each in objectives]
    limits = study.limits
    read = {name for text in (*texts, *limits) for name in names_in(text)}
    if read & study.own_columns:
        return []
    parts = []
    for variant in variants:
        drive = study.drive_of(variant)
        held = _held(tolerances, drive)
        given = {**drive.values(), **drive.part_values()}
        shown = {*study.axes, *read, *held.inputs} & given.keys()
        inputs = {name: [given[name]] for name in sorted(shown) if math.isfinite(given[name])}
        part = tolerance_percentiles(
            pl.DataFrame(inputs),
            held,
            texts,
            drive=drive,
            limits=limits,
            count=PIECES[study.model],
            seed=1,
            loads_tn=study.loads_tn,
            model=study.model,
            solver=study.solver,
            progress=False,
        )
        at = [name for name in part.columns if name not in inputs]
        parts.append(part.select(pl.lit(variant).alias("variant"), *at))
    first = objectives[0]
    bad = f"{first.column}_p{5 if first.maximise else 95}"
    ordered = by_robustness(pl.concat(parts), bad, first.maximise)
    return [_robust(row, texts) for row in ordered.rows(named=True)]


def _robust(row: Mapping[str, Any], texts: Sequence[str]) -> Robust:
    """One row of percentiles over tolerances."""

    def real(name: str) -> float:
        value = row[name]
        return math.nan if value is None else float(value)

    return Robust(
        row["variant"],
        {text: real(f"{text}_nominal") for text in texts},
        {text: (real(f"{text}_p5"), real(f"{text}_p50"), real(f"{text}_p95")) for text in texts},
        row["share_ok"],
        row["refused"] or "",
    )


def _held(tolerances: Tolerances, drive: Drive) -> Tolerances:
    """Tolerances of the inputs that this drive has a value of."""
    given = {**drive.values(), **drive.part_values()}
    kept: dict[str, Any] = {
        name: each
        for name, each in tolerances.inputs.items()
        if math.isfinite(given.get(name, math.nan))
    }
    return Tolerances(kept, tolerances.batches, tolerances.batch_size)
