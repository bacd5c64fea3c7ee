"""Structures, evidence of all that may be added to them, and the search for what suffices."""
