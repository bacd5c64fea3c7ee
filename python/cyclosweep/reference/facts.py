"""One row of the validation: what a source says, what the package computes, how the row counts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

__all__ = ["COUNTED", "KINDS", "Fact", "Kind", "Mark"]

Mark = Literal["published", "derived", "reading", "assumed", "reconstruction", "identity", "ours"]
Kind = Literal[
    "evidence", "independent solution", "identity", "input", "reconstruction", "comparison",
    "not computed",
]  # fmt: skip
KINDS: dict[Kind, str] = {
    "evidence": "a number of a named publication that the computed one was not built from",
    "independent solution": "a number of a separate solution or program that no named publication "
    "prints: it can be solved for again, not looked up",
    "identity": "what the formulas must fulfil whatever the dimensions: a check of the code",
    "input": "typed into the drive, or a dimension chosen so that the number comes out",
    "reconstruction": "a rule compared with what the rule was built from",
    "comparison": "figures side by side; no source gives a number",
    "not computed": "in a source, but outside the model",
}
"""What a row is worth, by kind."""
COUNTED: tuple[Kind, ...] = ("evidence", "independent solution", "identity")
"""The kinds that count; of the others agreement says nothing."""
_NEED_A_SOURCE: tuple[Kind, ...] = ("evidence", "independent solution")


@dataclass(frozen=True)
class Fact:
    """A fact and what the model makes of it.

    Attributes
    ----------
    group : str
        Table it belongs to.
    fact : str
        What it says.
    published : float or None
        The number that is compared with: of a publication, of an independent solution or of an
        identity; the middle of a band, None where there is no number.
    computed : float or None
        What the library computes; None where the model cannot.
    unit : str
        Unit of both, "1" for pure numbers.
    mark : str
        What the computed number rests on: ``published`` inputs only, ``derived`` from them, a
        ``reading`` of an ambiguous print, ``assumed`` dimensions, a ``reconstruction`` that
        matches the published map, a mathematical ``identity``, or numbers that are ``ours`` and
        printed nowhere.
    kind : str
        What the row is worth, one of :data:`KINDS`; those in :data:`COUNTED` count.
    tolerance : float or None
        Largest allowed distance, in the same unit; None where the row only compares.
    note : str
        Reason why nothing is computed, or what to make of it.
    explanation : str
        Why the two numbers are known to disagree; empty where they should agree.
    explained : float or None
        The computed number that the explanation is about. Where another one is computed, the
        explanation does not hold and the row disagrees without one.
    source : str
        Where the number comes from: for ``evidence`` a publication in which it can be looked up,
        for an ``independent solution`` who solved for it, or that this is not known.
    """

    group: str
    fact: str
    published: float | None
    computed: float | None
    unit: str
    mark: Mark
    kind: Kind
    tolerance: float | None = None
    note: str = ""
    explanation: str = ""
    explained: float | None = None
    source: str = ""

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise ValueError(f"{self.fact}: no such kind of row, {self.kind!r}")
        if self.counted and (self.published is None or self.tolerance is None):
            raise ValueError(f"{self.fact}: a counted row needs a number and a tolerance")
        if bool(self.explanation) != (self.explained is not None):
            raise ValueError(f"{self.fact}: an explanation needs the number that it explains")
        if self.kind in _NEED_A_SOURCE and not self.source:
            raise ValueError(f"{self.fact}: {self.kind} needs a source")

    @property
    def counted(self) -> bool:
        """Whether the row counts."""
        return self.kind in COUNTED

    @property
    def ok(self) -> bool | None:
        """Whether the numbers agree; None where there is nothing to decide."""
        if self.published is None or self.computed is None or self.tolerance is None:
            return None
        return abs(self.computed - self.published) <= self.tolerance

    @property
    def is_explained(self) -> bool:
        """Whether the numbers disagree, and by what the row explains."""
        if self.ok is not False or self.explained is None or self.computed is None:
            return False
        return math.isclose(self.computed, self.explained, rel_tol=1e-3, abs_tol=1e-9)
