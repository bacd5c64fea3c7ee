"""A recording prepared for fitting: its rows, flank in contact, rows to fit and to keep."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cyclosweep.design.nominal_line import NominalLine
from cyclosweep.diagnosis.prepare.flank_lines import find_flanks
from cyclosweep.diagnosis.prepare.flanks import Flanks
from cyclosweep.diagnosis.prepare.neighbours import angle_by_neighbours
from cyclosweep.diagnosis.prepare.pieces import find_pieces
from cyclosweep.diagnosis.prepare.rows import Rows
from cyclosweep.diagnosis.prepare.thinning import MOST_ROWS, thin
from cyclosweep.diagnosis.prepare.torque_noise import torque_without_noise
from cyclosweep.diagnosis.prepare.torque_zero import TorqueZero
from cyclosweep.recording import Recording
from cyclosweep.recording.structure import REVERSAL_SHARE, turning_points
from cyclosweep.simulation.effects.history import Flags, Floats, History, Ints, runs_and_restarts

LOOPS_APART = 0.2
"""Share of the largest torque by which two loops must turn apart to be two."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A recording prepared for fitting.

    Attributes
    ----------
    recording : Recording
        What was prepared.
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
    rows : Rows
        The rows as groups of samples of the recording.
    one_sided : bool
        Only one flank was loaded: free play and datum cannot be told apart.
    loop_width_deg : float
        Rough width of the hysteresis loop, by which dead-zone rows were recognised [deg].
    resolution_deg : float
        Step of the angle reading [deg].
    torque_noise_nm : float
        Noise of the torque reading that was smoothed [N m]; zero: none that matters.
    white_noise_deg : float
        Noise of the torque that is in the twist, as that is compared with the torque as read [deg].
    nominal_compliance_deg_per_nm, nominal_free_play_deg : float
        Line of the published model, without calibration [deg/(N m)], [deg].
    one_history : bool
        Runs are taken to go on from each other although the recording does not say so.
    torque_zero : TorqueZero or None
        What the torque reads without load [N m], where that is taken off the torques of the
        history; None: zero. Those of the recording stay as they were read.
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
    rows: Rows
    one_sided: bool
    loop_width_deg: float
    resolution_deg: float
    torque_noise_nm: float
    white_noise_deg: float
    nominal_compliance_deg_per_nm: float
    nominal_free_play_deg: float
    one_history: bool = False
    torque_zero: TorqueZero | None = None

    @property
    def count(self) -> int:
        """Number of fitted rows."""
        return int(self.fitted.sum())

    @property
    def run_count(self) -> int:
        """Number of runs with fitted rows."""
        return len(np.unique(self.history.run[self.fitted]))

    @property
    def line_columns(self) -> int:
        """Number of linear parameters of the baseline: datum, compliance, maybe free play."""
        return 2 if self.one_sided else 3

    @property
    def largest_torque_nm(self) -> float:
        """Largest torque of the rows that count, fitted or held out [N m].

        Rows that do not, as where a motor was at its limit, show no torque that the rig can apply.
        """
        counts = self.whole_fitted | self.whole_held_out
        return float(np.abs(self.history.applied_nm[counts]).max(initial=0.0))

    @property
    def zero_nm(self) -> float:
        """What was taken off the torques of the history [N m]."""
        return 0.0 if self.torque_zero is None else self.torque_zero.value_nm

    @cached_property
    def has_several_loops(self) -> bool:
        """Whether the load of fitted runs turns in one direction at torques well apart.

        Loops that repeat each other, or a whole loop alone, show no more than one.
        """
        runs = np.unique(self.history.run[self.fitted])
        parts = [self.history.applied_nm[self.history.run == run] for run in runs]
        threshold = REVERSAL_SHARE * float(np.ptp(np.concatenate(parts))) if parts else 0.0
        peaks: tuple[list[float], list[float]] = ([], [])
        for part in parts:
            for turn in turning_points(part, threshold).tolist():
                peaks[int(part[turn] > part[turn - 1])].append(float(part[turn]))
        least = LOOPS_APART * self.largest_torque_nm
        return any(max(each) - min(each) > least for each in peaks if each)

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


