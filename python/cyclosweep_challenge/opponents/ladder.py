"""Forward selection by held-out error alone."""

from __future__ import annotations

import numpy as np

from cyclosweep_challenge.opponents.view import RecordingView, Reply, effects_of


def error_ladder(view: RecordingView) -> Reply:
    """Relative gain in error on a random fifth held out, adding terms while it falls."""
    table, names = view.library
    rng = np.random.default_rng(0)
    order = rng.permutation(view.residual.size)
    test, train = order[: order.size // 5], order[order.size // 5 :]

    def error(columns: list[int]) -> float:
        if not columns:
            return float(np.sqrt(np.mean(view.residual[test] ** 2)))
        part = table[:, columns]
        weights = np.linalg.lstsq(part[train], view.residual[train])[0]
        return float(np.sqrt(np.mean((view.residual[test] - part[test] @ weights) ** 2)))

    chosen: list[int] = []
    plain = best = error(chosen)
    while len(chosen) < 5:
        trials = [(error([*chosen, k]), k) for k in range(len(names)) if k not in chosen]
        value, k = min(trials)
        if value >= best:
            break
        best = value
        chosen.append(k)
    return Reply(1.0 - best / plain, bool(chosen), effects_of(names, chosen))
