"""Recordings of a drive whose torque-twist curves the component model has worked out."""
