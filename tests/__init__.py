"""Tests, in four kinds: unit, property, parity, golden and validation (see CONTRIBUTING)."""
