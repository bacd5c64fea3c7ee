"""Readings that stand at an end of their range while the other reading goes on."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.recording.faults import Fault, FaultVerdict
from cyclosweep.recording.samples import Flags, Floats, Ints, Samples

__all__ = ["find_saturation"]

FEWEST_PINNED = 5
"""Fewest samples at the end of a range from which a sensor may be saturated,"""
MOVED = 0.1
"""and the share of its range over which the other reading then goes,"""
ON_LOADING = 0.05
"""or the share of the largest torque by which the load grows while the angle stands,"""
THERE_AND_BACK = 0.01
"""or the share of its range by which the angle goes on and comes back while the torque stands,"""
GOES_ON = 0.08
"""and of its change over as many samples before, a quarter if it goes on as before and turns,"""
STEPS = 4.0
"""if it is so many times what a step of the reading's resolution takes, or its scatter."""
MOST = 0.6
"""Share of the samples above which a recording without them is none any more."""
SECOND_DIFFERENCE = 0.6745 * 6.0**0.5
"""Median magnitude of the second differences of white noise, over its standard deviation."""


@dataclass(frozen=True)
class _Pinned:
    """A reading at one end of its range.

    Attributes
    ----------
    upper : bool
        Whether it is the upper end.
    level : float
        Reading there.
    rows : ndarray of bool, shape (n,)
        Samples that stand there.
    stretches : list of ndarray of int
        Neighbouring ones of the same run.
    moved : float
        Largest share of its range over which the other reading goes within one of them.
    """

    upper: bool
    level: float
    rows: Flags
    stretches: list[Ints]
    moved: float


@np.errstate(all="ignore")
def find_saturation(recording: Samples) -> tuple[list[Fault], Flags]:
    """Find saturated readings, and the samples that say nothing because of it.

    An angle that stops while the load still grows is saturated, and so is a torque at which the
    angle goes on and comes back: creep at a constant load never comes back. Where the other
    reading only goes far, a sensor may be saturated; nothing is left out then.

    Parameters
    ----------
    recording : Samples
        The samples, all of them finite.

    Returns
    -------
    faults : list of Fault
        ``DATA_FAULT`` where more than half of the samples are lost.
    lost : ndarray of bool, shape (n,)
        Samples of a reading that is saturated for certain.
    """
    faults: list[Fault] = []
    lost = np.zeros(len(recording), dtype=np.bool_)
    torque, angle = recording.torque_nm, recording.angle_deg
    if angle is None or len(torque) < FEWEST_PINNED or not np.ptp(torque) or not np.ptp(angle):
        return faults, lost
    for name, values, other, unit in (
        ("angle", angle, torque, "deg"),
        ("torque", torque, angle, "N m"),
    ):
        goes_on = _stops_on_loading if name == "angle" else _goes_there_and_back
        certain, suspected = [], []
        for upper in (False, True):
            end = _pinned(values, other, recording.run, upper)
            if np.count_nonzero(end.rows) < FEWEST_PINNED:
                continue
            if goes_on(angle, torque, end):
                certain.append(end)
                lost |= end.rows
            elif end.moved > MOVED:
                suspected.append(end)
        if certain:
            faults.append(_fault(name, unit, certain, True))
        if suspected:
            faults.append(_fault(name, unit, suspected, False))
    return faults, lost


def _pinned(values: Floats, other: Floats, run: Ints, upper: bool) -> _Pinned:
    """Return the samples at one end of a reading's range.

    Parameters
    ----------
    values, other : ndarray, shape (n,)
        The reading and the other one.
    run : ndarray of int, shape (n,)
        Trial each sample belongs to.
    upper : bool
        Which end.

    Returns
    -------
    _Pinned
    """
    level = float(values.max() if upper else values.min())
    pinned = values == level
    rows = np.flatnonzero(pinned)
    apart = (np.diff(rows) > 1) | (np.diff(run[rows]) != 0)
    stretches = np.split(rows, np.flatnonzero(apart) + 1)
    moved = max(float(np.ptp(other[part])) for part in stretches) / float(np.ptp(other))
    return _Pinned(upper, level, pinned, stretches, moved)


def _fault(name: str, unit: str, ends: list[_Pinned], certain: bool) -> Fault:
    """Say that a reading is, or may be, saturated.

    Parameters
    ----------
    name, unit : str
        The reading and its unit.
    ends : list of _Pinned
        One or both ends of its range.
    certain : bool
        Whether it is saturated for certain.

    Returns
    -------
    Fault
    """
    share = sum(float(np.mean(end.rows)) for end in ends)
    levels = " and ".join(f"{end.level:g}" for end in ends)
    seen = (
        f"The {name} stands at the {'ends' if len(ends) > 1 else 'end'} of its readings, {levels} "
        f"{unit}, for {100 * share:.2g} % of the samples while the other reading goes over "
        f"{100 * max(end.moved for end in ends):.2g} % of its range: "
    )
    verdict: FaultVerdict | None = "DATA_FAULT" if share > MOST else None
    if certain:
        return Fault(
            "saturation", verdict, f"{seen}the sensor is saturated, and these samples do not count."
        )
    return Fault("saturation_suspected", verdict, f"{seen}the sensor may be saturated.")


def _stops_on_loading(angle: Floats, torque: Floats, end: _Pinned) -> bool:
    """Whether an angle stops at the end of its range while the load still grows.

    Friction holds the angle at its end too, but then the load falls; a coarse dial stands still
    for a step.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Reading that may be saturated [deg].
    torque : ndarray, shape (n,)
        The other one [N m].
    end : _Pinned
        Samples at one end of the angle's range.

    Returns
    -------
    bool
    """
    levels = np.unique(angle)
    last = levels[-2:] if end.upper else levels[:2]
    of_a_step = float(np.ptp(last) / np.ptp(angle) * np.ptp(torque))
    load = np.abs(torque)
    least = max(ON_LOADING * float(load.max()), STEPS * of_a_step)
    return max(float(load[part].max() - load[part[0]]) for part in end.stretches) > least


def _goes_there_and_back(angle: Floats, torque: Floats, end: _Pinned) -> bool:
    """Whether the angle goes on and comes back while a torque stands at the end of its range.

    Near no load a drive with play is free to do so.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        The other reading [deg].
    torque : ndarray, shape (n,)
        Reading that may be saturated [N m].
    end : _Pinned
        Samples at one end of the torque's range.

    Returns
    -------
    bool
    """
    if abs(end.level) < ON_LOADING * float(np.abs(torque).max()):
        return False
    outward = angle if end.upper else -angle
    scatter = float(np.median(np.abs(np.diff(angle, 2)))) / SECOND_DIFFERENCE
    step = float(np.diff(np.unique(angle)).min())
    far = []
    for part in end.stretches:
        count = len(part)
        before = part[0] - count
        if count < FEWEST_PINNED or before < 0:
            continue
        third = count // 3
        ends = max(float(outward[part[:third]].mean()), float(outward[part[-third:]].mean()))
        height = float(outward[part[third:-third]].mean()) - ends
        approach = float(outward[part[0]] - outward[before])
        noise = max(STEPS * scatter / np.sqrt(third), step)
        far.append(height if height > max(noise, GOES_ON * approach) else 0.0)
    return bool(far) and float(np.median(far)) > THERE_AND_BACK * float(np.ptp(angle))
