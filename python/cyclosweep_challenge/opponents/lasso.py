"""LassoCV: sparse regression with its penalty chosen by cross-validation."""

from __future__ import annotations

import warnings

import numpy as np
from sklearn.linear_model import LassoCV

from cyclosweep_challenge.opponents.view import Regressed, Reply, effects_of


def lasso_cv(view: Regressed) -> Reply:
    """Five-fold LassoCV on the library; its statistic is the fit's share of the variance."""
    table, names = view.library
    scale = float(np.std(view.residual))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = LassoCV(cv=5).fit(table, view.residual / scale)
    chosen = np.flatnonzero(model.coef_)
    share = float(np.var(table @ model.coef_))
    return Reply(share, chosen.size > 0, effects_of(names, list(chosen)))
