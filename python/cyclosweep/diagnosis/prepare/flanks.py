"""The flank in contact and the dead zone, read off a recording by a robust line."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cyclosweep.simulation.effects.history import Flags, Floats

LOADED = 0.25
"""Share of the largest torque beyond which a flank is taken to be in contact."""


class NominalLine(Protocol):
    """Free play [deg] each side of zero and slope [deg/(N m)] of the published model."""

    @property
    def free_play_deg(self) -> float: ...  # noqa: D102

    @property
    def compliance_deg_per_nm(self) -> float: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class Flanks:
    """Line through the loaded readings, and where it puts the dead zone.

    Attributes
    ----------
    datum_deg, compliance_deg_per_nm, free_play_deg : float
        The line [deg], [deg/(N m)], [deg]; the free play is zero where none was seen.
    loop_width_deg : float
        Rough width of the hysteresis loop [deg].
    loaded_nm : float
        Torque beyond which a flank is in contact whatever the angle says [N m].
    loaded_scored_nm : float
        The same by the largest torque of the readings that are scored [N m].
    """

    datum_deg: float
    compliance_deg_per_nm: float
    free_play_deg: float
    loop_width_deg: float
    loaded_nm: float
    loaded_scored_nm: float

    def at(
        self, torque: Floats, angle: Floats, scored: Flags | None = None
    ) -> tuple[Floats, Flags]:
        """Flank of every reading, and whether it is in contact.

        Parameters
        ----------
        torque, angle : ndarray, shape (n,)
            Torque [N m] and twist [deg].
        scored : ndarray of bool, shape (n,), optional
            Readings that are scored; default: all.

        Returns
        -------
        side : ndarray, shape (n,)
            +1 or -1.
        contact : ndarray of bool, shape (n,)
        """
        sign = np.where(torque >= 0, 1.0, -1.0)
        play = self.free_play_deg
        if play <= 0:
            return sign, np.ones(len(torque), dtype=bool)
        loaded = np.abs(torque) > self.loaded_nm
        if scored is not None:
            loaded = (np.abs(torque) > self.loaded_scored_nm) & scored
        inside = angle - self.datum_deg - self.compliance_deg_per_nm * torque
        side = np.where(inside >= 0, 1.0, -1.0)
        side[loaded] = sign[loaded]
        if scored is not None:
            far = np.abs(torque) > self.loaded_scored_nm
            side[far] = sign[far]
        margin = min(max(2.0 * self.loop_width_deg, 0.1 * play), 0.8 * play)
        return side, loaded | (inside * side > play - margin)


def find_flanks(
    torque: Floats, angle: Floats, line: NominalLine, scored: Flags | None = None
) -> Flanks:
    """Fit a robust line through the loaded rows.

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
    Flanks
    """
    from scipy.optimize import least_squares

    largest = float(np.abs(torque).max(initial=0.0))
    threshold = scored_threshold = LOADED * largest
    loaded = np.abs(torque) > threshold
    if scored is not None:
        scored_threshold = LOADED * float(np.abs(torque[scored]).max(initial=0.0))
        loaded = (np.abs(torque) > scored_threshold) & scored
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
    return Flanks(datum, compliance, max(play, 0.0), width, threshold, scored_threshold)
