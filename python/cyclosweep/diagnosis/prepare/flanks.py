"""Which flank is in contact at every row, by a line through the loaded rows."""

from typing import Protocol

import numpy as np

from cyclosweep.simulation.effects.history import Flags, Floats


class NominalLine(Protocol):
    """Free play [deg] each side of zero and slope [deg/(N m)] of the published model."""

    @property
    def free_play_deg(self) -> float: ...  # noqa: D102

    @property
    def compliance_deg_per_nm(self) -> float: ...  # noqa: D102


def find_flanks(
    torque: Floats, angle: Floats, line: NominalLine, scored: Flags | None = None
) -> tuple[Floats, Flags, float, float, float, float]:
    """Tell the flank in contact from the dead zone, by a robust line through the loaded rows.

    Parameters
    ----------
    torque, angle : ndarray, shape (n,)
        Torque [N m] and twist [deg].
    line : NominalLine
        Line of the uncalibrated model, for what the recording does not show.
    scored : ndarray of bool, shape (n,), optional
        Rows through which the line goes; default: all.

    Returns
    -------
    side : ndarray, shape (n,)
        +1 or -1, the flank in contact.
    contact : ndarray of bool, shape (n,)
        Whether a flank is in contact.
    datum, compliance, free_play, loop_width : float
        In deg, deg/(N m), deg, deg.
    """
    from scipy.optimize import least_squares

    largest = float(np.abs(torque).max(initial=0.0))
    loaded = np.abs(torque) > 0.25 * largest
    if scored is not None:
        largest = float(np.abs(torque[scored]).max(initial=0.0))
        loaded = (np.abs(torque) > 0.25 * largest) & scored
    sign = np.where(torque >= 0, 1.0, -1.0)
    both = bool(np.any(sign[loaded] > 0) and np.any(sign[loaded] < 0))
    design = np.column_stack([np.ones_like(torque), torque, sign])[:, : 3 if both else 2]
    target = angle if both else angle - sign * line.free_play_deg
    start = np.linalg.lstsq(design[loaded], target[loaded], rcond=None)[0]
    residual = target[loaded] - design[loaded] @ start
    scale = max(1.4826 * float(np.median(np.abs(residual))), 1e-9)

    def misfit(line: Floats) -> Floats:
        return np.asarray((target[loaded] - design[loaded] @ line) / scale)

    robust = least_squares(misfit, start, loss="soft_l1").x
    datum, compliance = float(robust[0]), float(robust[1])
    if compliance <= 0 and torque @ (angle - angle.mean()) > 0:
        # Friction hides the slope where the drive hardly turns back.
        compliance = line.compliance_deg_per_nm
    play = float(robust[2]) if both else line.free_play_deg
    residual = target[loaded] - design[loaded] @ robust
    width = 2.0 * float(np.quantile(np.abs(residual), 0.9))
    inside = angle - datum - compliance * torque
    if play <= 0:
        return sign, np.ones(len(torque), dtype=bool), datum, compliance, max(play, 0.0), width
    side = np.where(inside >= 0, 1.0, -1.0)
    side[loaded] = sign[loaded]
    if scored is not None:
        far = np.abs(torque) > 0.25 * largest
        side[far] = sign[far]
    margin = min(max(2.0 * width, 0.1 * play), 0.8 * play)
    contact = loaded | (inside * side > play - margin)
    return side, contact, datum, compliance, play, width
