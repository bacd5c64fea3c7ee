"""The component model in benchmarks."""
