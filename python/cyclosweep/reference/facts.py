"""One row of a validation: what is published, what is computed, and on what it rests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

__all__ = ["Fact", "Mark"]

Mark = Literal["published", "derived", "reading", "assumed", "reconstruction", "identity"]


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
        The number in the source; the middle of a band, None where there is no number.
    computed : float or None
        What the library computes; None where the model cannot.
    unit : str
        Unit of both, "1" for pure numbers.
    mark : str
        What the computed number rests on: ``published`` inputs only, ``derived`` from them, a
        ``reading`` of an ambiguous print, ``assumed`` dimensions, a ``reconstruction`` that
        matches the published map, or a mathematical ``identity``.
    tolerance : float or None
        Largest allowed distance, in the same unit; None where the row only compares.
    note : str
        Reason why nothing is computed, source, or what to make of it.
    """

    group: str
    fact: str
    published: float | None
    computed: float | None
    unit: str
    mark: Mark
    tolerance: float | None = None
    note: str = ""

    @property
    def ok(self) -> bool | None:
        """Whether the numbers agree; None where there is nothing to decide."""
        if self.published is None or self.computed is None or self.tolerance is None:
            return None
        return abs(self.computed - self.published) <= self.tolerance
