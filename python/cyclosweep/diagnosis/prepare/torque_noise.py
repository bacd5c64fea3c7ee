"""Torque without the noise of its sensor, where the twist says that it is noise.

Between its turning points a programme changes the torque smoothly. What the reading adds to that
is either torque, and then the twist follows it with the compliance, or noise of the sensor, and
then the twist knows nothing of it. Left in, noise of the torque looks like drag, whose rate it
makes, and like friction, which holds the shaft through its small reversals.
"""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.prepare.programme_curves import programme_curves
from cyclosweep.recording.robust import robust_sigma
from cyclosweep.simulation.effects.history import Flags, Floats, Ints

REACHES = (2, 3, 5, 8, 12, 18, 27)
"""Rows on each side to which a parabola is fitted; a row takes the farthest that agrees with all
that are nearer."""
AGREES = 1.25
"""Standard deviations within which the parabolas of a row agree (intersection of confidence
intervals: A. Goldenshluger, A. Nemirovski, Math. Methods Statist. 6, 1997)."""
CORNER = 4.0
"""Standard deviations by which a row is off the nearest parabola where the programme has a corner
or a step: such rows are left as they were read."""
FOLLOWS = 0.5
"""Share of the compliance with which the twist follows what the torque does from row to row, from
which that is torque and no noise."""
CLEARLY = 2.0
"""Standard deviations of that share by which it has to lie above: where the readings cannot tell,
what is smoothed away is lost in the noise of the twist, and what is left in looks like drag."""
SEEN = 1.0
"""Compliance, over the standard error with which it is seen in what the torque does from row to
row, from which any test could see that."""
ALIKE = 1.4
"""Standard error of a slope between second differences over that of independent rows."""
MOST = 0.03
"""Noise over the largest torque beyond which the programme has steps: no sensor is so bad."""
SMALL = 0.02
"""Noise of the torque, as twist over what a straight line leaves, up to which the errors of laws
hide what it does; the torque as read is then also what a repaired model is given."""
LARGE = 0.3
"""Slow noise of the torque, as twist over what else is slow in it, from which errors of the curves
are seen there."""
AVERAGED = 16
"""Rows over which noise of the torque is averaged to see how much of it is slow."""
MOST_SHARE = 0.5
"""Share of the noise in a curve up to which what it leaves says how large the noise is; the curve
of a short stretch has more."""
UNCERTAIN = 2.0
"""Error of the torque, as twist over what is new in the twist from row to row, from which a row of
a short stretch of the programme tells nothing."""
MOST_UNCERTAIN = 0.2
"""Share of such rows beyond which none is left out."""
SINGULAR = 1e10
"""Condition number from which rows at too few places fix no parabola."""


@dataclass(frozen=True, eq=False)
class SmoothTorque:
    """Torque without the noise of its sensor.

    Where that noise is large beside the noise of the twist, even a line through all readings of a
    ramp is off by more than the noise of the twist allows, and its error lasts as long as the ramp.
    The twist is then also compared with what the torque as read would make of it.

    Attributes
    ----------
    torque_nm : ndarray, shape (n,)
        The torque, by which rates, turning points and friction are found [N m].
    noise_nm : float
        Standard deviation of the noise that was smoothed; zero where it is the torque as read.
    twist_deg : ndarray, shape (n,)
        Twist by the noise, to be taken off the twist that was read [deg]; zero where its error does
        not matter.
    noise_of_twist_deg : float
        Standard deviation of that noise [deg]; zero where it is not taken off.
    uncertain : ndarray of bool, shape (n,), or None
        Rows at which the torque is known so badly that their twist tells nothing; None: no row.
    """

    torque_nm: Floats
    noise_nm: float
    twist_deg: Floats
    noise_of_twist_deg: float = 0.0
    uncertain: Flags | None = None


