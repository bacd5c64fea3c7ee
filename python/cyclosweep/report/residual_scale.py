"""How large a residual an axis has to show, where some readings lie inside the play."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MAY_BE_IN_PLAY_SHARE = 0.05
"""Share of the largest torque below which a reading may be inside the dead zone."""
FEW_BEYOND = 3.0
"""Multiple of the residual that all but one in 200 samples keep, above which the largest do not
set the scale."""


def scale_deg(torque_nm: Floats, residual_deg: Floats) -> float:
    """Largest residual that an axis has to show: not that of readings inside the dead zone.

    There the twist says nothing of the drive: a crossing that comes a moment early or late is
    wrong by the whole play.

    Parameters
    ----------
    torque_nm, residual_deg : ndarray of float, shape (n,)
        Torque [N m] and residual [deg] of the readings.
    """
    sizes, loaded = np.abs(residual_deg), np.abs(torque_nm)
    outside = loaded > MAY_BE_IN_PLAY_SHARE * loaded.max()
    shown = sizes[outside] if np.count_nonzero(outside) >= len(sizes) // 2 else sizes
    usual, largest = float(np.quantile(shown, 0.995)), float(shown.max())
    return largest if largest < FEW_BEYOND * usual else usual
