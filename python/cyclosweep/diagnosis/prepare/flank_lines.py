"""Robust lines through the readings of a recording, which tell the flanks and the play."""

import numpy as np

from cyclosweep.design.nominal_line import NominalLine
from cyclosweep.diagnosis.prepare.flanks import (
    LIGHT,
    SCATTERED,
    Flanks,
    moved_datum,
)
from cyclosweep.diagnosis.prepare.turned_play import turned_play
from cyclosweep.recording.robust import (
    robust_sigma,
    rounding_sigma,
    sigma_by_second_differences,
)
from cyclosweep.simulation.effects.history import Flags, Floats, Ints

LOADED = 0.25
"""Share of the largest torque beyond which a flank is taken to be in contact."""

LOADS_APART = 0.3
"""Range of light loads over the largest from which a line through them tells the play from the
compliance."""
FEWEST_SCATTERED = 8
"""Readings under load from which their scatter is known."""


def find_flanks(
    torque: Floats,
    angle: Floats,
    line: NominalLine,
    scored: Flags | None = None,
    resolution_deg: float = 0.0,
    run: Ints | None = None,
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
    resolution_deg : float
        Step of the angle reading [deg].
    run : ndarray of int, shape (n,), optional
        Run of each reading; where the middles of the runs differ by more than the play, the line
        goes through the readings less their run's middle. Default: all are one run.

    Returns
    -------
    Flanks
    """
    found = _through(torque, angle, line, scored, resolution_deg)
    if run is None or found.turned is not None or found.only_direction is not None:
        return found
    sign = np.where(torque >= 0, 1.0, -1.0)
    left = found.off_middle(torque, angle) - sign * found.free_play_deg
    moved = moved_datum(left, sign * found.is_loaded(torque, scored), run, 0.0)
    if not np.any(np.abs(moved) > found.free_play_deg):
        return found
    within = _through(torque, angle - moved, line, scored, resolution_deg)
    return within if np.any(np.abs(moved) > within.apart_deg) else found


def _through_light(
    design: Floats, angle: Floats, loaded: Flags, scatter: float
) -> tuple[float, float, float, float] | None:
    """Line through the light readings, where it shows a play that loaded ones do not.

    A drive that gives way under load is so soft there that the line of these readings meets the
    angle axis anywhere.

    Parameters
    ----------
    design : ndarray, shape (n, 3)
        Ones, torque [N m] and its sign; with fewer columns no play is known.
    angle : ndarray, shape (n,)
        Twist [deg].
    loaded : ndarray of bool, shape (n,)
        Readings under load.
    scatter : float
        Standard deviation of a reading [deg].

    Returns
    -------
    datum, compliance, play, width : float
        Line [deg], [deg/(N m)], [deg], and width of the loop about it [deg]; or None.
    """
    size = np.abs(design[:, 1])
    light = ~loaded & (size > LIGHT * size[~loaded].max(initial=0.0))
    if design.shape[1] < 3 or np.count_nonzero(light) < FEWEST_SCATTERED:
        return None
    one_load = np.ptp(size[light]) < LOADS_APART * size[light].max()
    if one_load or np.ptp(design[light, 2]) == 0.0:
        return None
    line = np.linalg.lstsq(design[light], angle[light], rcond=None)[0]
    datum, compliance, play = map(float, line)
    width = _width(angle[light] - design[light] @ line)
    seen = compliance > 0.0 and play > max(width, SCATTERED * scatter)
    return (datum, compliance, play, width) if seen else None


def _width(residual: Floats) -> float:
    """Rough width of a loop about a line [deg]."""
    return 2.0 * float(np.quantile(np.abs(residual), 0.9))


def _through(
    torque: Floats,
    angle: Floats,
    line: NominalLine,
    scored: Flags | None,
    resolution_deg: float,
) -> Flanks:
    """Robust line through the loaded rows; see `find_flanks`.

    Parameters
    ----------
    torque, angle : ndarray, shape (n,)
    line : NominalLine
    scored : ndarray of bool, shape (n,), or None
    resolution_deg : float

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
    scale = max(robust_sigma(residual), 1e-9)

    def misfit(values: Floats) -> Floats:
        return np.asarray((target[loaded] - design[loaded] @ values) / scale)

    robust = least_squares(misfit, start, loss="soft_l1").x
    datum, compliance = float(robust[0]), float(robust[1])
    if compliance <= 0 and torque @ (angle - angle.mean()) > 0:
        # Friction hides the slope where the drive hardly turns back.
        compliance = line.compliance_deg_per_nm
    play = float(robust[2]) if both else line.free_play_deg
    residual = target[loaded] - design[loaded] @ robust
    width = _width(residual)
    scatter = sigma_by_second_differences(residual) if len(residual) >= FEWEST_SCATTERED else 0.0
    scatter = float(np.hypot(scatter, rounding_sigma(resolution_deg)))
    light = None if play > scatter else _through_light(design, angle, loaded, scatter)
    if light is not None:
        datum, compliance, play, width = light
    turned = turned_play(compliance * torque, angle, sign * loaded)
    if turned is not None:
        datum, play = turned.datum_deg, turned.free_play_deg
    only = None if both or not np.any(loaded) else float(sign[loaded][0])
    return Flanks(
        datum_deg=datum,
        compliance_deg_per_nm=compliance,
        free_play_deg=max(play, 0.0),
        scatter_deg=scatter,
        loop_width_deg=width,
        loaded_nm=threshold,
        loaded_scored_nm=scored_threshold,
        turned=turned,
        only_direction=only,
    )
