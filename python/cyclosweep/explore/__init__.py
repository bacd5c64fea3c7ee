"""Choosing among the variants of a study: best ones, near ones, robust ones, and what matters."""

from cyclosweep.explore.feasible import FeasibleRanges, feasible_ranges
from cyclosweep.explore.influence import input_influence
from cyclosweep.explore.nearest import nearest_variants
from cyclosweep.explore.pareto import pareto_front
from cyclosweep.explore.robust import robust_choice, tolerance_percentiles
from cyclosweep.explore.short_forms import pareto, sensitivity
from cyclosweep.explore.sobol import driving_inputs, sobol_indices

__all__ = [
    "FeasibleRanges",
    "driving_inputs",
    "feasible_ranges",
    "input_influence",
    "nearest_variants",
    "pareto",
    "pareto_front",
    "robust_choice",
    "sensitivity",
    "sobol_indices",
    "tolerance_percentiles",
]
