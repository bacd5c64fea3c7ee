"""Old names of modules that moved: importing them still works and warns."""

from __future__ import annotations

import importlib
import sys
import types
import warnings
from importlib.machinery import ModuleSpec
from pathlib import Path
from typing import Any

_DESIGN = {"cyclosweep.drive": "design.drive", "cyclosweep.units": "design.units"}
_SWEEP = {
    f"cyclosweep.{old}": f"sweep.{new}"
    for old, new in {
        "space": "space",
        "study": "study",
        "scan": "scan",
        "dataset": "dataset",
        "shards": "shards",
        "cluster": "executors",
        "summary": "summary",
        "progress": "progress",
    }.items()
}
_SIMULATION = {"cyclosweep.simulate": "simulation.simulate"} | {
    f"cyclosweep.effects{part}": f"simulation.effects{part}"
    for part in (
        "",
        ".base",
        ".clearance_takeup",
        ".contact_stiffening",
        ".creep",
        ".datum_drift",
        ".dial_eccentricity",
        ".friction_hysteresis",
        ".history",
        ".load_asymmetry",
        ".load_dependent_friction",
        ".orders",
        ".overload_softening",
        ".phase_dependent_compliance",
        ".slip",
        ".thermal_drift",
        ".transmission_error",
        ".viscous_drag",
    )
}
_DIAGNOSIS = {
    f"cyclosweep.diagnosis.{old}": new
    for old, new in {
        "alarm": "diagnosis.identify.structures.alarm",
        "engine": "diagnosis.diagnose",
        "experiment": "diagnosis.verify.experiment",
        "fault": "diagnosis.refuse",
        "findings": "diagnosis.whole_loop.findings",
        "fit": "diagnosis.identify.fitting.fit",
        "forecast": "diagnosis.whole_loop.forecast",
        "freeform": "diagnosis.hypotheses.unnamed_shapes",
        "holdout": "diagnosis.verify.holdout",
        "hum": "diagnosis.hypotheses.sinusoid",
        "library": "diagnosis.hypotheses.library",
        "noise": "diagnosis.prepare.noise",
        "problem": "diagnosis.prepare.problem",
        "result": "diagnosis.outcome",
        "rich": "diagnosis.hypotheses.flexible_basis",
        "scan": "diagnosis.identify.structures.scan",
        "search": "diagnosis.identify.structures.search",
        "self_check": "diagnosis.verify.self_check",
        "split": "diagnosis.prepare.split",
        "structured": "diagnosis.whole_loop.stepwise",
        "testability": "diagnosis.identify.structures.testability",
        "told": "diagnosis.whole_loop.known_flank",
        "verdict": "diagnosis.identify.structures.verdict",
        "words": "result.statement",
    }.items()
}
_RIG = "aliens balance bristles creep datum dial elastic joint nominal noise pins profile programme"
_RIG += " rig sideload specimen warmth"
_TRIAL = "case concealment oracle plan prediction seal signature tiers"
_SAME_FOLDER = {
    "board": "curves gallery page svg terminal",
    "opponents": "contest gaussian_process ladder lasso ljung_box runs_test stlsq subset",
    "runner": "folders run stages work",
    "scoring": "calibration confusion curves intervals outcome power score",
}
_CHALLENGE = (
    {"": "", ".record": ".record.command"}
    | {f".{folder}": f".{folder}" for folder in _SAME_FOLDER}
    | {
        f".{folder}.{n}": f".{folder}.{n}"
        for folder, ns in _SAME_FOLDER.items()
        for n in ns.split()
    }
    | {f".{name}": f".rig.{name}" for name in _RIG.split()}
    | {f".{name}": f".trial.{name}" for name in _TRIAL.split()}
    | {
        ".diagnosing": ".runner.diagnosing",
        ".verify": ".runner.verify",
        ".opponents.seen": ".opponents.view",
        ".scoring.figures": ".scoring.criteria",
        ".scoring.rivals": ".scoring.opponents",
        ".measured": ".measured.loops",
        ".measured_run": ".measured.run",
    }
)
_DYNAMICS = {"cyclosweep.dynamics.figures": "figures.train"}
MOVED: dict[str, str] = {
    old: f"cyclosweep.{new}"
    for old, new in (_DESIGN | _SWEEP | _SIMULATION | _DIAGNOSIS | _DYNAMICS).items()
} | {f"cyclosweep.challenge{old}": f"cyclosweep_challenge{new}" for old, new in _CHALLENGE.items()}
"""Where the modules of version 0.1 stand now, by their old names."""

