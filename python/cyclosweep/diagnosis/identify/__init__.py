"""Which hypotheses a recording supports: joint fits, their evidence, the verdict."""
