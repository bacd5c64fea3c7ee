"""Sweep, validate and diagnose the torsional compliance of cycloidal gear drives."""

import importlib as _importlib
import logging as _logging
import warnings as _warnings
from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any

import cyclosweep._core as _core
import cyclosweep._moved as _moved
from cyclosweep.design.drive import Cylinder, Drive, Frustum, Keyway
from cyclosweep.dynamics.train import Train
from cyclosweep.errors import DesignError, InputError, SweepError
from cyclosweep.plugins import Column
from cyclosweep.sweep.dataset_files import scan_dataset
from cyclosweep.sweep.design_table import evaluate_table
from cyclosweep.sweep.distributions import Distribution, log_uniform, normal, triangular, uniform
from cyclosweep.sweep.evaluator import Evaluator
from cyclosweep.sweep.scan import kernel_evaluations, scan, sweep
from cyclosweep.sweep.shards import shard, sink
from cyclosweep.sweep.space import Space, linspace
from cyclosweep.sweep.stored import StoredStudy, open_study
from cyclosweep.sweep.study import Objective, Study
from cyclosweep.sweep.tolerances import Tolerances

if _TYPE_CHECKING:
    from cyclosweep import cad as cad
    from cyclosweep.choose.best import BestVariants, best_variants
    from cyclosweep.choose.comparison import Comparison, compare
    from cyclosweep.design.drive_modes import dimension_sensitivities, modes
    from cyclosweep.design.events import Event, transient
    from cyclosweep.diagnosis import Diagnosis, Series, diagnose, diagnose_folder
    from cyclosweep.explore import (
        FeasibleRanges,
        driving_inputs,
        feasible_ranges,
        input_influence,
        nearest_variants,
        pareto,
        pareto_front,
        robust_choice,
        sensitivity,
        sobol_indices,
        tolerance_percentiles,
    )
    from cyclosweep.recording import Recording
    from cyclosweep.reference.rows import validate
    from cyclosweep.simulation.simulate import Model, simulate
    from cyclosweep.study_report import report_study

# Imported when first asked for: SciPy takes longer to load than all a worker of a sweep needs.
_LATER = {
    "BestVariants": "choose.best",
    "Comparison": "choose.comparison",
    "Diagnosis": "diagnosis",
    "Event": "design.events",
    "FeasibleRanges": "explore",
    "Model": "simulation.simulate",
    "Recording": "recording",
    "Series": "diagnosis",
    "best_variants": "choose.best",
    "compare": "choose.comparison",
    "dimension_sensitivities": "design.drive_modes",
    "diagnose": "diagnosis",
    "diagnose_folder": "diagnosis",
    "driving_inputs": "explore",
    "feasible_ranges": "explore",
    "input_influence": "explore",
    "modes": "design.drive_modes",
    "nearest_variants": "explore",
    "pareto": "explore",
    "pareto_front": "explore",
    "report_study": "study_report",
    "robust_choice": "explore",
    "sensitivity": "explore",
    "simulate": "simulation.simulate",
    "sobol_indices": "explore",
    "tolerance_percentiles": "explore",
    "transient": "design.events",
    "validate": "reference.rows",
}
_FOLDERS = {
    "cad",
    "choose",
    "diagnosis",
    "explore",
    "recording",
    "reference",
    "report",
    "result",
    "simulation",
    "study_report",
}

__version__ = _core.__version__
# Silent until a program asks: logging.basicConfig(level=logging.INFO) shows what long work does.
_logging.getLogger(__name__).addHandler(_logging.NullHandler())
_moved.register()

if _core.DEBUG_BUILD:
    _warnings.warn(
        "cyclosweep's core is a debug build, ten times slower: maturin develop --release",
        stacklevel=2,
    )

__all__ = [
    "BestVariants",
    "Column",
    "Comparison",
    "Cylinder",
    "DesignError",
    "Diagnosis",
    "Distribution",
    "Drive",
    "Evaluator",
    "Event",
    "FeasibleRanges",
    "Frustum",
    "InputError",
    "Keyway",
    "Model",
    "Objective",
    "Recording",
    "Series",
    "Space",
    "StoredStudy",
    "Study",
    "SweepError",
    "Tolerances",
    "Train",
    "__version__",
    "best_variants",
    "compare",
    "diagnose",
    "diagnose_folder",
    "dimension_sensitivities",
    "driving_inputs",
    "evaluate_table",
    "feasible_ranges",
    "input_influence",
    "kernel_evaluations",
    "linspace",
    "log_uniform",
    "modes",
    "nearest_variants",
    "normal",
    "open_study",
    "pareto",
    "pareto_front",
    "report_study",
    "robust_choice",
    "scan",
    "scan_dataset",
    "sensitivity",
    "shard",
    "simulate",
    "sink",
    "sobol_indices",
    "sweep",
    "tolerance_percentiles",
    "transient",
    "triangular",
    "uniform",
    "validate",
]

if not _TYPE_CHECKING:  # so that a wrong name stays an error to a type checker

    def __getattr__(name: str) -> _Any:
        """Import what is asked for later, and keep it."""
        path = f"{__name__}.{_LATER.get(name, name)}"
        if name not in _LATER and name not in _FOLDERS and path not in _moved.MOVED:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module = _importlib.import_module(path)
        value = globals()[name] = getattr(module, name) if name in _LATER else module
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *_LATER})
