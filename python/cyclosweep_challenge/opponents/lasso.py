"""LassoCV: sparse regression with its penalty chosen by cross-validation."""

from __future__ import annotations

import warnings

import numpy as np
from sklearn.linear_model import LassoCV

from cyclosweep_challenge.opponents.seen import Said, Seen, effects_of


def lasso_cv(seen: Seen) -> Said:
    """Five-fold LassoCV on the library; its statistic is the fit's share of the variance."""
    table, names = seen.library
    scale = float(np.std(seen.residual))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = LassoCV(cv=5).fit(table, seen.residual / scale)
    chosen = np.flatnonzero(model.coef_)
    share = float(np.var(table @ model.coef_))
    return Said(share, chosen.size > 0, effects_of(names, list(chosen)))
