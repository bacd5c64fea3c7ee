"""Sweep, validate and diagnose the torsional compliance of cycloidal gear drives."""

import warnings as _warnings

import cyclosweep._core as _core
from cyclosweep.dataset import scan_dataset
from cyclosweep.diagnosis import Diagnosis, diagnose
from cyclosweep.drive import Cylinder, Drive, Frustum, Keyway
from cyclosweep.errors import DesignError, InputError, SweepError
from cyclosweep.recording import Recording
from cyclosweep.reference.validation import validate
from cyclosweep.scan import kernel_evaluations, scan, sweep
from cyclosweep.shards import shard, sink
from cyclosweep.simulate import Model, simulate
from cyclosweep.space import Space, linspace
from cyclosweep.study import Objective, Study

__version__ = _core.__version__

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
