"""Parts that begin to act at loads scattered about a mean, as by a logistic distribution."""

import numpy as np

from cyclosweep.simulation.effects.history import Floats


def acting_beyond(load_nm: Floats, middle_nm: float, spread: float) -> Floats:
    """Load that parts carry which begin to act about a mean load, zero without load [N m].

    Parameters
    ----------
    load_nm : ndarray, shape (n,)
        Magnitude of the torque [N m].
    middle_nm : float
        Mean of the loads at which they begin [N m].
    spread : float
        Logistic scale of these loads over their mean.

    Returns
    -------
    ndarray, shape (n,)
        ``w (log(1 + exp((|T| - T1)/w)) - log(1 + exp(-T1/w)))`` with ``w`` the spread times ``T1``.
    """
    width = max(spread * middle_nm, 1e-9)
    begun = np.logaddexp(0.0, (load_nm - middle_nm) / width)
    return np.asarray(width * (begun - np.logaddexp(0.0, -1.0 / spread)))
