"""Lost motion of small loops: the angle between their two ends."""

import numpy as np

from cyclosweep.recording import Recording

END_SHARE = 0.9
"""Share of a loop's smaller largest torque from which on a reading belongs to an end."""


def lost_motion_deg(recording: Recording) -> tuple[list[float], list[float]]:
    """Angle between the loaded ends of each run, and the torque at which they are read.

    Both ends are read at the same magnitude of torque, as the median of the readings there. For
    loops of a few per cent of the rated torque this is what the shaft moves before it takes load.

    Parameters
    ----------
    recording : Recording
        Runs that go to a small torque in both directions.

    Returns
    -------
    angles_deg : list of float
        For each run that reaches a torque in both directions [deg].
    torques_nm : list of float
        The torque of its ends, plus and minus [N m].
    """
    angles: list[float] = []
    torques: list[float] = []
    if recording.angle_deg is None:
        return angles, torques
    for run in recording.runs:
        rows = recording.run == run
        torque, angle = recording.torque_nm[rows], recording.angle_deg[rows]
        reached = min(float(torque.max()), -float(torque.min()))
        if reached <= 0:
            continue
        high, low = torque >= END_SHARE * reached, torque <= -END_SHARE * reached
        # Where one direction goes farther, only what both reach is compared.
        high &= torque <= reached / END_SHARE
        low &= torque >= -reached / END_SHARE
        if high.any() and low.any():
            angles.append(abs(float(np.median(angle[high]) - np.median(angle[low]))))
            torques.append(reached)
    return angles, torques