def torque_without_noise(
    torque_nm: Floats,
    piece: Ints,
    compliance_deg_per_nm: float,
    off_lines_deg: Floats,
    time_s: Floats | None = None,
    run: Ints | None = None,
) -> "SmoothTorque":
    """Smooth the torque along the pieces of the load history, where it scatters by noise.

    Parameters
    ----------
    torque_nm : ndarray, shape (n,)
        Torque as it was read [N m].
    piece : ndarray of int, shape (n,)
        Label of the piece of each row; equal ones are consecutive, and the programme has no turning
        point within one.
    compliance_deg_per_nm : float
        Rough compliance of the drive at the measured shaft.
    off_lines_deg : ndarray, shape (n,)
        What a straight line on each flank leaves of the twist [deg]; zero of readings within the
        play.
    time_s : ndarray, shape (n,), optional
        Clock [s]; without it rows count as equally spaced.
    run : ndarray of int, shape (n,), optional
        Run of each row; default: all are one run.

    Returns
    -------
    SmoothTorque
        The torque as it was read where the twist follows it, or where no test could tell.
    """
    as_read = SmoothTorque(torque_nm, 0.0, np.zeros(len(torque_nm)))
    place = np.arange(len(torque_nm), dtype=np.float64) if time_s is None else time_s
    # Without the play, whose crossings are no noise.
    twist = off_lines_deg + compliance_deg_per_nm * torque_nm
    both = np.vstack([torque_nm, twist])
    (nearest, _), share = _parabolas(both, place, piece, REACHES[0])
    left = np.sqrt(np.maximum(1.0 - share, 0.0))
    beyond = np.divide(torque_nm - nearest, left, out=np.zeros_like(left), where=left > 0.0)
    if not np.any(left > 0.0):
        return as_read
    noise = robust_sigma(beyond[left > 0.0])
    steady = (left > 0.0) & (np.abs(beyond) <= CORNER * noise)
    touching = off_lines_deg != 0.0
    mismatch = float(np.sqrt(np.mean(off_lines_deg[touching] ** 2))) if np.any(touching) else 0.0
    steps = noise > MOST * float(np.abs(torque_nm).max())
    if steps or compliance_deg_per_nm * noise <= SMALL * mismatch:
        return as_read
    smooth, local_share = _locally_smooth(both, place, piece, steady, noise)
    run = np.zeros(len(piece), dtype=np.int64) if run is None else run
    clipped = np.clip(beyond[left > 0.0], -CORNER * noise, CORNER * noise)
    spread = float(np.sqrt(np.mean(clipped**2)))
    curves, share = programme_curves(torque_nm, twist, place, piece, run, spread)
    share = np.where(np.isfinite(curves[0]), share, local_share)
    smooth = np.where(np.isfinite(curves), curves, smooth)
    follows = _Following.of(both - smooth, steady & touching, piece)
    if compliance_deg_per_nm <= SEEN * follows.std_error:
        return as_read
    if abs(follows.slope) > FOLLOWS * compliance_deg_per_nm + CLEARLY * follows.std_error:
        return as_read
    error = torque_nm - smooth[0]
    known = np.isfinite(curves[0]) & (share < MOST_SHARE)
    if np.any(known):
        noise = robust_sigma(error[known] / np.sqrt(1.0 - share[known]))
    # The curves take up a part of the noise, which is then in them.
    taken_up = noise * float(np.sqrt(np.mean(np.minimum(AVERAGED * share, 1.0))))
    slow = compliance_deg_per_nm * np.hypot(_slow_size(error, run), taken_up)
    of_twist = np.sqrt(max(_slow_size(off_lines_deg, run) ** 2 - slow**2, 0.0))
    if compliance_deg_per_nm * taken_up > LARGE * of_twist:
        as_twist = compliance_deg_per_nm * error
        return SmoothTorque(smooth[0], noise, as_twist, compliance_deg_per_nm * noise)
    uncertain = compliance_deg_per_nm * noise * np.sqrt(share) > UNCERTAIN * follows.jitter_deg
    uncertain &= share > MOST_SHARE
    if np.mean(uncertain) > MOST_UNCERTAIN:
        uncertain[:] = False
    return SmoothTorque(smooth[0], noise, np.zeros(len(error)), uncertain=uncertain)


def _locally_smooth(
    values: Floats, place: Floats, piece: Ints, steady: Flags, noise_nm: float
) -> tuple[Floats, Floats]:
    """Parabolas through as many neighbours of each row as agree with one another.

    Parameters
    ----------
    values : ndarray, shape (2, n)
        Torque [N m], which decides, and twist [deg].
    place : ndarray, shape (n,)
        Where.
    piece : ndarray of int, shape (n,)
    steady : ndarray of bool, shape (n,)
        Rows at no corner of the programme; the others are left as they were read.
    noise_nm : float
        Standard deviation of the noise of the torque [N m].

    Returns
    -------
    smooth : ndarray, shape (2, n)
    share : ndarray, shape (n,)
        Variance of a row's torque over that of the noise.
    """
    smooth, taken_up = values.copy(), np.ones(len(place))
    low, high = np.full(len(place), -np.inf), np.full(len(place), np.inf)
    agrees = steady
    for reach in REACHES:
        fitted, share = _parabolas(values, place, piece, reach)
        room = AGREES * noise_nm * np.sqrt(share)
        low, high = np.maximum(low, fitted[0] - room), np.minimum(high, fitted[0] + room)
        agrees = agrees & (low <= high)
        smooth[:, agrees], taken_up[agrees] = fitted[:, agrees], share[agrees]
    return smooth, taken_up


