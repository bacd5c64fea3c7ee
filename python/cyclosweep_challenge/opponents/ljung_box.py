"""Ljung-Box: asks whether the residual is correlated with its own past."""

from __future__ import annotations

from statsmodels.stats.diagnostic import acorr_ljungbox

from cyclosweep_challenge.opponents.seen import Said, Seen


def ljung_box(seen: Seen) -> Said:
    """Portmanteau test over ten lags; default level 1 %."""
    result = acorr_ljungbox(seen.residual, lags=[10])
    statistic = float(result["lb_stat"].iloc[0])
    return Said(statistic, float(result["lb_pvalue"].iloc[0]) < 0.01, None)
