"""Torque-twist recordings and load programmes: reading, checking, structure."""

from cyclosweep.recording.faults import Fault
from cyclosweep.recording.metadata import Metadata
from cyclosweep.recording.recording import Recording
from cyclosweep.recording.structure import Branch, Hold, Structure

__all__ = ["Branch", "Fault", "Hold", "Metadata", "Recording", "Structure"]
