"""Runs that follow each other without a pause although each is taken to begin afresh."""

import numpy as np

from cyclosweep.recording.recording import Recording

NEXT_READING = 3.0
"""Time from run to run over the usual one between readings, up to which there is no pause."""
USUAL_STEP = 3.0
"""Step of the torque from run to run over the 95th percentile of all steps, up to which the load
goes on."""
LARGEST_STEP = 0.1
"""The same over the range of the torque."""
UNBROKEN = (
    "Runs follow each other without a pause in clock and torque, and each is taken to begin with "
    "fresh play and friction. If the rig was not reset between them, write "
    'history = "continuous" into the recording\'s TOML file.'
)

ONE_HISTORY = (
    "Runs are taken to go on from each other, because friction or creep that does so explains "
    'clearly more. If that is right, write history = "continuous" into the recording\'s TOML file; '
    "if the rig was reset between them, reset_between_runs = true."
)


def runs_can_go_on(recording: Recording) -> bool:
    """Whether runs may go on from each other.

    Parameters
    ----------
    recording : Recording
        A recording or a programme.

    Returns
    -------
    bool
        False where the rig was reset between them, and for a clock that starts anew: it does not
        tell how long a drive was at rest.
    """
    clock = recording.time_s
    goes_on = clock is None or bool(np.all(np.diff(clock) >= 0.0))
    return goes_on and not recording.reset_between_runs


def unbroken_runs(recording: Recording) -> tuple[str, ...]:
    """Ask whether runs are one load history.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    tuple of str
        One sentence; empty where there is a pause after a run, no clock, a single run, or where
        the recording says that its runs are one history or that the rig was reset.
    """
    time, torque = recording.time_s, recording.torque_nm
    answered = recording.history == "continuous" or recording.reset_between_runs
    if answered or time is None or len(torque) < 3:
        return ()
    between = np.diff(recording.run) != 0
    lapse, step = np.diff(time), np.abs(np.diff(torque))
    usual = lapse[~between & (lapse > 0)]
    if not between.any() or not len(usual):
        return ()
    soon = (lapse > 0) & (lapse <= NEXT_READING * float(np.median(usual)))
    most = USUAL_STEP * float(np.quantile(step[~between], 0.95))
    goes_on = step <= min(most, LARGEST_STEP * float(np.ptp(torque)))
    return (UNBROKEN,) if np.all((soon & goes_on)[between]) else ()
