"""What the best variants of a study are best in."""

from __future__ import annotations

from dataclasses import dataclass

from cyclosweep.errors import InputError, instance_of

__all__ = ["Objective"]


@dataclass(frozen=True)
class Objective:
    """What the best variants are best in.

    Attributes
    ----------
    column : str
        A column of the study, or an expression of columns.
    maximise : bool
        Whether more is better.
    """

    column: str
    maximise: bool = False

    def __post_init__(self) -> None:
        instance_of("objective", self.column, str)
        instance_of("maximise", self.maximise, bool)
        if not self.column.strip():
            raise InputError(
                f"objective: found {self.column!r}, expected a column or an expression of columns"
            )

    def __str__(self) -> str:
        return f"{'maximise' if self.maximise else 'minimise'} {self.column}"
