"""Sweep, validate and diagnose the torsional compliance of cycloidal gear drives."""

import warnings as _warnings

import cyclosweep._core as _core
import cyclosweep._moved as _moved
from cyclosweep.design.drive import Cylinder, Drive, Frustum, Keyway
from cyclosweep.diagnosis import Diagnosis, diagnose
from cyclosweep.errors import DesignError, InputError, SweepError
from cyclosweep.recording import Recording
from cyclosweep.reference.validation import validate
from cyclosweep.simulation.simulate import Model, simulate
from cyclosweep.sweep.dataset import scan_dataset
from cyclosweep.sweep.scan import kernel_evaluations, scan, sweep
from cyclosweep.sweep.shards import shard, sink
from cyclosweep.sweep.space import Space, linspace
from cyclosweep.sweep.study import Objective, Study

__version__ = _core.__version__
_moved.register()

if _core.DEBUG_BUILD:
    _warnings.warn(
        "cyclosweep's core is a debug build, ten times slower: maturin develop --release",
        stacklevel=2,
    )

__all__ = [
    "Cylinder",
    "DesignError",
    "Diagnosis",
    "Drive",
    "Frustum",
    "InputError",
    "Keyway",
    "Model",
    "Objective",
    "Recording",
    "Space",
    "Study",
    "SweepError",
    "__version__",
    "diagnose",
    "kernel_evaluations",
    "linspace",
    "scan",
    "scan_dataset",
    "shard",
    "simulate",
    "sink",
    "sweep",
    "validate",
]
