"""Checks of a recording that was read: clock, gaps, range, duplicates, sample size."""

from collections.abc import Mapping, Sequence

import numpy as np

from cyclosweep.recording.faults import Fault
from cyclosweep.recording.samples import Floats, Samples

MIN_SAMPLES = 8
"""Fewest samples from which stiffness, free play, datum and a scatter can be estimated."""

ABSURD = 1e10
"""Magnitude that no reading has, in any of the units."""

GAP_FACTOR = 20.0
"""A step of the clock beyond so many median steps is a gap."""

ANEW = 0.02
"""Share of the clock's range from its first reading up to which it has started anew."""

UNRELATED = 0.05
"""Correlation up to which an angle does not follow the torque."""

SMALLEST_TORQUE_NM = 1e-12
"""Largest torque up to which a recording is empty: no sensor reads less."""


@np.errstate(all="ignore")
def find_faults(
    recording: Samples,
    *,
    conditioning_runs: Sequence[int] = (),
    holdout_runs: Sequence[int] = (),
) -> tuple[Fault, ...]:
    """Find everything that is wrong with samples, worst first.

    Parameters
    ----------
    recording : Samples
        The samples, all of them finite.
    conditioning_runs, holdout_runs : sequence of int
        Runs that the metadata name; each should have samples.

    Returns
    -------
    tuple of Fault
        Contradictions first, then shortage, then what forces no verdict.
    """
    if absurd := _absurd(recording):
        return absurd
    named = {"conditioning_runs": conditioning_runs, "holdout_runs": holdout_runs}
    faults = [
        *_sample_size(recording),
        *_split_runs(recording),
        *_absent_runs(recording, named),
        *_clock(recording),
        *_range(recording),
        *_relation(recording),
    ]
    order = {"DATA_FAULT": 0, "INSUFFICIENT_DATA": 1, None: 2}
    return tuple(sorted(faults, key=lambda fault: order[fault.verdict]))


def _absurd(recording: Samples) -> tuple[Fault, ...]:
    """Refuse numbers that no torque, angle or clock has."""
    signals = (
        ("torque", "torque_nm", "N m"), ("angle", "angle_deg", "deg"), ("clock", "time_s", "s"),
    )  # fmt: skip
    for word, name, unit in signals:
        values = getattr(recording, name)
        largest = 0.0 if values is None else float(np.abs(values).max(initial=0.0))
        if largest > ABSURD:
            reason = f"The {word} reaches {largest:.3g} {unit}: no rig reads that."
            return (Fault("absurd_value", "DATA_FAULT", reason),)
    torque = float(np.abs(recording.torque_nm).max(initial=0.0))
    if 0.0 < torque < SMALLEST_TORQUE_NM:
        reason = f"The torque reaches only {torque:.3g} N m: no sensor reads that."
        return (Fault("absurd_value", "DATA_FAULT", reason),)
    return ()


def _sample_size(recording: Samples) -> list[Fault]:
    """Find a recording of too few samples."""
    if recording.is_program or len(recording) >= MIN_SAMPLES:
        return []
    return [
        Fault(
            "too_few_samples",
            "INSUFFICIENT_DATA",
            f"{len(recording)} samples: at least {MIN_SAMPLES} are needed to tell stiffness, free "
            "play and datum from scatter.",
        )
    ]


def _split_runs(recording: Samples) -> list[Fault]:
    """Find runs whose rows stand in two places."""
    run = recording.run
    stretches = 1 + np.count_nonzero(np.diff(run)) if len(run) else 0
    if stretches <= len(recording.runs):
        return []
    return [
        Fault(
            "run_split",
            "DATA_FAULT",
            f"{len(recording.runs)} run numbers in {stretches} separate blocks of rows: the order "
            "of events is unknown. Sort the rows as they were recorded.",
        )
    ]


