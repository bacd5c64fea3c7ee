"""STLSQ and bagged STLSQ through PySINDy: sparse regression by thresholded least squares."""

from __future__ import annotations

import warnings

import numpy as np
from pysindy import STLSQ, EnsembleOptimizer

from cyclosweep_challenge.opponents.view import Regressed, Reply, effects_of

THRESHOLDS = np.geomspace(0.005, 2.0, 40)


def _prepared(view: Regressed) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Library and residual, both of unit spread."""
    table, names = view.library
    return table, (view.residual / np.std(view.residual))[:, None], names


def stlsq(view: Regressed) -> Reply:
    """STLSQ at its default threshold; its statistic is the largest threshold that keeps a term."""
    table, target, names = _prepared(view)
    largest = 0.0
    chosen = np.array([], dtype=int)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        default = STLSQ().fit(table, target).coef_[0]
        for threshold in THRESHOLDS:
            surviving = np.flatnonzero(STLSQ(threshold=threshold).fit(table, target).coef_[0])
            if surviving.size == 0:
                break
            largest, chosen = float(threshold), surviving
    picked = np.flatnonzero(default)
    return Reply(
        largest, picked.size > 0, effects_of(names, list(picked if picked.size else chosen))
    )


def bagged_stlsq(view: Regressed) -> Reply:
    """Twenty bagged fits; its statistic is the largest median coefficient."""
    table, target, names = _prepared(view)
    np.random.seed(0)  # noqa: NPY002 - PySINDy draws its bags from the global state
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        bag = EnsembleOptimizer(opt=STLSQ(threshold=0.03), bagging=True, n_models=20)
        bag.fit(table, target)
    fits = np.array(bag.coef_list)[:, 0, :]
    median = np.median(fits, axis=0)
    often = np.mean(fits != 0.0, axis=0)
    chosen = np.flatnonzero(often > 0.6)
    return Reply(float(np.abs(median).max()), chosen.size > 0, effects_of(names, list(chosen)))
