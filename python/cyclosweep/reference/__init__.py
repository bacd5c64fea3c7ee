"""The 87:1 reference case: its data with provenance, and what a validation makes of it."""
