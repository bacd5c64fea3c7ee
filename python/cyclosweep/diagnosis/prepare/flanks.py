"""The flank in contact and the dead zone of a recording, told by a line."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.prepare.play_jumps import FEW_STEPS, sides_by_jumps
from cyclosweep.diagnosis.prepare.turned_play import TurnedPlay
from cyclosweep.simulation.effects.history import Flags, Floats, Ints

LIGHT = 0.2
"""Share of that torque up to which a shaft may stand where it was turned to by hand: a twentieth of
the largest torque is more than the zero of a torque sensor is off."""

LEAST_MOVED = 0.1
"""Move of the middle between the flanks from run to run, as a share of the play, that matters."""

OF_LOOP = 0.2
"""The same as a share of the width of the loop: of runs with different loops the middles differ."""

SCATTERED = 3.0
"""The same over the scatter of a reading, from which a run is told about its own middle: of a few
readings the middle is not known well."""

LOOP = (0.1, 0.9)
"""Quantiles of what the lines leave that stand for both branches of a loop."""

LEAST_COMPLIANCE = 1e-12
"""Compliance that stands for none [deg/(N m)]."""

LAGS = (2, 4)
"""Readings to either side over which the shaft turns where the play is crossed slowly."""
STEEP = 4.0
"""Turn over the twist by the change of the torque from which the shaft turns freely."""
CLEAR_OF_SCATTER = 6.0
"""The same over the scatter of a reading."""
FAST = 2.0
"""Steps from reading to reading above this many times the largest of a hundred under load are no
noise: of normal ones, one in four million is as large."""


@dataclass(frozen=True, slots=True)
class Flanks:
    """Line through the loaded readings, and where it puts the dead zone.

    Attributes
    ----------
    datum_deg, compliance_deg_per_nm, free_play_deg : float
        The line [deg], [deg/(N m)], [deg]; the free play is zero where none was seen.
    scatter_deg : float
        Standard deviation of a reading about its neighbours, rounding included [deg].
    loop_width_deg : float
        Rough width of the hysteresis loop [deg].
    loaded_nm : float
        Torque beyond which a flank is in contact whatever the angle says [N m].
    loaded_scored_nm : float
        The same by the largest torque of the readings that are scored [N m].
    turned : TurnedPlay or None
        Play through which the shaft was turned, where its ends were seen in the angle.
    only_direction : float or None
        +1 or -1 where no reading is under load in the other direction.
    """

    datum_deg: float
    compliance_deg_per_nm: float
    free_play_deg: float
    scatter_deg: float
    loop_width_deg: float
    loaded_nm: float
    loaded_scored_nm: float
    turned: TurnedPlay | None = None
    only_direction: float | None = None

    @property
    def _pushed_nm(self) -> float:
        """Torque that pushes the shaft to its own flank [N m].

        What holds a shaft on the other one is friction, and that is no more than the loop is wide.
        """
        friction_nm = self.loop_width_deg / max(self.compliance_deg_per_nm, LEAST_COMPLIANCE)
        return max(friction_nm, LIGHT * self.loaded_nm)

    @property
    def apart_deg(self) -> float:
        """Move of the middle of a run from which its flanks are told about it [deg]."""
        of_loop = OF_LOOP * self.loop_width_deg
        return max(self.free_play_deg, of_loop, SCATTERED * self.scatter_deg)

    @property
    def _is_hidden(self) -> bool:
        """Whether a loop hides on which flank a light reading lies, and the torque tells it.

        The loop is wider than the play then, and the friction that it may be too small to hold the
        shaft against the load from which the line was taken. Of a load in one direction the play is
        not known from the recording.
        """
        both = self.only_direction is None
        wide = self.loop_width_deg > self.free_play_deg
        return both and wide and self._pushed_nm < self.loaded_nm

    def is_loaded(self, torque: Floats, scored: Flags | None) -> Flags:
        """Readings that are in contact whatever the angle says.

        Parameters
        ----------
        torque : ndarray, shape (n,)
            In N m.
        scored : ndarray of bool, shape (n,), or None
            Readings that are scored; None for all.

        Returns
        -------
        ndarray of bool, shape (n,)
        """
        if scored is None:
            return np.asarray(np.abs(torque) > self.loaded_nm)
        return np.asarray((np.abs(torque) > self.loaded_scored_nm) & scored)

    def off_middle(self, torque: Floats, angle: Floats) -> Floats:
        """How far each reading lies from the line through the middle of the play [deg].

        Parameters
        ----------
        torque, angle : ndarray, shape (n,)
            Torque [N m] and twist [deg].

        Returns
        -------
        ndarray, shape (n,)
        """
        return np.asarray(angle - self.datum_deg - self.compliance_deg_per_nm * torque)

    def at(
        self,
        torque: Floats,
        angle: Floats,
        scored: Flags | None = None,
        run: Ints | None = None,
    ) -> tuple[Floats, Flags]:
        """Flank of every reading, and whether it is in contact.

        Parameters
        ----------
        torque, angle : ndarray, shape (n,)
            Torque [N m] and twist [deg].
        scored : ndarray of bool, shape (n,), optional
            Readings that are scored; default: all.
        run : ndarray of int, shape (n,), optional
            Run of each reading; default: all are one run.

        Returns
        -------
        side : ndarray, shape (n,)
            +1 or -1.
        contact : ndarray of bool, shape (n,)
            Readings in the order in which they were taken: between one within the play and one in
            contact, others may be on their way.
        """
        if self.turned is not None:
            return self.turned.side(angle), ~self.turned.holds(angle)
        sign = np.where(torque >= 0, 1.0, -1.0)
        play = self.free_play_deg
        if play <= self.scatter_deg:
            # No reading tells where in it the shaft stands: to take those near a flank would be to
            # take them by their noise.
            return sign, np.ones(len(torque), dtype=bool)
        loaded = self.is_loaded(torque, scored)
        run = np.zeros(len(torque), dtype=np.int64) if run is None else run
        inside = self.off_middle(torque, angle)
        least = max(LEAST_MOVED * play, OF_LOOP * self.loop_width_deg)
        moved = moved_datum(inside - sign * play, sign * loaded, run, least)
        # Of a run that is moved by more than the play, the middle of all runs tells nothing.
        apart = np.abs(moved) > self.apart_deg
        inside = np.where(apart, inside - moved, inside)
        moved = np.where(apart, 0.0, moved)
        side = np.where(inside >= 0, 1.0, -1.0)
        side[loaded] = sign[loaded]
        if scored is not None:
            far = np.abs(torque) > self.loaded_scored_nm
            side[far] = sign[far]
        pushed = loaded
        if self._is_hidden:
            pushed = np.abs(torque) > self._pushed_nm
            side = _last_pushed(sign, pushed)
        line = (self.compliance_deg_per_nm, play)
        side = sides_by_jumps(torque, angle, side, loaded, run, line)
        margin = min(max(2.0 * self.loop_width_deg, 0.1 * play), 0.8 * play)
        depth = play - inside * side
        near = (depth < margin) & (play - np.abs(inside - moved) < margin)
        contact = loaded | pushed | near
        # A shaft may have been turned against the other flank without load. Where readings lie
        # there under a torque that pushes it away, the law is curved and all are in contact.
        one_way = sign == self.only_direction if self.only_direction is not None else loaded
        beyond = np.abs(torque)[one_way & (side != sign) & ~loaded]
        if len(beyond) and float(np.median(beyond)) > LIGHT * self.loaded_nm:
            side[one_way] = sign[one_way]
            return side, contact | one_way
        steep = self._turns_freely(torque, angle, run) & ~loaded
        return side, contact & ~_on_the_way(depth, contact, loaded, steep)

    def _turns_freely(self, torque: Floats, angle: Floats, run: Ints) -> Flags:
        """Readings before and after which the shaft turns further than its torque could twist it.

        Parameters
        ----------
        torque, angle : ndarray, shape (n,)
            Torque [N m] and twist [deg].
        run : ndarray of int, shape (n,)
            Run of each reading.

        Returns
        -------
        ndarray of bool, shape (n,)
        """
        found = np.zeros(len(torque), dtype=bool)
        for lag in LAGS:
            if len(torque) <= 2 * lag:
                break
            turn = angle[lag:] - angle[:-lag]
            twist = self.compliance_deg_per_nm * np.abs(torque[lag:] - torque[:-lag])
            least = np.maximum(STEEP * twist, CLEAR_OF_SCATTER * self.scatter_deg)
            far = np.where(np.abs(turn) > least, np.sign(turn), 0.0)
            far[run[lag:] != run[:-lag]] = 0.0
            found[lag:-lag] |= (far[:-lag] != 0.0) & (far[:-lag] == far[lag:])
        return found


def moved_datum(left: Floats, loaded: Floats, run: Ints, least: float) -> Floats:
    """How far the middle between both flanks lies from the datum in each run.

    Of a zero that drifts, as with the temperature, the play is crossed about the middle of the run.

    Parameters
    ----------
    left : ndarray, shape (n,)
        What the lines of both flanks leave of the twist [deg].
    loaded : ndarray, shape (n,)
        Direction of the load, +1 or -1, of readings under load; zero of others.
    run : ndarray of int, shape (n,)
        Run of each reading.
    least : float
        Move that matters; smaller ones count as none [deg].

    Returns
    -------
    ndarray, shape (n,)
        In deg; zero in a run that is not loaded in both directions.
    """
    moved = np.zeros(len(left))
    for each in np.unique(run):
        flanks = [left[(run == each) & (loaded == sign)] for sign in (1.0, -1.0)]
        if all(len(flank) for flank in flanks):
            # Of loops the middle, however many readings are taken on the way up and down.
            middle = float(np.mean([np.quantile(flank, LOOP) for flank in flanks]))
            moved[run == each] = middle if abs(middle) > least else 0.0
    return moved


def _last_pushed(sign: Floats, pushed: Flags) -> Floats:
    """Flank to which the shaft was pushed last, shape (n,); before the first time that one.

    Parameters
    ----------
    sign : ndarray, shape (n,)
        +1 or -1, direction of the torque.
    pushed : ndarray of bool, shape (n,)
        Readings whose torque pushes the shaft to its own flank.

    Returns
    -------
    ndarray, shape (n,)
        The sign itself where no reading is pushed.
    """
    places = np.flatnonzero(pushed)
    if len(places) == 0:
        return sign
    last = np.maximum(np.cumsum(pushed) - 1, 0)
    return np.asarray(sign[places[last]])


def _on_the_way(depth: Floats, contact: Flags, loaded: Flags, steep: Flags) -> Flags:
    """Readings at which the play was still being crossed, next to readings within it.

    Friction and curved laws leave readings in contact a little within the play, so that a margin
    counts as contact. Where the play is crossed in a few readings, one of them may lie in that
    margin by chance; its error is many times the noise. From it to both neighbours the angle moves
    faster than it ever does under load. Where the play is crossed slowly, a step is no larger than
    the noise, but over a few the shaft turns further than its torque could twist it.

    Parameters
    ----------
    depth : ndarray, shape (n,)
        How far within the play each reading lies; negative beyond the flank [deg].
    contact : ndarray of bool, shape (n,)
        Readings in contact, the margin included.
    loaded : ndarray of bool, shape (n,)
        Readings that are in contact whatever the angle says.
    steep : ndarray of bool, shape (n,)
        Readings about which the shaft turns further than its torque could twist it.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    step = np.abs(np.diff(depth))
    usual = step[loaded[1:] & loaded[:-1]]
    if np.all(contact) or len(usual) < FEW_STEPS:
        return np.zeros(len(depth), dtype=bool)
    fast = step > FAST * float(np.quantile(usual, 0.99))
    moving = ((np.r_[False, fast] & np.r_[fast, False] & ~loaded) | steep) & (depth > 0.0)
    maybe = ~contact | moving
    stretch = np.cumsum(np.r_[True, np.diff(maybe.astype(np.int8)) != 0])
    return np.asarray(contact & maybe & np.isin(stretch, stretch[~contact]))
