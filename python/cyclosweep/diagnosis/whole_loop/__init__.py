"""Fit of the simulation itself to whole loops, where the residual is error of the model."""
