"""Readings that stand at an end of their range while the other reading goes on."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.recording.checks import MIN_SAMPLES
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
"""Share of the samples without which a recording is none any more."""
SECOND_DIFFERENCE = 0.6745 * 6.0**0.5
"""Median magnitude of the second differences of white noise, over its standard deviation."""


@dataclass(frozen=True, eq=False)
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
    angle goes on and comes back: creep at a constant load never comes back. Where the angle only
    goes far while the torque stands, its sensor may be saturated; nothing is left out then.

    Parameters
    ----------
    recording : Samples
        The samples that count, all of them finite.

    Returns
    -------
    faults : list of Fault
        ``DATA_FAULT`` where more than `MOST` of the samples are lost, or all but a few of one load.
    lost : ndarray of bool, shape (n,)
        Samples of a reading that is saturated for certain, and those after a saturated torque in
        which friction still remembers a load that was not read.

    Notes
    -----
    Friction that takes up more than what the sensor cuts off keeps the angle from coming back: the
    torque is then only suspected, or not noticed.
    """
    lost = np.zeros(len(recording), dtype=np.bool_)
    torque, angle = recording.torque_nm, recording.angle_deg
    if angle is None or len(torque) < FEWEST_PINNED or not np.ptp(torque) or not np.ptp(angle):
        return [], lost
    said: list[tuple[str, str, list[_Pinned], bool]] = []
    for name, values, other, unit in (
        ("angle", angle, torque, "deg"),
        ("torque", torque, angle, "N m"),
    ):
        ends = [_pinned(values, other, recording.run, upper) for upper in (False, True)]
        ends = [end for end in ends if np.count_nonzero(end.rows) >= FEWEST_PINNED]
        if name == "angle":
            certain = [end for end in ends if _stops_on_loading(angle, torque, end)]
            suspected = list[_Pinned]()  # while the load falls, friction holds the angle
        else:
            loaded = ON_LOADING * float(np.abs(torque).max())
            ends = [end for end in ends if abs(end.level) > loaded]
            certain = [end for end in ends if _goes_there_and_back(recording, angle, end)]
            suspected = [end for end in ends if end.moved > MOVED and end not in certain]
        for end in certain:
            lost |= end.rows
            if name == "torque":
                lost |= _remembering(angle, recording.run, end)
        said += [(name, unit, some, some is certain) for some in (certain, suspected) if some]
    left = ~lost
    useless = bool(
        np.mean(lost) > MOST
        or np.count_nonzero(left) < MIN_SAMPLES
        or not np.ptp(torque[left])
        or not np.ptp(angle[left])
    )
    return [_fault(name, unit, ends, sure, useless) for name, unit, ends, sure in said], lost


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


def _fault(name: str, unit: str, ends: list[_Pinned], certain: bool, useless: bool) -> Fault:
    """Say that a reading is, or may be, saturated.

    Parameters
    ----------
    name, unit : str
        The reading and its unit.
    ends : list of _Pinned
        One or both ends of its range.
    certain : bool
        Whether it is saturated for certain.
    useless : bool
        Whether too little is left without the samples that are lost.

    Returns
    -------
    Fault
    """
    share = sum(float(np.mean(end.rows)) for end in ends)
    levels = " and ".join(f"{end.level:g}" for end in ends)
    seen = (
        f"The {name} stands at the {'ends' if len(ends) > 1 else 'end'} of its readings, {levels} "
        f"{unit}, for {100 * share:.3g} % of the samples while the other reading goes over "
        f"{100 * max(end.moved for end in ends):.3g} % of its range: "
    )
    if not certain:
        return Fault("saturation_suspected", None, f"{seen}the sensor may be saturated.")
    then = "too little is left without them." if useless else "these samples do not count."
    verdict: FaultVerdict | None = "DATA_FAULT" if useless else None
    return Fault("saturation", verdict, f"{seen}the sensor is saturated, and {then}")


def _of_a_step(values: Floats, other: Floats, end: _Pinned) -> float:
    """How far one reading goes over the last step of another at an end of its range.

    Parameters
    ----------
    values, other : ndarray, shape (n,)
        The reading that has the step, and the one that goes on.
    end : _Pinned
        Which end.

    Returns
    -------
    float
        In the other reading's unit.
    """
    levels = np.unique(values)
    last = levels[-2:] if end.upper else levels[:2]
    return float(np.ptp(last) / np.ptp(values) * np.ptp(other))


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
    of_a_step = _of_a_step(angle, torque, end)
    load = np.maximum(torque if end.upper else -torque, 0.0)
    least = max(ON_LOADING * float(load.max()), STEPS * of_a_step)
    return max(float(load[part].max() - load[part[0]]) for part in end.stretches) > least


def _goes_there_and_back(recording: Samples, angle: Floats, end: _Pinned) -> bool:
    """Whether the angle goes on and comes back while a torque stands at the end of its range.

    Within a step of the torque's own resolution it does so at every turn.

    Parameters
    ----------
    recording : Samples
        With the reading that may be saturated.
    angle : ndarray, shape (n,)
        The other reading [deg].
    end : _Pinned
        Samples at one end of the torque's range.

    Returns
    -------
    bool
    """
    torque, run = recording.torque_nm, recording.run
    of_a_step = _of_a_step(torque, angle, end)
    outward = angle if end.upper else -angle
    scatter = float(np.median(np.abs(np.diff(angle, 2)))) / SECOND_DIFFERENCE
    step = float(np.diff(np.unique(angle)).min())
    run_starts = np.flatnonzero(np.r_[True, np.diff(run) != 0])
    far = []
    for part in end.stretches:
        count, start = len(part), int(np.searchsorted(run_starts, part[0], "right"))
        rising = min(count, int(part[0] - run_starts[start - 1]))
        if min(count, rising) < FEWEST_PINNED:
            continue
        third = count // 3
        ends = max(float(outward[part[:third]].mean()), float(outward[part[-third:]].mean()))
        height = float(outward[part[third:-third]].mean()) - ends
        approach = float(outward[part[0]] - outward[part[0] - rising]) * count / rising
        noise = max(STEPS * scatter / np.sqrt(third), step, of_a_step)
        far.append(height if height > max(noise, GOES_ON * approach) else 0.0)
    return bool(far) and float(np.median(far)) > THERE_AND_BACK * float(np.ptp(angle))


def _remembering(angle: Floats, run: Ints, end: _Pinned) -> Flags:
    """Samples after a saturated torque until the angle is back where the torque came to stand.

    There friction has turned around; before, it still remembers the load that was not read.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        The other reading [deg].
    run : ndarray of int, shape (n,)
        Trial each sample belongs to.
    end : _Pinned
        Samples at one end of the torque's range.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    outward = angle if end.upper else -angle
    found = np.zeros(len(angle), dtype=np.bool_)
    for part in end.stretches:
        after = np.arange(part[-1] + 1, len(angle))
        after = after[run[after] == run[part[0]]]
        back = np.flatnonzero(outward[after] <= outward[part[0]])
        found[after[: back[0] if len(back) else len(after)]] = True
    return found