_RENAMED_IN_DIAGNOSIS = {
    "fit.Slot": "identify.fitting.fit_parameters.FitParameter",
    "fit.slots_of": "identify.fitting.fit_parameters.fit_parameters_of",
    "forecast.Knob": "whole_loop.model_parameters.ModelParameter",
    "forecast.knobs_of": "whole_loop.model_parameters.model_parameters_of",
    "forecast.start": "whole_loop.forecast.starting_model",
    "freeform.FreeForm": "hypotheses.unnamed_shapes.UnnamedShape",
    "freeform.freeforms": "hypotheses.unnamed_shapes.unnamed_shapes",
    "hum.find_wave": "hypotheses.sinusoid.find_sinusoid",
    "library.Block": "hypotheses.library.Signature",
    "noise.estimate_noise": "prepare.noise_estimate.estimate_noise",
    "rich.rich_basis": "hypotheses.flexible_basis.flexible_basis",
    "scan.price_of_choice": "identify.structures.scan.shape_choice_penalty",
    "scan.price_of_vector": "identify.structures.scan.vector_penalty",
    "search.Node": "identify.structures.candidate.Candidate",
    "structured.Repetition": "whole_loop.run_comparison.Repetition",
    "structured.Steadiness": "whole_loop.run_comparison.Steadiness",
    "structured.climb": "whole_loop.stepwise.whole_loop_structure",
    "structured.repetition": "whole_loop.run_comparison.repetition",
    "structured.steadiness": "whole_loop.run_comparison.steadiness",
    "told.ForecastFit": "whole_loop.known_flank.WholeLoopFit",
    "told.told_fit": "whole_loop.known_flank.whole_loop_fit",
    "told.told_path": "whole_loop.known_flank.known_flank_path",
    "verdict.decide_structured": "identify.structures.verdict.decide_in_stages",
}
RENAMED: dict[str, str] = {
    f"cyclosweep.diagnosis.{old}": f"cyclosweep.diagnosis.{new}"
    for old, new in _RENAMED_IN_DIAGNOSIS.items()
} | {
    "cyclosweep.diagnosis.result.SCHEMA": "cyclosweep.result.answer.SCHEMA",
    "cyclosweep.diagnosis.result.plain": "cyclosweep.result.json_form.plain",
    "cyclosweep.drive.NonNegative": "cyclosweep.design.shaft.NonNegative",
    "cyclosweep.drive.Positive": "cyclosweep.design.shaft.Positive",
    "cyclosweep.drive.Segment": "cyclosweep.design.shaft.Segment",
    "cyclosweep.shards.ENGINES": "cyclosweep.sweep.executors.ENGINES",
    "cyclosweep.shards.write_part": "cyclosweep.sweep.attempts.write_part",
    "cyclosweep.shards.write_parts": "cyclosweep.sweep.attempts.write_parts",
    "cyclosweep.space.is_count": "cyclosweep.sweep.axes.is_count",
    "cyclosweep.simulate.LAW_POINTS": "cyclosweep.simulation.elastic_law.LAW_POINTS",
    "cyclosweep.summary.Record": "cyclosweep.sweep.summary.PartSummary",
    "cyclosweep.summary.record_of": "cyclosweep.sweep.summary.summary_of_part",
}
"""Names of version 0.1 that did not go where their module went, or are called otherwise now."""


class _MovedModule(types.ModuleType):
    """A module that looks every name up where its contents stand now."""

    def __init__(self, old: str, new: str) -> None:
        super().__init__(old, f"Moved to `{new}`.")
        self.__path__: list[str] = []
        self.__dict__["_new"] = new

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        target = RENAMED.get(f"{self.__name__}.{name}", f"{self.__dict__['_new']}.{name}")
        new, _, new_name = target.rpartition(".")
        # importlib, because a name in `cyclosweep` may be a function and a module at once.
        value = getattr(importlib.import_module(new), new_name)
        use = new if new_name == name else target
        warnings.warn(f"{self.__name__} has moved: use {use}", DeprecationWarning, stacklevel=2)
        return value


def register() -> None:
    """Make the old names importable.

    They are put into `sys.modules` rather than found on import, because an import that finds a
    module also sets it as attribute of the package, over functions such as `cyclosweep.scan`.
    """
    for old, new in MOVED.items():
        sys.modules.setdefault(old, _MovedModule(old, new))
    # `python -m` looks for the file to run through the module's specification.
    command = sys.modules["cyclosweep.challenge.record"]
    command.__spec__ = ModuleSpec(command.__name__, None, is_package=True)
    command.__path__ = [str(Path(__file__).parents[1] / "cyclosweep_challenge" / "record")]
