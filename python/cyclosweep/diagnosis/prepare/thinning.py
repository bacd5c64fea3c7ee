"""Rows of a long recording: neighbours averaged where noise hides the error, others passed over.

A recording is cut where its load history bends: at runs, reversals of the torque, dwells, changes
of its sign, breaks of the clock and moves of the mesh position; and where the twist shows that the
play is crossed. Within each piece neighbouring samples are averaged, as many as possible while the
curvature that averaging loses stays below what any test could see; what is then still too long is
thinned by passing over rows evenly. The first and the last sample of each piece stay rows of their
own, so that friction and creep are driven through the true extremes of the torque; they are not
fitted where the other rows are averages.
"""

from dataclasses import replace

import numpy as np
from scipy.ndimage import median_filter

from cyclosweep.design.nominal_line import NominalLine
from cyclosweep.diagnosis.prepare.crossings import cut_at_crossings
from cyclosweep.diagnosis.prepare.flank_lines import find_flanks
from cyclosweep.diagnosis.prepare.flanks import Flanks
from cyclosweep.diagnosis.prepare.pieces import Pieces, find_pieces
from cyclosweep.diagnosis.prepare.rows import Rows
from cyclosweep.recording import Recording
from cyclosweep.recording.robust import robust_sigma
from cyclosweep.simulation.effects.history import Flags, Floats

MOST_ROWS = 6000
"""Longer recordings are thinned to about this many rows."""
MOST_ERROR = 3.0
"""Size of the error of averaging, over the noise and summed over all rows [-].

It is the signal-to-noise ratio d of that error; a test that knows an effect beforehand needs 3.9 to
find it in nine of ten recordings, at one false alarm in a hundred. With nothing but noise the
estimate passes 3 hardly ever.
"""
LEAST_KEPT = 0.9
"""Share of the samples that has to be in full rows; blocks are made smaller until it is."""
COARSE = 0.4
"""Steps of the dial below which noise does not spread a reading, so that averages stay wrong."""
SPIKE = 5.0
"""Standard deviations beyond which a single reading does not count for the curvature."""


def thin(recording: Recording, line: NominalLine, most_rows: int = MOST_ROWS) -> Rows:
    """Choose the rows of a recording.

    Parameters
    ----------
    recording : Recording
        With an angle.
    line : NominalLine
        Free play [deg] and compliance [deg/(N m)] of the drive at the recorded shaft.
    most_rows : int
        About the largest number of rows; the pieces of the load history may ask for more.

    Returns
    -------
    Rows
        Every sample of its own where there are no more than ``most_rows``.
    """
    count = len(recording)
    if count <= most_rows:
        return Rows(np.arange(count), np.ones(count, dtype=bool))
    torque, angle = recording.torque_nm, recording.angle_deg
    assert angle is not None
    flanks = _flanks(recording, line, most_rows)
    scored = None if recording.unscored is None else ~recording.unscored
    side, contact = flanks.at(torque, angle, scored, recording.run)
    curve = angle - flanks.compliance_deg_per_nm * torque - side * flanks.free_play_deg
    curve = _without_outliers(curve)
    pieces = cut_at_crossings(find_pieces(recording), torque, angle, flanks, contact)
    side = np.where(contact, side, 0.0)
    wanted = _wanted_size(recording, curve, side, pieces, most_rows)
    for size in _sizes(wanted):
        blocks = pieces.blocks(size)
        kept = float(blocks.samples[blocks.full].sum()) / count
        error = averaging_error(curve, blocks, blocks.whole_on_one_flank(side))
        # Of the rows only some are taken in the end.
        error *= np.sqrt(min(most_rows / len(blocks), 1.0))
        if size == 1 or (kept >= LEAST_KEPT and error <= MOST_ERROR):
            break
    rows = _pass_over(blocks, pieces, most_rows)
    if rows.averaged == 1:
        return rows
    return replace(rows, on_one_flank=rows.whole_on_one_flank(side))


def _sizes(wanted: int) -> list[int]:
    """Numbers of samples to average that are tried: the wanted one, its half, third ... and one."""
    parts = np.unique(np.ceil(np.geomspace(1.0, wanted, 12)))
    return [int(np.ceil(wanted / part)) for part in parts] + [1]


