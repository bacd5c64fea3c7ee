"""Sweep, validate and diagnose the torsional compliance of cycloidal gear drives."""
