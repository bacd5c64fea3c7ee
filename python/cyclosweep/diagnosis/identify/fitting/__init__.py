"""Fits of a structure, the calibrated model with a set of terms, to the rows in contact."""
