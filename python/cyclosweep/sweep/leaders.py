"""The best variants by one objective, part by part: how many are equal, and whether it moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import polars as pl

__all__ = ["BEST", "VALUE", "Leaders", "leaders", "merge_leaders"]

BEST = 10
"""Best variants that a summary lists."""
VALUE = "value of the objective"
"""Name of an objective's column while it is compared; no other column can have it."""

_SAME = 1e-12
"""Values that differ by less than this share are equal: the last digits are rounding."""


@dataclass(frozen=True)
class Leaders:
    """The best variants by one objective.

    Attributes
    ----------
    column : str
        Column or expression.
    best : list of dict
        The best variants with their inputs, best first.
    count : int
        Variants that have a value.
    tied : int
        How many of them are as good as the best one.
    least, greatest : float or None
        Range of the values.
    """

    column: str
    best: list[dict[str, Any]] = field(default_factory=list)
    count: int = 0
    tied: int = 0
    least: float | None = None
    greatest: float | None = None

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values."""
        return dict(vars(self))

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> Leaders:
        """Read what :meth:`to_json` returned."""
        return cls(**value)

    def remarks(self, words: str) -> list[str]:
        """Say that nothing moves the objective, or that several variants are equally good.

        Parameters
        ----------
        words : str
            The objective.

        Returns
        -------
        list of str
            Empty where there is one best variant.
        """
        if self.tied < 2 or self.least is None or self.greatest is None:
            return []
        if same(self.least, self.greatest):
            return [
                f"{words}: the same in all {self.count:,} variants that can be built; no axis of "
                "this study moves it"
            ]
        differing = [
            name
            for name in self.best[0]
            if name not in ("variant", self.column)
            and len({row[name] for row in self.best[: self.tied]}) > 1
        ]
        # Draws among a few values repeat each other.
        where = f"differ in {', '.join(differing)}" if differing else "have the same inputs"
        return [
            f"{words}: {self.tied:,} variants are equally good, so the best is one of several; "
            f"those listed {where}"
        ]


def same(one: float, other: float) -> bool:
    """Whether two values of an objective are equal but for rounding.

    Parameters
    ----------
    one, other : float
        In the objective's unit.

    Returns
    -------
    bool
    """
    return one == other or math.isclose(one, other, rel_tol=_SAME)


def leaders(table: pl.DataFrame, column: str, maximise: bool) -> Leaders:
    """Find the best variants of one part.

    Parameters
    ----------
    table : polars.DataFrame
        ``variant``, the objective as :data:`VALUE` without nulls, and the inputs that vary.
    column : str
        The objective.
    maximise : bool
        Whether more is better.

    Returns
    -------
    Leaders
    """
    if table.is_empty():
        return Leaders(column)
    first = table.bottom_k(BEST, by=[VALUE, "variant"], reverse=[maximise, False])
    top = float(first[VALUE][0])
    ends = table.select(low=pl.col(VALUE).min(), high=pl.col(VALUE).max()).row(0)
    reach = _SAME * abs(top)
    equal = (pl.col(VALUE) == top) | (pl.col(VALUE) - top).abs().le(reach)
    tied = int(table.select(equal.sum()).item())
    inputs = [name for name in table.columns if name not in ("variant", VALUE, column)]
    value = [] if column == "variant" else [pl.col(VALUE).alias(column)]
    rows = first.select("variant", *value, *inputs).to_dicts()
    return Leaders(column, rows, table.height, tied, *map(float, ends))


def merge_leaders(parts: Sequence[Leaders], maximise: bool) -> Leaders:
    """Put the best variants of several parts together.

    Parameters
    ----------
    parts : sequence of Leaders
        By the same objective.
    maximise : bool
        Whether more is better.

    Returns
    -------
    Leaders
    """
    filled = [part for part in parts if part.best]
    if not filled:
        return Leaders(parts[0].column if parts else "")
    column, sign = filled[0].column, -1 if maximise else 1
    rows = [row for part in filled for row in part.best]
    best = sorted(rows, key=lambda row: (sign * row[column], row["variant"]))[:BEST]
    top = best[0][column]
    return Leaders(
        column,
        best,
        sum(part.count for part in filled),
        sum(part.tied for part in filled if same(part.best[0][column], top)),
        min(part.least for part in filled if part.least is not None),
        max(part.greatest for part in filled if part.greatest is not None),
    )