def _absent_runs(recording: Samples, named: Mapping[str, Sequence[int]]) -> list[Fault]:
    """Find runs that the metadata name and that have no samples.

    Parameters
    ----------
    recording : Samples
        The samples.
    named : mapping of str to sequence of int
        Runs by the key of the metadata that names them.

    Returns
    -------
    list of Fault
        One for each key that names such a run; none forces a verdict.
    """
    faults = []
    for key, runs in named.items():
        absent = [k for k in runs if k not in recording.runs]
        if absent:
            faults.append(
                Fault("run_absent", None, f"{key} names run {absent[0]}, which has no samples.")
            )
    return faults


def _clock(recording: Samples) -> list[Fault]:
    """Find time that runs backwards within a run, ticks that repeat, and gaps."""
    time, run = recording.time_s, recording.run
    if time is None or len(time) < 2:
        return []
    faults = []
    step = np.diff(time)
    within = np.diff(run) == 0
    back = np.flatnonzero((step < 0) & within)
    if len(back):
        at = int(back[0])
        times = "once" if len(back) == 1 else f"{len(back)} times, first"
        anew = time[back + 1] - time[0] <= ANEW * np.ptp(time)
        advice = ""
        if len(back) <= len(time) // MIN_SAMPLES and anew.all():
            advice = " Where the clock starts anew with each test, number them in a column run."
        faults.append(
            Fault(
                "time_backwards",
                "DATA_FAULT",
                f"Time runs backwards {times} at sample {at + 2}, run {run[at + 1]} "
                f"({time[at]:g} s, then {time[at + 1]:g} s): the order of events is unknown."
                f"{advice}",
            )
        )
    forward = step[within & (step > 0)]
    ticks = np.count_nonzero(within & (step == 0))
    if ticks:
        faults.append(
            Fault(
                "clock_ticks",
                None,
                f"{ticks} samples share a clock tick with the one before; where they are one "
                "reading, [merge] same_time = true averages them.",
            )
        )
    if len(forward):
        gaps = within & (step > GAP_FACTOR * np.median(forward))
        if gaps.any():
            faults.append(
                Fault(
                    "gaps",
                    None,
                    f"{gap_count(int(np.count_nonzero(gaps)))} in the clock, the longest "
                    f"{step[gaps].max():g} s: what happened then is unknown.",
                )
            )
    return faults


def gap_count(count: int) -> str:
    """Say how many gaps a clock has."""
    return f"{count or 'no'} {'gap' if count == 1 else 'gaps'}"


def _range(recording: Samples) -> list[Fault]:
    """Find a constant torque or angle."""
    torque, angle = recording.torque_nm, recording.angle_deg
    if angle is None or len(torque) < 2:
        return []
    if np.ptp(torque) <= 1e-9 * np.abs(torque).max():
        return [
            Fault(
                "constant_torque",
                "INSUFFICIENT_DATA",
                f"Torque is constant at {torque[0]:g} N m: without a change of load neither "
                "stiffness nor free play can be told.",
            )
        ]
    if np.ptp(angle) <= 1e-9 * np.abs(angle).max():
        return [
            Fault(
                "constant_angle",
                "DATA_FAULT",
                f"Angle stays at {angle[0]:g} deg while torque goes from {torque.min():g} to "
                f"{torque.max():g} N m: the angle sensor did not move.",
            )
        ]
    return []


def _relation(recording: Samples) -> list[Fault]:
    """Refuse an angle that does not follow the torque at all.

    Neither in size nor in order: a single sample far off decides the one, and a long rest before
    a short load the other.
    """
    torque, angle = recording.torque_nm, recording.angle_deg
    if angle is None or len(torque) < 30 or not np.ptp(torque) or not np.ptp(angle):
        return []
    relation = float(np.corrcoef(torque, angle)[0, 1])
    in_order = float(np.corrcoef(_ranks(torque), _ranks(angle))[0, 1])
    if max(abs(relation), abs(in_order)) > UNRELATED:
        return []
    return [
        Fault(
            "unrelated",
            "DATA_FAULT",
            f"Angle does not follow torque (correlation {relation:.2f}): are these columns torque "
            "and twist of one test?",
        )
    ]


def _ranks(values: Floats) -> Floats:
    """Places of values in the order of their size, equal ones in one place."""
    return np.unique(values, return_inverse=True)[1].astype(np.float64)
