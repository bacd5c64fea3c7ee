"""Runs test: whether the residual's signs change as often as by chance."""

from __future__ import annotations

import numpy as np
from scipy import stats

from cyclosweep_challenge.opponents.view import RecordingView, Reply


def runs_test(view: RecordingView) -> Reply:
    """Wald-Wolfowitz test of the residual's signs in file order; default level 1 %."""
    positive = view.residual > 0.0
    n, m = int(positive.sum()), int((~positive).sum())
    if min(n, m) == 0:
        return Reply(0.0, False, None)
    runs = 1 + int(np.sum(positive[1:] != positive[:-1]))
    total = n + m
    mean = 2.0 * n * m / total + 1.0
    variance = (mean - 1.0) * (mean - 2.0) / (total - 1.0)
    z = (mean - runs) / np.sqrt(variance)
    return Reply(float(z), bool(stats.norm.sf(z) < 0.01), None)
