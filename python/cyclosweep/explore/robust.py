"""Designs that stay good: percentiles of results over the tolerances of the inputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import finite_number, whole_number
from cyclosweep.design.parts import Engine
from cyclosweep.errors import InputError, instance_of, names_of
from cyclosweep.explore.tables import Conditions, conditions
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.progress import Progress, ShowProgress
from cyclosweep.sweep.scan import sweep
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Study, StudyModel
from cyclosweep.sweep.tolerances import Tolerances, deviations, nominal_value

__all__ = ["Designs", "by_robustness", "robust_choice", "tolerance_percentiles"]

Designs = Drive | Sequence[Drive] | pl.DataFrame
"""A drive, several, or a table whose columns are inputs of one."""

PIECES = 1024
"""Pieces of each design: percentiles from 5 to 95 of a smooth result to about 1 % of its spread."""
LEAST_SHARE_OK = 0.99
"""A design of which fewer pieces are good comes after all others, however good these pieces are:
one scrapped part in a hundred is what series production of such parts may bear."""
_ROWS = 100_000
"""Pieces evaluated at a time, at least one design's."""

_Reals = npt.NDArray[np.float64]


def tolerance_percentiles(
    designs: Designs,
    tolerances: Tolerances | Mapping[str, Any],
    results: str | Sequence[str],
    percentiles: Sequence[float] = (5, 50, 95),
    *,
    drive: Drive | None = None,
    limits: Conditions | None = None,
    count: int = PIECES,
    seed: int = 0,
    loads_tn: Sequence[float] | None = None,
    model: StudyModel | None = None,
    solver: Engine | None = None,
    progress: ShowProgress = None,
) -> pl.DataFrame:
    """Percentiles of results over the tolerances of the inputs, design by design.

    Parameters
    ----------
    designs : Drive, sequence of Drive or DataFrame
        Designs as drawn. In a table the columns that are inputs of ``drive`` replace its values;
        the others are labels and pass through.
    tolerances : Tolerances or mapping
        For each input how far made pieces deviate, as for
        :meth:`~cyclosweep.sweep.space_makers.SpaceMakers.around`. Every design has the same
        deviations, so that a difference between two is not one of luck.
    results : str or sequence of str
        Columns of a sweep, or expressions of them.
    percentiles : sequence of float
        From 0 to 100.
    drive : Drive, optional
        What does not vary in a table; the reference drive by default.
    limits : mapping, sequence of str or str, optional
        What a good piece meets, as for :func:`~cyclosweep.explore.pareto.pareto_front`.
    count : int
        Pieces of each design; a power of two is balanced best.
    seed : int
        Seed of the deviations.
    loads_tn, model, solver : optional
        As for :func:`~cyclosweep.sweep.scan.scan`.
    progress : bool or callable, optional
        Whether there is a progress bar, by default on a terminal after two seconds; or a
        function that is told how much is done and how much there is.

    Returns
    -------
    polars.DataFrame
        A row for each design, in order: what the table holds, or the drive's name; ``share_ok``,
        the share of pieces that can be built and keep the limits; ``refused``, the status that
        most of the other pieces have, ``limit_COLUMN`` of those outside a limit, null where there
        are none; and for each result
        ``RESULT_nominal`` as drawn and ``RESULT_p5`` and so on, over all pieces that can be
        built. Null where none can.

    Raises
    ------
    InputError
        For an unknown input or result, no results, no percentile or one beyond 0 to 100, or no
        designs.

    Notes
    -----
    Percentiles are interpolated linearly between the sorted pieces, as ``numpy.percentile`` does.
    Pieces are Sobol points, with batches those of a Latin hypercube: with 1024 the percentiles
    are as good as those of some ten times as many independent draws.

    Examples
    --------
    >>> drive = Drive.reference_87()
    >>> found = tolerance_percentiles(drive, {"shaft_1_diameter_mm": 0.5}, "twist_1tn_deg")
    >>> row = found.row(0, named=True)
    >>> row["twist_1tn_deg_p5"] < row["twist_1tn_deg_nominal"] < row["twist_1tn_deg_p95"]
    True
    """
    if isinstance(results, (list, tuple)) and not results:
        raise InputError("results: none, expected at least one column")
    wanted = names_of("results", results, or_one=True)
    if isinstance(percentiles, str) or not isinstance(percentiles, Iterable):
        raise InputError(f"percentiles: found {percentiles!r}, expected a list of numbers")
    ranks = [finite_number("percentiles", each) for each in percentiles]
    if not ranks:
        raise InputError("percentiles: found none, expected at least one from 0 to 100")
    for rank in ranks:
        if not 0 <= rank <= 100:
            raise InputError(f"percentiles: found {rank:g}, expected 0 to 100")
    spread = Tolerances.of(tolerances)
    count = whole_number("count", count, least=1, most=2**24)
    drawn = deviations(spread, count, seed=whole_number("seed", seed, least=0, most=2**64 - 1))
    settings = {"loads_tn": loads_tn, "model": model, "solver": solver}
    labels, blocks, total = _blocks(designs, drive, max(1, _ROWS // count))
    parts = []
    with Progress("tolerances", total, show=progress) as bar:
        for base, block in blocks:
            nominal = {
                name: block[name].cast(pl.Float64).to_numpy()
                if name in block.columns
                else np.full(block.height, nominal_value(base, name))
                for name in spread.names
            }
            made = _made(base, block, nominal, drawn, count)
            values, refused = _values(base, made, wanted, limits, settings)
            drawing, _ = _values(base, block, wanted, None, settings)
            good = refused.is_null().to_numpy()
            columns = {
                "share_ok": good.reshape(-1, count).mean(axis=1),
                "refused": _most_frequent(refused, count),
            }
            for text, all_pieces, as_drawn in zip(wanted, values, drawing, strict=True):
                columns[f"{text}_nominal"] = as_drawn
                found = _percentiles(all_pieces.reshape(-1, count), ranks)
                for rank, column in zip(ranks, found, strict=True):
                    columns[f"{text}_p{f'{rank:g}'.replace('.', '_')}"] = column
            parts.append(pl.DataFrame(columns, nan_to_null=True))
            bar.advance(block.height)
    clash = sorted(set(labels.columns) & set(parts[0].columns))
    if clash:
        raise InputError(f"designs: have a column {clash[0]}, expected another name for it")
    return pl.concat([labels, pl.concat(parts)], how="horizontal")


def robust_choice(
    designs: Designs,
    tolerances: Tolerances | Mapping[str, Any],
    objective: Objective | str,
    *,
    percentile: float = 95,
    least_share_ok: float = LEAST_SHARE_OK,
    **settings: Any,
) -> pl.DataFrame:
    """Order designs by how good they stay within their tolerances, not by their best.

    Parameters
    ----------
    designs : Drive, sequence of Drive or DataFrame
        As for :func:`tolerance_percentiles`.
    tolerances : Tolerances or mapping
        As there.
    objective : Objective or str
        What is to be small, or great with ``Objective(column, maximise=True)``.
    percentile : float
        Share of pieces [%] that are at least as good as the figure by which designs are ordered.
    least_share_ok : float
        A design of which fewer pieces are good [1] comes after all others.
    **settings
        ``drive``, ``limits``, ``count``, ``seed``, ``loads_tn``, ``model``, ``solver`` and
        ``progress``, as there.

    Returns
    -------
    polars.DataFrame
        As there, the best design first, with ``rank`` and ``rank_nominal``, the place it has as
        drawn.

    Raises
    ------
    InputError
        As there, and for a percentile beyond 0 to 100 or a share beyond 0 to 1.

    Examples
    --------
    >>> drives = [Drive.reference_87(), Drive.reference_87().replace(shaft_1_diameter_mm=54.0)]
    >>> best = robust_choice(drives, {"shaft_1_diameter_mm": 0.5}, "twist_1tn_deg")
    >>> best.select("rank", "rank_nominal").row(0)
    (1, 1)
    """
    instance_of("objective", objective, str, Objective)
    wanted = Objective(objective) if isinstance(objective, str) else objective
    if not 0 <= finite_number("percentile", percentile) <= 100:
        raise InputError(f"percentile: found {percentile:g}, expected 0 to 100")
    if not 0 <= finite_number("least_share_ok", least_share_ok) <= 1:
        raise InputError(f"least_share_ok: found {least_share_ok:g}, expected 0 to 1")
    worst = 100 - percentile if wanted.maximise else percentile
    found = tolerance_percentiles(designs, tolerances, wanted.column, [worst], **settings)
    by, as_drawn = found.columns[-1], f"{wanted.column}_nominal"
    rank = pl.col(as_drawn).rank("min", descending=wanted.maximise).alias("rank_nominal")
    found = by_robustness(found.with_columns(rank), by, wanted.maximise, least_share_ok)
    place = pl.int_range(1, pl.len() + 1, dtype=pl.UInt32).alias("rank")
    return found.select(place, "rank_nominal", pl.exclude("rank_nominal"))


def by_robustness(
    found: pl.DataFrame, by: str, maximise: bool, least_share_ok: float = LEAST_SHARE_OK
) -> pl.DataFrame:
    """Order designs by a percentile, those with too few good pieces after all others.

    Parameters
    ----------
    found : DataFrame
        Of :func:`tolerance_percentiles`.
    by : str
        Column of the percentile.
    maximise : bool
        Whether it is to be great.
    least_share_ok : float
        Share of pieces [1] that have to be good.

    Returns
    -------
    polars.DataFrame
        The same rows, the best first.
    """
    return found.sort(
        pl.col("share_ok") >= least_share_ok, by, descending=[True, maximise],
        nulls_last=True, maintain_order=True,
    )  # fmt: skip


def _blocks(
    designs: Designs, drive: Drive | None, size: int
) -> tuple[pl.DataFrame, Iterator[tuple[Drive, pl.DataFrame]], int]:
    """Labels of the designs; drives with a few rows of inputs each; how many designs there are."""
    instance_of("designs", designs, pl.DataFrame, Drive, Sequence)
    if isinstance(designs, pl.DataFrame):
        base = drive or Drive.reference_87()
        known = base.every_input()
        inputs = [name for name in designs.columns if name in known]
        if designs.is_empty() or not inputs:
            raise InputError("designs: no rows with columns that are inputs, expected some")
        table = designs.select(inputs)
        steps = range(0, designs.height, size)
        return designs, ((base, table[k : k + size]) for k in steps), designs.height
    drives = [designs] if isinstance(designs, Drive) else list(designs)
    if not drives or not all(isinstance(each, Drive) for each in drives):
        raise InputError(f"designs: found {designs!r}, expected drives or a table of inputs")
    if drive is not None:
        raise InputError("drive: only for a table of designs")
    # A column that changes nothing gives a table of one row its height.
    alone = ((each, pl.DataFrame({"eccentricity_mm": [each.eccentricity_mm]})) for each in drives)
    return pl.DataFrame({"drive": [each.name for each in drives]}), alone, len(drives)


def _made(
    base: Drive,
    block: pl.DataFrame,
    nominal: Mapping[str, _Reals],
    drawn: Mapping[str, tuple[_Reals, _Reals]],
    count: int,
) -> pl.DataFrame:
    """Inputs of all pieces of some designs, design after design."""
    place = np.repeat(np.arange(block.height), count)
    pieces = {
        name: (nominal[name][:, None] * factor + added).reshape(-1)
        for name, (factor, added) in drawn.items()
    }
    return block[place].with_columns(**{name: pl.Series(each) for name, each in pieces.items()})


def _values(
    base: Drive,
    inputs: pl.DataFrame,
    wanted: Sequence[str],
    limits: Conditions | None,
    settings: Mapping[str, Any],
) -> tuple[list[_Reals], pl.Series]:
    """Results of rows of inputs, NaN where one cannot be built; why a row is not good, or null."""
    study = Study.of(Space.table(base, inputs), **settings)
    schema = study.schema()
    values = [number(text, schema, where="results") for text in wanted]
    status = pl.col("status").cast(pl.String)
    reasons = [pl.when(status != "ok").then(status)]
    for text, each in _one_by_one(limits):
        inside = pl.all_horizontal(*conditions(each, schema, only_ok=False)).fill_null(False)
        reasons.append(pl.when(~inside).then(pl.lit(f"limit_{text}")))
    columns = [value.alias(f"__{k}") for k, value in enumerate(values)]
    found = sweep(study).select(*columns, pl.coalesce(*reasons).alias("__refused"))
    reals = [found[f"__{k}"].fill_null(np.nan).to_numpy() for k in range(len(wanted))]
    return reals, found["__refused"]


def _one_by_one(limits: Conditions | None) -> list[tuple[str, Conditions | None]]:
    """Each of several limits with its text."""
    if isinstance(limits, Mapping):
        return [(text, {text: bounds}) for text, bounds in limits.items()]
    if isinstance(limits, Sequence) and not isinstance(limits, str):
        return [(text, [text]) for text in limits]
    return [] if limits is None else [(str(limits), limits)]


def _most_frequent(refused: pl.Series, count: int) -> pl.Series:
    """The most frequent text of each so many rows, of equally frequent ones the first by name."""
    place = pl.int_range(pl.len(), dtype=pl.UInt32) // count
    designs = pl.DataFrame({"design": range(len(refused) // count)}, schema={"design": pl.UInt32})
    counts = (
        refused.alias("refused").to_frame().with_columns(design=place)
        .drop_nulls("refused").group_by("design", "refused").len()
        .sort("design", "len", "refused", descending=[False, True, False])
        .unique("design", keep="first", maintain_order=True)
    )  # fmt: skip
    return designs.join(counts, on="design", how="left", maintain_order="left")["refused"]


def _percentiles(values: _Reals, ranks: Sequence[float]) -> _Reals:
    """Percentiles of each row without its NaN, shape (ranks, rows); NaN where there is nothing."""
    found = np.full((len(ranks), len(values)), np.nan)
    is_number = ~np.isnan(values)
    whole = is_number.all(axis=1)
    if whole.any():
        found[:, whole] = np.percentile(values[whole], ranks, axis=1)
    for row in np.flatnonzero(~whole & is_number.any(axis=1)):
        found[:, row] = np.percentile(values[row][is_number[row]], ranks)
    return found