def _flanks(recording: Recording, line: NominalLine, most_rows: int) -> Flanks:
    """Line through the loaded samples.

    Parameters
    ----------
    recording : Recording
    line : NominalLine
        Line of the uncalibrated model.
    most_rows : int
        Samples through which the line is fitted.

    Returns
    -------
    Flanks
    """
    torque, angle = recording.torque_nm, recording.angle_deg
    assert angle is not None
    few = slice(None, None, max(len(torque) // most_rows, 1))
    scored = None if recording.unscored is None else ~recording.unscored[few]
    step, run = recording.angle_resolution_deg, recording.run[few]
    return find_flanks(torque[few], angle[few], line, scored, step, run)


def _without_outliers(curve: Floats) -> Floats:
    """What a straight line leaves of the twist, shape (samples,) [deg], without single outliers."""
    smooth = median_filter(curve, 5)
    apart = curve - smooth
    most = SPIKE * robust_sigma(apart)
    return np.where(np.abs(apart) > most, smooth, curve)


def _wanted_size(
    recording: Recording, curve: Floats, side: Floats, pieces: Pieces, most_rows: int
) -> int:
    """Samples to be averaged for the wanted number of rows; one where the dial is too coarse.

    Parameters
    ----------
    recording : Recording
    curve : ndarray, shape (samples,)
        What a straight line leaves of the twist [deg].
    side : ndarray, shape (samples,)
        +1 or -1; zero where no flank is in contact.
    pieces : Pieces
    most_rows : int
        About the largest number of rows.

    Returns
    -------
    int
    """
    resolution = recording.angle_resolution_deg
    if resolution > 0:
        near = (np.diff(pieces.of_sample) == 0) & (side[1:] * side[:-1] > 0)
        step = np.diff(curve)[near]
        spread = robust_sigma(step - np.median(step)) if len(step) else 0.0
        if spread < np.sqrt(2.0) * COARSE * resolution:
            return 1
    ends = 2 * int(np.count_nonzero(~pieces.dwell))
    return int(np.ceil((len(recording) - ends) / max(most_rows - ends, most_rows // 2)))


def averaging_error(curve: Floats, blocks: Rows, usable: Flags) -> float:
    """Error that averaging makes where the twist is curved, over its noise, summed over all rows.

    A curve whose second difference from row to row is b differs by b / 12 in the mean of a row from
    its value at the row's middle. The second differences hold noise as well, whose size is known
    from their median: curvature, which sits behind reversals, adds to their squares and hardly to
    their median.

    Parameters
    ----------
    curve : ndarray, shape (samples,)
        What a straight line leaves of the twist [deg].
    blocks : Rows
        Rows of which the error is wanted.
    usable : ndarray of bool, shape (n,)
        Rows in contact with one flank.

    Returns
    -------
    float
        Root of the sum of squares [-]; zero where noise alone explains the second differences.
    """
    row = blocks.mean(curve)
    good = usable & blocks.full
    side = good[1:-1] & good[:-2] & good[2:]
    bend = (row[1:-1] - 0.5 * (row[:-2] + row[2:]))[side]
    if not len(bend):
        return 0.0
    noise = robust_sigma(bend)
    square = float(bend @ bend)
    if square <= 0.0:
        return 0.0
    if noise <= 0.0:
        return np.inf
    # Three halves: variance of a second difference b of independent rows over that of a row.
    excess = 1.5 * (square / noise**2 - len(bend)) / 12.0**2
    return float(np.sqrt(max(excess, 0.0)))


def _pass_over(blocks: Rows, pieces: Pieces, most_rows: int) -> Rows:
    """Take every second, third ... row of each piece, until there are few enough.

    Parameters
    ----------
    blocks : Rows
    pieces : Pieces
    most_rows : int
        About the largest number of rows.

    Returns
    -------
    Rows
        At least one row of each piece is kept, and its ends where they are extremes.
    """
    piece = pieces.of_sample[blocks.first]
    start = np.flatnonzero(np.r_[True, np.diff(piece) != 0])
    stop = np.r_[start[1:], len(piece)]
    place = np.arange(len(piece)) - start[piece]
    last = stop[piece] - start[piece] - 1
    ends = ((place == 0) | (place == last)) & ~pieces.dwell[piece]
    room = max(most_rows - int(ends.sum()), most_rows // 2)
    # Lengths of blocks are rounded, piece by piece.
    every = int(np.ceil((len(piece) - int(ends.sum())) / (1.1 * room)))
    if every <= 1:
        return blocks
    # Pieces start at different places, so that all distances from a reversal are seen.
    lead = np.where(pieces.dwell[piece], 0, 1)
    shift = np.minimum(piece % every, np.maximum(last - 2 * lead, 0))
    kept = ends | ((place - lead - shift) % every == 0)
    full = blocks.full.copy()
    if blocks.averaged == 1:
        full[ends & (last > 2 * every)] = False
    number = np.where(kept, np.cumsum(kept) - 1, -1)
    return Rows(number[blocks.row], full[kept], blocks.averaged, every)
