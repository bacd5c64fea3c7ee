"""Textbook detectors of model error, run on the same files as the diagnosis."""
