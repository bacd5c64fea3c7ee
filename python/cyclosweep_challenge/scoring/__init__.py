"""Figures of a challenge, each with its interval and its target."""
