"""Where a recording passes from one flank to the other, told by the twist alone."""

import numpy as np

from cyclosweep.diagnosis.prepare.flanks import Flanks
from cyclosweep.diagnosis.prepare.pieces import Pieces
from cyclosweep.simulation.effects.history import Flags, Floats


def cut_at_crossings(
    pieces: Pieces, torque: Floats, angle: Floats, flanks: Flanks, contact: Flags
) -> Pieces:
    """Cut pieces of the load history where the play is crossed.

    Friction holds the shaft on a flank beyond the torque's change of sign, so that the play is
    crossed at a torque which is not known beforehand. The twist shows it: from one flank to the
    other it changes by the play. Along a piece the torque does not turn, so that the play is
    crossed once at most; where, is told by all samples of the piece together, so that noise does
    not disturb it.

    Parameters
    ----------
    pieces : Pieces
    torque, angle : ndarray, shape (samples,)
        Torque [N m] and twist [deg].
    flanks : Flanks
        Line through the loaded samples.
    contact : ndarray of bool, shape (samples,)
        Samples in contact with a flank.

    Returns
    -------
    Pieces
        Samples on one flank, on the other, and on either half of the way between them are in pieces
        of their own.
    """
    play = flanks.free_play_deg
    if play <= 0.0:
        return pieces
    inside = angle - flanks.datum_deg - flanks.compliance_deg_per_nm * torque
    place = np.clip(inside / play, -1.0, 1.0)
    cuts = []
    for start, stop in zip(pieces.start, pieces.stop, strict=True):
        for level in (-0.5, 0.5):
            at = _passes(place[start:stop] - level)
            if 0 < at < stop - start:
                before = np.flatnonzero(contact[start : start + at])
                after = np.flatnonzero(contact[start + at : stop])
                cuts.append(start + (before[-1] + 1 if len(before) else at))
                cuts.append(start + at + (after[0] if len(after) else 0))
        middle = _passes(place[start:stop])
        if 0 < middle < stop - start:
            cuts.append(start + middle)
    return pieces.cut(np.array(cuts, dtype=np.int64))


def _passes(values: Floats) -> int:
    """First of the values, shape (n,), that are on the other side of zero than those before.

    The best cut into two parts of opposite signs is where the sum so far has its extreme. Zero or
    n where all are on one side.
    """
    total = np.r_[0.0, np.cumsum(values)]
    low, high = int(np.argmin(total)), int(np.argmax(total))
    rises = total[-1] - 2.0 * total[low] >= 2.0 * total[high] - total[-1]
    return low if rises else high
