"""Choosing among the variants of a study: best ones, near ones, robust ones, and what matters."""

from cyclosweep.explore.nearest import nearest_variants
from cyclosweep.explore.pareto import pareto_front

__all__ = ["nearest_variants", "pareto_front"]
