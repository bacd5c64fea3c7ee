"""Diagnosis of a recording: where it differs, which physics is missing, and the proof."""

from cyclosweep.diagnosis.engine import diagnose
from cyclosweep.diagnosis.result import Diagnosis

__all__ = ["Diagnosis", "diagnose"]
