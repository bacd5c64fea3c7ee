"""What a model predicts for a load history: the published line with any set of effects."""
