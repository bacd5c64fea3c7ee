"""One cycloidal drive: its dimensions, ratings and the units of every quantity."""
