"""Score of a challenge: criteria with intervals and targets, curves and tables."""
