"""What may be missing: every effect and every shape without a name as columns."""
