"""A recording in a few lines: torque, angle, runs, dwells, clock, temperature."""

from itertools import pairwise

import numpy as np

from cyclosweep.recording.checks import GAP_FACTOR, gap_count
from cyclosweep.recording.recording import Recording
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.structure import HOLD_SAMPLES

__all__ = ["facts_of"]

LEAST_DIRECTION = 0.05
"""Torque of one direction over that of the other from which the drive was loaded in both: less is
an offset of the sensor, or its noise about zero."""

DWELL_BAND = 0.02
"""Band of the torque, of its range, in which a dwell stays: noise of a sensor is less."""

DWELL_FACTOR = 5.0
"""A dwell stays in the band for so many times the samples that a ramp usually does."""


MOST_TRAVEL = 0.5
"""Most speed of the angle in a dwell, over the usual one on a ramp: creep is slower."""


def facts_of(recording: Recording) -> dict[str, str]:
    """Describe a recording that was read, one line for each thing."""
    torque = recording.torque_nm
    if not len(torque):
        return {"samples": "none"}
    facts = {"samples": f"{len(recording)} of {recording.path.name if recording.path else ''}"}
    ends = sorted((abs(min(float(torque.min()), 0.0)), max(float(torque.max()), 0.0)))
    both = ends[0] > LEAST_DIRECTION * ends[1]
    facts["torque"] = (
        f"{torque.min():.4g} to {torque.max():.4g} N m at the {recording.side} shaft, "
        f"{'both directions' if both else 'one direction'}, "
        f"{len(recording.structure.reversals)} reversals"
    )
    if recording.angle_deg is not None:
        angle = recording.angle_deg
        step = recording.angle_resolution_deg
        facts["angle"] = f"{angle.min():.4g} to {angle.max():.4g} deg, " + (
            f"steps of {step:g} deg" if step else "continuous"
        )
    facts["runs"] = _run_facts(recording)
    facts["dwells"] = _dwell_facts(recording)
    facts["clock"] = _clock_facts(recording)
    if recording.temperature_c is not None:
        warm = recording.temperature_c
        facts["temperature"] = f"{warm.min():.3g} to {warm.max():.3g} deg C"
    if recording.crank_deg is not None:
        facts["mesh positions"] = f"{len(np.unique(recording.crank_deg))}"
    return facts


def _dwell_facts(recording: Recording) -> str:
    """Number of dwells and how long they last, equal torques or torques equal but for noise."""
    spans = [(hold.start, hold.stop) for hold in recording.structure.holds]
    spans = spans or _noisy_dwells(recording.torque_nm, recording.angle_deg)
    if not spans:
        return "none"
    time = recording.time_s
    if time is None:
        return f"{len(spans)} at constant torque"
    known = [float(time[stop - 1] - time[start]) for start, stop in spans]
    return f"{len(spans)} at constant torque, {min(known):.3g} to {max(known):.3g} s"


def _noisy_dwells(torque: Floats, angle: Floats | None) -> list[tuple[int, int]]:
    """Find stretches in which the torque stays in one band for far longer than elsewhere.

    Where the angle goes on there as fast as elsewhere, as of a strap that hangs slack, nothing
    dwells.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque [N m].
    angle : ndarray of float, shape (n,), or None
        Angle [deg].

    Returns
    -------
    list of tuple of int
        First sample, and the one after the last.
    """
    band = DWELL_BAND * float(np.ptp(torque))
    bounds, low, high = [0], float(torque[0]), float(torque[0])
    for place, value in enumerate(torque.tolist()):
        low, high = min(low, value), max(high, value)
        if high - low > band:
            bounds.append(place)
            low = high = value
    spans = list(pairwise([*bounds, len(torque)]))
    usual = float(np.median([stop - start for start, stop in spans]))
    least = max(HOLD_SAMPLES, DWELL_FACTOR * usual)
    dwells = [
        (start, stop)
        for start, stop in spans
        if stop - start >= least and _is_level(torque[start:stop], band)
    ]
    if angle is None:
        return dwells
    speeds = {span: abs(float(angle[span[1] - 1] - angle[span[0]])) / (span[1] - span[0])
              for span in spans}  # fmt: skip
    elsewhere = [speed for span, speed in speeds.items() if span not in dwells and speed > 0]
    most = MOST_TRAVEL * float(np.median(elsewhere)) if elsewhere else np.inf
    return [span for span in dwells if speeds[span] <= most]


def _is_level(torque: Floats, band: float) -> bool:
    """Whether a stretch is level; at the crest of a wave the middle lies above the ends.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque of the stretch [N m].
    band : float
        Band in which it stays [N m].

    Returns
    -------
    bool
    """
    first, middle, last = (float(part.mean()) for part in np.array_split(torque, 3))
    return max(abs(middle - first), abs(middle - last)) < 0.2 * band


def _run_facts(recording: Recording) -> str:
    """Number of runs, their samples and torques."""
    shown = []
    for run in recording.runs[:8]:
        part = recording.torque_nm[recording.run == run]
        shown.append(f"{run} ({len(part)} samples, {part.min():.3g} to {part.max():.3g} N m)")
    more = len(recording.runs) - len(shown)
    return f"{len(recording.runs)}: " + ", ".join(shown) + (f" and {more} more" if more else "")


def _clock_facts(recording: Recording) -> str:
    """Rate, length and gaps of the clock."""
    time = recording.time_s
    if time is None or len(time) < 2:
        return "none: only the order of rows is known, effects of rate cannot be tested"
    step = np.diff(time)
    within = (np.diff(recording.run) == 0) & (step > 0)
    if not within.any():
        return "stands still" if not np.any(step < 0) else "runs backwards"
    median = float(np.median(step[within]))
    gaps = np.count_nonzero(within & (step > GAP_FACTOR * median))
    text = f"{1 / median:.4g} Hz (a sample every {median:.4g} s), {np.ptp(time):.4g} s long"
    return f"{text}, {gap_count(int(gaps))}"
