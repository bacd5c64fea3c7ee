"""From a recording to a problem that can be fitted: rows, noise, stretches to hold out."""
