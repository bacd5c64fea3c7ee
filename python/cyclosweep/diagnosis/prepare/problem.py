"""A recording prepared for fitting: averaged rows, flank in contact, rows to fit and to keep."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.prepare.flanks import NominalLine, find_flanks
from cyclosweep.recording import Recording
from cyclosweep.simulation.effects.history import Flags, Floats, History

MOST_ROWS = 6000
"""Longer recordings are averaged over neighbours of one branch down to about this many rows."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A recording prepared for fitting.

    Attributes
    ----------
    history : History
        All rows, in order, with the state of the uncalibrated model.
    angle_deg : ndarray, shape (n,)
        Measured twist [deg].
    weight : ndarray, shape (n,)
        Number of samples averaged in each row.
    fitted, held_out : ndarray of bool, shape (n,)
        Rows in contact that are fitted, and those kept for the verdict.
    whole_fitted, whole_held_out : ndarray of bool, shape (n,)
        The same with the crossings of the dead zone, for models that predict them.
    gap : ndarray, shape (n,)
        Steps since the fitted row before; zero where there is none nearby.
    rows : ndarray of int
        Row to which each sample of the recording went.
    one_sided : bool
        Only one flank was loaded: free play and datum cannot be told apart.
    loop_width_deg : float
        Rough width of the hysteresis loop, by which dead-zone rows were recognised [deg].
    resolution_deg : float
        Step of the angle reading [deg].
    """

    recording: Recording
    history: History
    angle_deg: Floats
    weight: Floats
    fitted: Flags
    held_out: Flags
    whole_fitted: Flags
    whole_held_out: Flags
    gap: Floats
    rows: np.ndarray
    one_sided: bool
    loop_width_deg: float
    resolution_deg: float
    nominal_compliance: float
    nominal_free_play: float

    @property
    def count(self) -> int:
        """Number of fitted rows."""
        return int(self.fitted.sum())

    @property
    def line_columns(self) -> int:
        """Number of linear parameters of the baseline: datum, compliance, maybe free play."""
        return 2 if self.one_sided else 3

    def rms_error(self, angle_deg: Floats, rows: Flags) -> float:
        """Root mean square of measured less modelled twist; NaN without rows [deg].

        Parameters
        ----------
        angle_deg : ndarray, shape (n,)
            Modelled twist of all rows [deg].
        rows : ndarray of bool, shape (n,)
            Rows that count, each with the samples averaged in it.

        Returns
        -------
        float
            In deg.
        """
        difference = (self.angle_deg - angle_deg)[rows]
        if not len(difference):
            return float("nan")
        return float(np.sqrt(np.average(difference**2, weights=self.weight[rows])))


def line_design(history: History, torque_nm: Floats, *, one_sided: bool) -> Floats:
    """Columns of the baseline's linear parameters: datum, compliance and free play.

    Parameters
    ----------
    history : History
    torque_nm : ndarray, shape (n,)
        Torque that twists the drive [N m].
    one_sided : bool
        Only one flank was loaded: free play has no column.

    Returns
    -------
    ndarray, shape (n, 2 or 3)
    """
    parts = [np.ones(len(history)), torque_nm]
    if not one_sided:
        parts.append(history.side)
    return np.column_stack(parts)


def prepare(
    recording: Recording, line: NominalLine, output_pin_count: int, most_rows: int = MOST_ROWS
) -> Problem:
    """Average a long recording, find the flank in contact of every row, and what to fit.

    Parameters
    ----------
    recording : Recording
        With an angle.
    line : NominalLine
        Free play [deg] and compliance [deg/(N m)] of the drive at the recorded shaft.
    output_pin_count : int
        Number of output pins of the drive.
    most_rows : int
        About the largest number of rows.

    Returns
    -------
    Problem
    """
    assert recording.angle_deg is not None
    rows = _rows(recording, most_rows)
    count = int(rows[-1]) + 1
    weight = np.bincount(rows, minlength=count).astype(np.float64)

    def mean(values: Floats | None) -> Floats | None:
        return None if values is None else np.bincount(rows, values, count) / weight

    first = np.flatnonzero(np.r_[True, np.diff(rows) != 0])
    run_label = recording.run[first]
    torque, angle = mean(recording.torque_nm), mean(recording.angle_deg)
    assert torque is not None
    assert angle is not None
    crank = None if recording.crank_deg is None else recording.crank_deg[first]
    run = np.cumsum(np.r_[False, np.diff(run_label) != 0]).astype(np.int64)
    restart = np.r_[True, np.diff(run) != 0]
    if recording.history == "continuous":
        restart = np.arange(count) == 0
    counts = recording.counts[first]
    scored = None if recording.unscored is None else ~recording.unscored[first]
    side, contact, datum, compliance, play, width = find_flanks(torque, angle, line, scored)
    kept = np.isin(run_label, list(recording.holdout_runs))
    held = kept & contact & counts
    fitted = contact & counts & ~kept
    time = mean(recording.time_s)
    history = History(
        applied_nm=torque,
        elastic_nm=torque,
        angle_deg=datum + side * play + compliance * torque,
        side=side,
        run=run,
        restart=restart,
        compliance_deg_per_nm=compliance,
        free_play_deg=play,
        datum_deg=datum,
        time_s=time,
        crank_deg=crank,
        temperature_c=mean(recording.temperature_c),
        output_pin_count=output_pin_count,
        resets_datum=recording.reset_between_runs,
    )
    one_sided = bool(np.all(side[fitted] > 0) or np.all(side[fitted] < 0))
    return Problem(
        recording=recording,
        history=history,
        angle_deg=angle,
        weight=weight,
        fitted=fitted,
        held_out=held,
        whole_fitted=counts & ~kept,
        whole_held_out=counts & kept,
        gap=gaps(fitted, run, time),
        rows=rows,
        one_sided=one_sided,
        loop_width_deg=width,
        resolution_deg=recording.angle_resolution_deg,
        nominal_compliance=line.compliance_deg_per_nm,
        nominal_free_play=line.free_play_deg,
    )


def _rows(recording: Recording, most_rows: int) -> np.ndarray:
    """Row to which each sample goes; a row never holds samples of two runs, branches or holds.

    Parameters
    ----------
    recording : Recording
    most_rows : int
        About the largest number of rows.

    Returns
    -------
    ndarray of int, shape (samples,)
    """
    n = len(recording)
    size = int(np.ceil(n / most_rows))
    if size <= 1:
        return np.arange(n)
    torque = recording.torque_nm
    cut = np.zeros(n, dtype=bool)
    cut[0] = True
    cut[[branch.start for branch in recording.structure.branches]] = True
    for hold in recording.structure.holds:
        cut[hold.start] = True
        if hold.stop < n:
            cut[hold.stop] = True
    cut[1:] |= np.diff(np.sign(torque)) != 0
    if recording.unscored is not None:
        cut[1:] |= np.diff(recording.unscored)
    start = np.maximum.accumulate(np.where(cut, np.arange(n), 0))
    return np.cumsum(cut | ((np.arange(n) - start) % size == 0)) - 1


def gaps(fitted: Flags, run: np.ndarray, time: Floats | None) -> Floats:
    """Steps between fitted rows in units of their run's usual step.

    Zero across runs and long breaks. Runs may be sampled at different rates.

    Parameters
    ----------
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.
    run : ndarray of int, shape (n,)
        Run of each row.
    time : ndarray, shape (n,), optional
        Time of each row [s]; without it the rows are counted.

    Returns
    -------
    ndarray, shape (n,)
    """
    index = np.flatnonzero(fitted)
    gap = np.zeros(len(fitted))
    if len(index) < 2:
        return gap
    step = np.diff(index).astype(np.float64)
    if time is not None:
        elapsed = np.diff(time[index])
        for number in np.unique(run[index]):
            here = (run[index][1:] == number) & (elapsed > 0)
            if np.any(here):
                step[here] = np.maximum(elapsed[here] / np.median(elapsed[here]), 0.25)
    step[np.diff(run[index]) != 0] = 0.0
    step[step > 50.0] = 0.0
    gap[index[1:]] = step
    return gap