@dataclass(frozen=True, slots=True)
class _Following:
    """How the twist follows what the torque does from row to row.

    Attributes
    ----------
    slope : float
        Twist over torque [deg/(N m)].
    std_error : float
        Its standard error; infinite where the torque does nothing.
    jitter_deg : float
        What is new in the twist from row to row [deg].
    """

    slope: float
    std_error: float
    jitter_deg: float

    @classmethod
    def of(cls, left: Floats, usable: Flags, piece: Ints) -> "_Following":
        """By second differences, which hold nothing of slow errors of the curves and of effects.

        Parameters
        ----------
        left : ndarray, shape (2, n)
            Torque [N m] and twist [deg] beyond smooth curves.
        usable : ndarray of bool, shape (n,)
        piece : ndarray of int, shape (n,)
            Label of the piece of each row.

        Returns
        -------
        _Following
        """
        inner = usable[:-2] & usable[1:-1] & usable[2:] & (piece[:-2] == piece[2:])
        ripple, jitter = np.diff(left, 2, axis=1)[:, inner]
        power = float(ripple @ ripple)
        if power <= 0.0:
            return cls(0.0, np.inf, 0.0)
        size = robust_sigma(jitter)
        slope = float(ripple @ np.clip(jitter, -CORNER * size, CORNER * size)) / power
        return cls(slope, ALIKE * size / np.sqrt(power), size / np.sqrt(6.0))


def _slow_size(error: Floats, run: Ints) -> float:
    """Size of noise by its averages over some rows, times the root of their number.

    Parameters
    ----------
    error : ndarray, shape (n,)
    run : ndarray of int, shape (n,)
        Run of each row.

    Returns
    -------
    float
        The standard deviation itself where it is white; zero of fewer rows.
    """
    sums = np.cumsum(np.r_[0.0, error])
    same = run[:-AVERAGED] == run[AVERAGED:] if len(error) > AVERAGED else np.zeros(0, dtype=bool)
    means = (sums[AVERAGED:-1] - sums[: -AVERAGED - 1])[same] / np.sqrt(AVERAGED)
    return robust_sigma(means) if len(means) else 0.0


def smoothed_in_words(noise_nm: float, averaged: int) -> str:
    """Say how large the noise of the torque is, and what was done to it.

    Parameters
    ----------
    noise_nm : float
        Its standard deviation from row to row [N m].
    averaged : int
        Usual number of samples that are averaged in a row.

    Returns
    -------
    str
    """
    rows = "" if averaged == 1 else f", each the average of about {averaged} samples"
    single = "" if averaged == 1 else "; single samples may scatter by more"
    return (
        f"The torque reading scatters by {noise_nm:.2g} N m from row to row{rows} (one standard "
        f"deviation{single}), and the twist does not follow it: noise of the torque sensor. It is "
        "smoothed between the turning points before anything is fitted; left in, it would look "
        "like drag and friction."
    )


def _parabolas(values: Floats, place: Floats, piece: Ints, reach: int) -> tuple[Floats, Floats]:
    """Values of parabolas through the neighbours of each row in its piece, itself among them.

    Parameters
    ----------
    values : ndarray, shape (k, n)
        What is smoothed.
    place : ndarray, shape (n,)
        Where.
    piece : ndarray of int, shape (n,)
    reach : int
        Rows on each side.

    Returns
    -------
    smooth : ndarray, shape (k, n)
        The values themselves where the piece has no more rows than a parabola takes up.
    share : ndarray, shape (n,)
        Variance of them over that of the noise of a row.
    """
    count = len(place)
    moments, sums = np.zeros((5, count)), np.zeros((3, *values.shape))
    for distance in range(-reach, reach + 1):
        here = np.arange(max(0, -distance), min(count, count - distance))
        here = here[piece[here] == piece[here + distance]]
        away = place[here + distance] - place[here]
        for power in range(5):
            moments[power, here] += away**power
        for power in range(3):
            sums[power][:, here] += away**power * values[:, here + distance]
    enough = np.flatnonzero((moments[0] > 3) & (moments[2] > 0.0))
    # In units of its own spread the normal equations of a row are of order one.
    spread = np.sqrt(moments[2, enough] / moments[0, enough])
    order = np.add.outer(np.arange(3), np.arange(3))
    normal = np.moveaxis(moments[order][:, :, enough] / spread ** order[:, :, None], 2, 0)
    regular = np.linalg.cond(normal) < SINGULAR
    enough, spread = enough[regular], spread[regular]
    weights = np.linalg.inv(normal[regular])[:, 0, :].T
    smooth, share = values.copy(), np.ones(count)
    scaled = sums[:, :, enough] / (spread ** np.arange(3)[:, None])[:, None, :]
    smooth[:, enough] = np.sum(weights[:, None, :] * scaled, axis=0)
    share[enough] = np.clip(weights[0], 0.0, 1.0)
    return smooth, share
