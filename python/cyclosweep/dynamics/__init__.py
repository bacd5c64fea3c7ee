"""Torsional dynamics: trains of inertias and springs, their modes and their transients."""

from cyclosweep.dynamics.formulas import backbone_frequency_hz, reversal_shock_factor
from cyclosweep.dynamics.modes import Modes, natural_frequencies_hz
from cyclosweep.dynamics.spring import SlipElement, TrainSpring
from cyclosweep.dynamics.train import Train
from cyclosweep.dynamics.transient import Transient

__all__ = [
    "Modes",
    "SlipElement",
    "Train",
    "TrainSpring",
    "Transient",
    "backbone_frequency_hz",
    "natural_frequencies_hz",
    "reversal_shock_factor",
]
