"""Ljung-Box test: whether the residual is correlated with its own past."""

from __future__ import annotations

from statsmodels.stats.diagnostic import acorr_ljungbox

from cyclosweep_challenge.opponents.view import RecordingView, Reply


def ljung_box(view: RecordingView) -> Reply:
    """Portmanteau test over ten lags; default level 1 %."""
    result = acorr_ljungbox(view.residual, lags=[10])
    statistic = float(result["lb_stat"].iloc[0])
    return Reply(statistic, float(result["lb_pvalue"].iloc[0]) < 0.01, None)
