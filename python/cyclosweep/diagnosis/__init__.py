"""Diagnosis of a recording: where it differs, which physics is missing, and the proof."""

from cyclosweep.diagnosis.diagnose import diagnose
from cyclosweep.diagnosis.folder import Series, diagnose_folder
from cyclosweep.diagnosis.outcome import Diagnosis

__all__ = ["Diagnosis", "Series", "diagnose", "diagnose_folder"]
