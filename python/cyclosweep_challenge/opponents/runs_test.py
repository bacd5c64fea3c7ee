"""Runs test: asks whether the residual's signs change as often as by chance."""

from __future__ import annotations

import numpy as np
from scipy import stats

from cyclosweep_challenge.opponents.seen import Said, Seen


def runs_test(seen: Seen) -> Said:
    """Wald-Wolfowitz test of the residual's signs in file order; default level 1 %."""
    positive = seen.residual > 0.0
    n, m = int(positive.sum()), int((~positive).sum())
    if min(n, m) == 0:
        return Said(0.0, False, None)
    runs = 1 + int(np.sum(positive[1:] != positive[:-1]))
    total = n + m
    mean = 2.0 * n * m / total + 1.0
    variance = (mean - 1.0) * (mean - 2.0) / (total - 1.0)
    z = (mean - runs) / np.sqrt(variance)
    return Said(float(z), bool(stats.norm.sf(z) < 0.01), None)
