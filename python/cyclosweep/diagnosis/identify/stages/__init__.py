"""One effect at a time where the noise is small: friction first, and what each stage accepts."""
