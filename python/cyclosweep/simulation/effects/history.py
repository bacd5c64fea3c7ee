"""What an effect sees of a load history: torque, clock, runs, place, and the shaft's path."""

import warnings
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Self

import numpy as np

from cyclosweep.simulation.effects.corners import Corners, Flags, Floats, Ints, find_corners
from cyclosweep.simulation.effects.twist_law import ElasticLaw

__all__ = ["Flags", "Floats", "History", "Ints", "runs_and_restarts"]

_FOLLOWS_FROM = {
    "largest_torque_nm": {"applied_nm"},
    "run_starts": {"run"},
    "run_count": {"run"},
    "sense": {"applied_nm", "side", "run"},
    "usual_step_s": {"time_s", "run"},
    "lapse_s": {"applied_nm", "restart", "time_s"},
    "corners": {"applied_nm", "run", "restart", "time_s", "has_corners"},
}
"""Values that are computed once for a load history, and what each follows from. Another state of
the model on the same load leaves them as they are."""
_ZEROS_KEPT = 3
"""Zeros of the torque for which the load is kept: a fit tries a few in turn."""


@dataclass(frozen=True, eq=False, kw_only=True)
class History:
    """Load history with the state of the model along it.

    Attributes
    ----------
    applied_nm : ndarray, shape (n,)
        Applied torque [N m].
    elastic_nm : ndarray, shape (n,)
        Torque that twists the drive: applied torque less friction [N m].
    angle_deg : ndarray, shape (n,)
        Twist according to the model, from the datum of the dial [deg].
    beyond_deg : ndarray, shape (n,), or float
        Part of it that lies beyond the friction: it turns the shaft where it is measured, but not
        the part that friction holds [deg].
    drag_compliance : ndarray, shape (n,), or None
        Twist that the elastic parts lose for each unit of drag, by which they carry less than
        `elastic_nm` [deg/(N m)]; None for the compliance of the line.
    elastic_law : ElasticLaw or None
        How the elastic parts twist, where effects bend the line; None for the line.
    side : ndarray, shape (n,)
        Flank in contact: +1 or -1.
    run : ndarray of int, shape (n,)
        Index of the run, counted from zero in the order recorded.
    restart : ndarray of bool, shape (n,)
        True where play, slip and creep start afresh.
    corner_deg, corner_nm : ndarray, shape (m,), or None
        Angle by which friction slides [deg], and elastic torque [N m], at the corners of the load
        between the samples; None where friction has not been solved.
    has_corners : bool
        Whether the applied torque is known so well that its corners can be found; False while it is
        being predicted.
    compliance_deg_per_nm, free_play_deg : float
        Of the baseline as calibrated so far [deg/(N m)], [deg].
    datum_deg : float
        Middle of the dead zone as calibrated so far [deg].
    time_s, crank_deg, temperature_c : ndarray or None
        Clock [s], position of the mesh zone [deg], temperature [degC], where recorded.
    output_pin_count : int
        Number of output pins of the drive.
    mesh_ratio : float
        Turns of the mesh zone a turn of the measured shaft: one at the input, the ratio of the
        drive at the output.
    measured_deg : ndarray, shape (n,), or None
        Angle of the shaft as it was measured [deg], by which the position of the mesh is known
        while hypotheses are looked for; None in a fit or a simulation, which has to find it.
    resets_datum : bool
        The rig was reset between runs, so that the datum cannot remember.
    """

    applied_nm: Floats
    elastic_nm: Floats
    angle_deg: Floats
    side: Floats
    run: Ints
    restart: Flags
    compliance_deg_per_nm: float
    free_play_deg: float
    datum_deg: float = 0.0
    time_s: Floats | None = None
    crank_deg: Floats | None = None
    temperature_c: Floats | None = None
    output_pin_count: int = 8
    mesh_ratio: float = 1.0
    measured_deg: Floats | None = None
    beyond_deg: Floats | float = 0.0
    resets_datum: bool = False
    corner_deg: Floats | None = None
    corner_nm: Floats | None = None
    has_corners: bool = True
    drag_compliance: Floats | None = None
    elastic_law: ElasticLaw | None = None

    def __len__(self) -> int:
        return len(self.applied_nm)

    def with_state(self, **state: object) -> Self:
        """Return the same load history with another state of the model."""
        if "elastic_nm" in state:
            state = {"corner_deg": None, "corner_nm": None} | state
        if not state.keys() <= _FIELDS:
            raise TypeError(f"a load history has no {', '.join(state.keys() - _FIELDS)}")
        # Thousands of times in a fit: `dataclasses.replace` takes five times as long.
        other = object.__new__(type(self))
        other.__dict__.update({name: self.__dict__[name] for name in _FIELDS}, **state)
        for name, needs in _FOLLOWS_FROM.items():
            if name in self.__dict__ and needs.isdisjoint(state):
                other.__dict__[name] = self.__dict__[name]
        return other

    def zeroed(self, zero_nm: float) -> Self:
        """Return the same load as read from another zero of the torque, kept for the last few.

        Parameters
        ----------
        zero_nm : float
            Reading of the torque without load [N m].

        Returns
        -------
        History
        """
        known = self._known_zeros
        if zero_nm not in known:
            if len(known) >= _ZEROS_KEPT:
                del known[next(iter(known))]
            known[zero_nm] = self.with_state(applied_nm=self.applied_nm - zero_nm)
        return known[zero_nm]

    @cached_property
    def _known_zeros(self) -> dict[float, Self]:
        """Loads as read from the last few zeros of the torque."""
        return {}

    @cached_property
    def largest_torque_nm(self) -> float:
        """Largest magnitude of the applied torque [N m]."""
        return float(np.abs(self.applied_nm).max(initial=1e-12))

    @property
    def largest_twist_deg(self) -> float:
        """Elastic twist at the largest torque [deg]."""
        return self.largest_torque_nm * self.compliance_deg_per_nm

    @property
    def load_nm(self) -> Floats:
        """Magnitude of the elastic torque on the flank in contact, never negative [N m]."""
        return np.maximum(self.elastic_nm * self.side, 0.0)

    @cached_property
    def line_equivalent_nm(self) -> Floats:
        """Torque that would twist the straight line as far as the elastic parts are twisted [N m].

        It is what a change of their compliance multiplies: where they stiffen, a compliance that
        grows by a tenth adds a tenth of the twist that they have, not of that of the line. Parts in
        series with friction, which carry another torque, are left out.
        """
        if self.elastic_law is None:
            return self.elastic_nm
        return self.elastic_law.line_equivalent_nm(self.elastic_nm)

    @cached_property
    def under_applied_torque(self) -> "History":
        """The same for a part in series with friction, which carries the whole applied torque."""
        side = np.where(self.applied_nm == 0.0, self.side, np.sign(self.applied_nm))
        return self.with_state(elastic_nm=self.applied_nm, side=side)

    @cached_property
    def corners(self) -> Corners:
        """Corners of the applied torque between the samples."""
        time_s = self.time_s if self.has_corners else None
        begins = self.restart | np.r_[True, np.diff(self.run) != 0][: len(self)]
        return find_corners(self.applied_nm, time_s, begins)

    @property
    def held_deg(self) -> Floats:
        """Angle of the part that friction holds, according to the model [deg]."""
        return self.angle_deg - self.beyond_deg

    @property
    def travelled_deg(self) -> Floats:
        """Angle by which the mesh travels: as measured where that is known, else as modelled."""
        return self.angle_deg if self.measured_deg is None else self.measured_deg

    def mesh_deg(self, ratio: float) -> Floats:
        """Position of the mesh zone: where it was locked, and what the shaft travelled since [deg].

        ``ratio`` is the number of turns of the mesh zone a turn of the measured shaft. A locking
        position that was not recorded counts as zero.
        """
        travel = ratio * self.travelled_deg
        return travel if self.crank_deg is None else self.crank_deg + travel

    @cached_property
    def run_starts(self) -> Ints:
        """Index of the first sample of every run, in order."""
        return np.flatnonzero(np.r_[True, np.diff(self.run) != 0])

    @cached_property
    def run_count(self) -> int:
        """Number of runs."""
        return int(self.run.max(initial=-1)) + 1

    @cached_property
    def sense(self) -> Floats:
        """+1 where the torque rises, -1 where it falls; a hold keeps the sense before it."""
        step = np.diff(self.applied_nm, prepend=self.applied_nm[:1])
        step[self.run_starts] = 0.0
        small = 1e-6 * self.largest_torque_nm
        sense = np.where(np.abs(step) > small, np.sign(step), 0.0)
        last = np.maximum.accumulate(np.where(sense != 0, np.arange(len(sense)), 0))
        filled = sense[last]
        return np.where(filled == 0, np.where(self.side > 0, 1.0, -1.0), filled)

    @cached_property
    def start_angle_deg(self) -> Floats:
        """Angle at which fresh slip elements are anchored: unloaded contact on the first flank."""
        return self.datum_deg + self.side * self.free_play_deg

    @cached_property
    def usual_step_s(self) -> float:
        """Time between neighbouring samples, as a rule [s]; zero without a clock."""
        if self.time_s is None:
            return 0.0
        step = np.diff(self.time_s)
        step = step[(step > 0) & (np.diff(self.run) == 0)]
        return float(np.median(step)) if len(step) else 0.0

    @property
    def rate_step_s(self) -> float:
        """Time over which a rate is measured [s]: a step, or more where steps are very many."""
        return self.usual_step_s * max(len(self) / max(self.run_count, 1) / 250.0, 1.0)

    @property
    def telling_step_s(self) -> float:
        """Former name of `rate_step_s`."""
        warnings.warn("telling_step_s is now rate_step_s", DeprecationWarning, stacklevel=2)
        return self.rate_step_s

    @cached_property
    def lapse_s(self) -> Floats:
        """Time that led to each sample [s]; to the first of a run, from zero torque at its rate."""
        if self.time_s is None:
            raise ValueError("a lapse needs a clock")
        lapse = np.diff(self.time_s, prepend=self.time_s[:1])
        for first in np.flatnonzero(self.restart):
            lapse[first] = np.inf
            if first + 1 < len(self) and not self.restart[first + 1]:
                torque = self.applied_nm[first]
                step = self.applied_nm[first + 1] - torque
                if torque * step > 0:
                    lapse[first] = torque / step * (self.time_s[first + 1] - self.time_s[first])
        return lapse


_FIELDS = frozenset(field.name for field in fields(History))


def runs_and_restarts(run: Ints, *, one_history: bool) -> tuple[Ints, Flags]:
    """Number the runs of a load, and say where play, slip and creep start afresh.

    Parameters
    ----------
    run : ndarray of int, shape (n,)
        Label of the run of each sample.
    one_history : bool
        Runs go on from each other.

    Returns
    -------
    number : ndarray of int, shape (n,)
        Runs counted from zero in the order in which they follow.
    restart : ndarray of bool, shape (n,)
        At the first sample of all or, where runs begin afresh, of each run.
    """
    begins = np.diff(run, prepend=run[:1] - 1) != 0
    restart = np.arange(len(run)) == 0 if one_history else begins
    return np.cumsum(begins).astype(np.int64) - 1, restart
