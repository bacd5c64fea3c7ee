"""Whether a repaired model holds on data not used, and what to record next."""
