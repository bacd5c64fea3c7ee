"""Remark on loops at one rate of the torque, where what comes late looks like friction."""

from collections.abc import Collection

import numpy as np

from cyclosweep.recording import Recording
from cyclosweep.simulation.effects import effects
from cyclosweep.simulation.effects.creep import Creep
from cyclosweep.simulation.effects.viscous_drag import ViscousDrag

LATE = (Creep, ViscousDrag)
"""Effects whose loop is nearly that of friction at one rate."""
FAR_APART = 1.5
"""Quick over slow rates of the torque up to which they are one rate."""
HELD = 0.1
"""Rate over the usual one below which the torque is held."""
MOST_HELD = 0.02
"""Share of the time for which it may be held: while it is, creep goes on, and friction does not."""


def remark_on_one_rate(recording: Recording, named: Collection[str]) -> tuple[str, ...]:
    """Say that friction may stand behind creep or drag, where all loops were at one rate.

    Parameters
    ----------
    recording : Recording
    named : collection of str
        Names of the effects that were found.

    Returns
    -------
    tuple of str
        One remark; none where friction was found, too, or the rates tell them apart.
    """
    late = [effect.name for effect in LATE if effect.name in named]
    frictions = {each.name for each in effects() if each.slips}
    if not late or frictions & set(named) or not is_of_one_rate(recording):
        return ()
    return (
        f"{late[0]} and friction make nearly the same loop where the torque moves at one rate, as "
        "here: the name rests on the form of the loop alone. Repeat the loop at a tenth of the "
        "rate, or hold the torque on the way, before you rely on it.",
    )


def is_of_one_rate(recording: Recording) -> bool:
    """Whether the torque moved to and fro at one rate, without holds.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    bool
        False without a clock.
    """
    torque, time, run = recording.torque_nm, recording.time_s, recording.run
    if time is None:
        return False
    step = np.diff(time)
    known = step > 0
    if run is not None:
        known &= np.diff(run) == 0
    if not np.any(known):
        return False
    step, rate = step[known], np.abs(np.diff(torque)[known] / step[known])
    usual = float(np.median(rate))
    held = rate < HELD * usual
    if usual <= 0.0 or float(np.sum(step[held])) > MOST_HELD * float(np.sum(step)):
        return False
    slow, quick = np.quantile(rate[~held], [0.05, 0.95])
    return bool(quick < FAR_APART * slow)
