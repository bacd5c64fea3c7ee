"""What the runs of a recording ask of its metadata: which count, shared ticks, a motor's limit."""

from typing import Any

import numpy as np

from cyclosweep.recording.choosing import Choice
from cyclosweep.recording.proposed import Proposal, values_of
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.shared_ticks import TICKS, moved_in_a_tick

__all__ = ["propose_limit", "propose_runs", "propose_ticks"]

SMALL_RUN = 0.2
"""Runs that reach less of the largest torque are tests of the play."""

NEARLY_ALL = 0.95
"""Quantile of the torque that says what a run reaches, which noise does not move."""

EQUAL = 0.1
"""Runs whose torques differ by less of the largest one repeat each other."""

LOGGED = 2000
"""Rows beyond which nobody has read them by hand."""

LONG = 1_000_000
"""Rows from which neighbours are averaged while reading."""

KEPT = 200_000
"""Means that are kept of a long recording: 30 times what a diagnosis works on."""

LIMITED = 0.95
"""Measured over commanded torque, relative to small loads, below which a motor is at its limit."""


def propose_runs(
    numbers: dict[str, Floats],
    choice: Choice,
    columns: dict[str, dict[str, Any]],
    made: Proposal,
) -> None:
    """Tell how runs follow each other, and runs that only test the play.

    Parameters
    ----------
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.
    choice : Choice
        Which of them is what.
    columns : dict
        Proposed columns.
    made : Proposal
        ``history`` and ``select`` are added to it.
    """
    named = choice.roles.get("run")
    if named is None:
        return
    run, torque = numbers[named.column], np.abs(values_of("torque_nm", columns, numbers))
    known = np.isfinite(run) & np.isfinite(torque)
    run, torque = run[known], torque[known]
    first = np.unique(run, return_index=True)[1]
    order = run[np.sort(first)]
    tops = {int(k): float(np.quantile(torque[run == k], NEARLY_ALL)) for k in order}
    largest = max(tops.values())
    small = [k for k, top in tops.items() if top < SMALL_RUN * largest]
    if small:
        made.meta["select"] = {named.column: [k for k in tops if k not in small]}
        made.remarks["select"] = (
            f"runs {', '.join(map(str, small))} reach {max(tops[k] for k in small):.3g} of "
            f"{largest:.3g} N m"
        )
    clock = choice.roles.get("time_s")
    if len(order) < 2:
        return
    if clock is None:
        made.assumed.append(
            "No clock: whether the drive was unloaded between the runs is not known, history = "
            '"per-run" is taken, and no run is proposed for conditioning or to be held out. If the '
            'runs follow each other, write history = "continuous", and of three or more equal runs '
            "conditioning_runs and holdout_runs."
        )
        return
    time = values_of("time_s", columns, numbers)[known]
    step = np.diff(time)
    between = np.diff(run) != 0
    ticks = step[~between & (step > 0)]
    if len(ticks) and (step[between] >= 0).all() and step[between].max() < 20 * np.median(ticks):
        made.meta["history"] = "continuous"
        made.remarks["history"] = "the clock goes on from run to run without a pause"
        kept = [k for k in tops if k not in small]
        if choice.commands:  # runs are equal that ask for the same, whatever the motor gave
            asked = np.abs(numbers[choice.commands[0]])[known]
            tops = {k: float(np.quantile(asked[run == k], NEARLY_ALL)) for k in tops}
            largest = max(tops.values())
        reach = [tops[k] for k in kept]
        if len(kept) >= 3 and max(reach) - min(reach) < EQUAL * largest:
            made.meta["conditioning_runs"] = kept[:1]
            made.remarks["conditioning_runs"] = "equal runs: the first settles the drive"
            made.meta["holdout_runs"] = kept[-1:]
            made.remarks["holdout_runs"] = "and the last is kept for the verdict"


def propose_ticks(numbers: dict[str, Floats], choice: Choice, made: Proposal) -> None:
    """Average rows that share a tick of the clock.

    Parameters
    ----------
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.
    choice : Choice
        Which of them is what.
    made : Proposal
        ``merge`` is added to it.
    """
    clock = choice.roles.get("time_s")
    if clock is None:
        if len(numbers[choice.roles["torque_nm"].column]) > LOGGED:
            made.assumed.append(
                "No clock: rows of one reading, if a logger wrote several, cannot be told and are "
                "not averaged; each counts as a reading of its own. Export the clock, too."
            )
        return
    step = np.diff(numbers[clock.column])
    share = float(np.mean(step == 0)) if len(step) else 0.0
    rows = len(step) + 1
    if rows > LONG:
        made.meta["merge"] = {"neighbours": -(-rows // KEPT)}
        made.remarks["merge"] = f"{rows} rows: means of neighbours, never over a reversal"
    if not TICKS < share < 1.0:  # of a clock that stands still all do, and it is left out
        return
    torque = choice.roles["torque_nm"].column
    moved = moved_in_a_tick(numbers[torque], step == 0)
    if moved is not None:
        made.assumed.append(
            f"The clock is rounded: within a tick of it {torque} moves by {moved:.3g}. Rows that "
            "share one are not averaged, but spread evenly over it."
        )
    else:
        made.meta["merge"] = {"same_time": True}  # which shortens a long recording, too
        made.remarks["merge"] = f"{share:.0%} of the rows share a clock tick with the one before"


def propose_limit(numbers: dict[str, Floats], choice: Choice, made: Proposal) -> None:
    """Find the command beyond which a motor is at its limit.

    Parameters
    ----------
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.
    choice : Choice
        Which of them is what.
    made : Proposal
        ``score`` is added to it.
    """
    torque = choice.roles["torque_nm"].column
    for command in choice.commands:
        asked, got = np.abs(numbers[command]), np.abs(numbers[torque])
        known = np.isfinite(asked) & np.isfinite(got)
        asked, got = asked[known], got[known]
        top = float(asked.max(initial=0.0))
        edges = np.linspace(0.0, top, 41)
        place = np.clip(np.digitize(asked, edges) - 1, 0, 39)
        ratio = np.array([
            np.median(got[place == k]) / max(np.median(asked[place == k]), 1e-30)
            if np.count_nonzero(place == k) > 4 else np.nan
            for k in range(40)
        ])  # fmt: skip
        small = np.nanmedian(ratio[8:20]) if np.isfinite(ratio[8:20]).any() else np.nan
        if not np.isfinite(small) or small <= 0 or not 0.5 < small < 2.0:
            continue
        short = np.nan_to_num(ratio / small, nan=0.0) < LIMITED
        if not short[-1]:
            continue
        start = 40 - int(np.argmin(short[::-1])) if not short.all() else 40
        if 10 < start < 38:
            limit = float(f"{edges[start]:.4g}")
            made.meta["score"] = {"abs_max": {command: limit}}
            made.remarks["score"] = (
                f"beyond, {torque} stays behind {command}: the motor is at its limit"
            )
            return
