"""Loops of a real drive as null, with terms removed and effects injected."""
