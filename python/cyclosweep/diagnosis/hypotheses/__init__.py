"""What may be missing: every effect and every unnamed shape as columns."""