DATUM, COMPLIANCE, FREE_PLAY = 0, 1, 2
"""Places of the baseline's linear parameters, ahead of all others; free play only where both flanks
were loaded."""


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
    recording: Recording,
    line: NominalLine,
    output_pin_count: int,
    most_rows: int = MOST_ROWS,
    mesh_ratio: float = 1.0,
    *,
    one_history: bool = False,
    torque_zero: TorqueZero | None = None,
) -> Problem:
    """Thin a long recording, find the flank in contact of every row, and what to fit.

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
    mesh_ratio : float
        Turns of the mesh zone a turn of the measured shaft.
    one_history : bool
        Runs go on from each other although the recording does not say so.
    torque_zero : TorqueZero, optional
        What the torque reads without load [N m]; default: zero.

    Returns
    -------
    Problem
    """
    assert recording.angle_deg is not None
    rows = thin(recording, line, most_rows)
    first = rows.first
    torque, angle = rows.mean(recording.torque_nm), rows.mean(recording.angle_deg)
    if torque_zero is not None:
        torque = torque - torque_zero.value_nm
    time = None if recording.time_s is None else rows.mean(recording.time_s)
    warm = None if recording.temperature_c is None else rows.mean(recording.temperature_c)
    run_label = recording.run[first]
    run, restart = runs_and_restarts(
        run_label, one_history=one_history or recording.history == "continuous"
    )
    counts = recording.counts[first] & rows.full
    scored = None if recording.unscored is None else ~recording.unscored[first]
    step = recording.angle_resolution_deg
    flanks = find_flanks(torque, angle, line, scored, step, run)
    piece = find_pieces(recording, at_zero=False).of_sample[first]
    off_lines = _off_lines(flanks, torque, angle, run)
    smooth = torque_without_noise(torque, piece, flanks.compliance_deg_per_nm, off_lines, time, run)
    torque, angle = smooth.torque_nm, angle - smooth.twist_deg
    side, contact = flanks.at(torque, angle, scored, run)
    # Of a load within its noise nobody can say that it holds the shaft against a flank.
    contact &= (np.abs(torque) >= smooth.noise_nm) | (flanks.free_play_deg <= flanks.scatter_deg)
    datum, compliance = flanks.datum_deg, flanks.compliance_deg_per_nm
    play = flanks.free_play_deg
    if rows.on_one_flank is not None:
        contact &= rows.on_one_flank
    # No torque tells at which angle the shaft stands within a play through which it was turned, nor
    # where it stood before it first touched a flank.
    turned = flanks.turned is not None
    predicted = counts & (contact if turned else _since_first_contact(contact, restart))
    kept = np.isin(run_label, list(recording.holdout_runs))
    known = contact & counts if smooth.uncertain is None else contact & counts & ~smooth.uncertain
    held, fitted = known & kept, known & ~kept
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
        crank_deg=None if recording.crank_deg is None else rows.mean_angle(recording.crank_deg),
        temperature_c=warm,
        output_pin_count=output_pin_count,
        mesh_ratio=mesh_ratio,
        resets_datum=recording.reset_between_runs,
    )
    moves = np.diff(run) + np.abs(np.diff(side)) + np.abs(np.diff(history.sense)) != 0
    piece = np.cumsum(np.r_[False, moves]).astype(np.int64)
    history = history.with_state(measured_deg=angle_by_neighbours(angle, piece))
    one_sided = bool(np.all(side[fitted] > 0) or np.all(side[fitted] < 0))
    return Problem(
        recording=recording,
        history=history,
        one_history=one_history,
        torque_zero=torque_zero,
        angle_deg=angle,
        weight=rows.samples,
        fitted=fitted,
        held_out=held,
        whole_fitted=predicted & ~kept,
        whole_held_out=predicted & kept,
        gap=gaps(fitted, run, time),
        rows=rows,
        one_sided=one_sided,
        loop_width_deg=flanks.loop_width_deg,
        resolution_deg=recording.angle_resolution_deg,
        torque_noise_nm=smooth.noise_nm,
        white_noise_deg=smooth.noise_of_twist_deg,
        nominal_compliance_deg_per_nm=line.compliance_deg_per_nm,
        nominal_free_play_deg=line.free_play_deg,
    )


def _since_first_contact(contact: Flags, restart: Flags) -> Flags:
    """Rows from the first one in contact on, of each stretch that begins with a restart.

    Parameters
    ----------
    contact : ndarray of bool, shape (n,)
        Rows in contact with a flank.
    restart : ndarray of bool, shape (n,)
        Rows before which nothing is known of the state; the first one among them.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    so_far = np.cumsum(contact)
    begin = np.flatnonzero(restart)
    before: Ints = (so_far - contact)[begin]
    return np.asarray(so_far > before[np.cumsum(restart) - 1])


def _off_lines(flanks: Flanks, torque_nm: Floats, angle_deg: Floats, run: Ints) -> Floats:
    """What straight lines on both flanks leave of the twist [deg].

    Parameters
    ----------
    flanks : Flanks
        The lines.
    torque_nm, angle_deg : ndarray, shape (n,)
        Torque [N m] and twist [deg].
    run : ndarray of int, shape (n,)
        Run of each reading.

    Returns
    -------
    ndarray, shape (n,)
        Zero of readings within the play.
    """
    side, contact = flanks.at(torque_nm, angle_deg, run=run)
    line = flanks.datum_deg + side * flanks.free_play_deg
    line = line + flanks.compliance_deg_per_nm * torque_nm
    return np.where(contact, angle_deg - line, 0.0)


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
