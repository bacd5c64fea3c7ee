"""What the laws of a model miss at the same state of load: a table learned from a recording.

A state of load is the torque, whether it rises or falls, and the torque at which it began to. The
laws of the effects are never quite right; what they miss stays the same when a loop is repeated,
and so can be forecast although it has no name (the discrepancy of Kennedy and O'Hagan, Bayesian
calibration of computer models, J. R. Stat. Soc. B 63(3), 2001, as a table instead of a Gaussian
process).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, Self

import numpy as np

from cyclosweep.errors import InputError, one_of
from cyclosweep.recording.structure import REVERSAL_SHARE, turning_points
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.mesh_range import short_way_deg
from cyclosweep.simulation.json_fields import (
    flag_of,
    list_of,
    number_of,
    numbers_of,
    object_of,
    text_of,
)

SAME_START = 0.05
"""Share of the largest torque within which branches begin at the same place."""
MEMORY = 0.5
"""Distance of two starts over the way since, at which the start counts for a factor of e: a loop
that has gone far has forgotten where it turned."""
FADE = 0.1
"""Way over the largest torque in which an error falls by a factor of e: beyond the ends of the
table, and from a turning point on where the table has no branch that begins there."""
SAME_POSITION_DEG = 5.0
"""Distance of two positions of the mesh up to which they are the same [deg]."""

Direction = Literal["rising", "falling"]
DIRECTIONS: tuple[Direction, Direction] = ("rising", "falling")


@dataclass(frozen=True, slots=True)
class LoadBranch:
    """Samples of a load history from a turning point of the torque to the next.

    Attributes
    ----------
    samples : slice
        The samples: those after the first turning point, up to the second.
    from_nm : float
        Torque at which the branch begins [N m].
    direction : {"rising", "falling"}
        Whether the torque rises or falls.
    fresh : bool
        The first branch after play, slip and creep started afresh, from no torque.
    """

    samples: slice
    from_nm: float
    direction: Direction
    fresh: bool


def load_branches(history: History, largest_nm: float) -> list[LoadBranch]:
    """Split a load history at its turning points.

    A turn is one once the torque has gone back by a twentieth of the largest: the last readings of
    a history may still belong to the branch before.

    Parameters
    ----------
    history : History
        Load history of n samples.
    largest_nm : float
        Torque of which a twentieth counts as a change of direction [N m].

    Returns
    -------
    list of LoadBranch
        In the order of the samples; each sample belongs to one.
    """
    found = []
    starts = [*np.flatnonzero(history.restart).tolist(), len(history)]
    for start, stop in pairwise(starts):
        # Every load begins from none: one that is there at once was put on.
        torque = np.r_[0.0, history.applied_nm[start:stop]]
        turns = turning_points(torque, REVERSAL_SHARE * largest_nm).tolist()
        for first, last in pairwise([0, *turns, len(torque) - 1]):
            rises = torque[last] >= torque[first]
            found.append(
                LoadBranch(
                    slice(start + first, start + last),
                    float(torque[first]),
                    "rising" if rises else "falling",
                    first == 0,
                )
            )
    return found


@dataclass(frozen=True, slots=True)
class ErrorBranch:
    """Error of a model along one branch.

    Attributes
    ----------
    direction : {"rising", "falling"}
        Whether the torque rises or falls.
    from_nm : float
        Torque at which the branch begins [N m].
    torque_nm : tuple of float
        Torques of the table, rising [N m].
    error_deg : tuple of float
        Measured less modelled twist there [deg].
    fresh : bool
        Whether it is the first loading, from where play, slip and creep started afresh.
    """

    direction: Direction
    from_nm: float
    torque_nm: tuple[float, ...]
    error_deg: tuple[float, ...]
    fresh: bool = False

    def __post_init__(self) -> None:
        one_of("direction", self.direction, DIRECTIONS)
        if not np.all(np.isfinite([self.from_nm, *self.torque_nm, *self.error_deg])):
            raise InputError("expected finite torques and errors")
        if not 0 < len(self.torque_nm) == len(self.error_deg):
            raise InputError(
                f"found {len(self.torque_nm)} torques and {len(self.error_deg)} errors, expected "
                "as many of both, at least one"
            )
        if not np.all(np.diff(self.torque_nm) > 0):
            raise InputError("torque_nm: expected numbers that rise")

    def as_dict(self) -> dict[str, Any]:
        """Entry of ``model.json``."""
        return {
            "direction": self.direction,
            "first_loading": self.fresh,
            "from_nm": self.from_nm,
            "torque_nm": list(self.torque_nm),
            "error_deg": list(self.error_deg),
        }

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Read an entry of ``model.json``.

        Parameters
        ----------
        content : mapping
            Decoded entry.

        Returns
        -------
        ErrorBranch

        Raises
        ------
        InputError
            A key is missing or unlike what is expected; one line says which.
        """
        torque, error = numbers_of(content, "torque_nm"), numbers_of(content, "error_deg")
        direction = text_of(content, "direction", "")
        one_of("direction", direction, DIRECTIONS)
        known: Direction = "falling" if direction == "falling" else "rising"
        fresh = flag_of(content, "first_loading")
        return cls(known, number_of(content, "from_nm"), torque, error, fresh)


@dataclass(frozen=True, slots=True)
class ModelError:
    """What a model misses along the branches of the loops that were recorded.

    Attributes
    ----------
    branches : tuple of ErrorBranch
        One for each direction and torque at which branches began.
    largest_torque_nm : float
        Largest torque of the recording [N m].
    crank_deg : float or None
        Position of the mesh, where all was recorded at a single one [deg]. At others the table
        says nothing.
    """

    branches: tuple[ErrorBranch, ...]
    largest_torque_nm: float
    crank_deg: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.largest_torque_nm < np.inf:
            raise InputError(
                f"largest_torque_nm: found {self.largest_torque_nm}, expected more than zero"
            )

    def twist(self, history: History) -> Floats:
        """Twist that the model misses along a load history.

        A branch that begins where a recorded one did has its error. One that begins elsewhere
        starts with the error of the turning point, which fades, and takes that of the recorded
        ones on as it goes: `MEMORY`. Beyond the torques that were recorded the error fades.

        Parameters
        ----------
        history : History
            Load history of n samples.

        Returns
        -------
        ndarray, shape (n,)
            In deg.
        """
        missed = np.zeros(len(history))
        nodes = [(np.array(known.torque_nm), np.array(known.error_deg)) for known in self.branches]
        for branch in load_branches(history, self.largest_torque_nm):
            torque = history.applied_nm[branch.samples]
            gone = np.abs(torque - branch.from_nm)
            share, known = self._along(branch, torque, gone, nodes)
            before = 0.0 if branch.fresh else missed[branch.samples.start - 1]
            held = before * np.exp(-gone / (FADE * self.largest_torque_nm))
            missed[branch.samples] = share * known + (1.0 - share) * held
        if self.crank_deg is not None and history.crank_deg is not None:
            away = np.abs(short_way_deg(history.crank_deg - self.crank_deg))
            missed = np.where(away <= SAME_POSITION_DEG, missed, 0.0)
        return missed

    def _along(
        self,
        branch: LoadBranch,
        torque: Floats,
        gone: Floats,
        nodes: list[tuple[Floats, Floats]],
    ) -> tuple[Floats, Floats]:
        """How far the table knows a branch, from 0 to 1, and the error by it.

        Recorded branches that began at the same place are asked alone, others where there are none.

        Parameters
        ----------
        branch : LoadBranch
        torque : ndarray, shape (k,)
            Torque along it [N m].
        gone : ndarray, shape (k,)
            Way since its start [N m].
        nodes : list of (ndarray, ndarray)
            Torques [N m] and errors [deg] of every branch of the table.

        Returns
        -------
        share, error : ndarray, shape (k,)
            [-] and [deg].
        """
        apart = [self._apart(branch, known) for known in self.branches]
        asked = [each for each in zip(nodes, apart, strict=True) if each[1] < np.inf]
        same = [each for each in asked if each[1] == 0.0]
        total, weights, closest = np.zeros((3, len(torque)))
        for (at, error), distance in same or asked:
            beyond = np.maximum(np.maximum(at[0] - torque, torque - at[-1]), 0.0)
            forgotten = distance / (MEMORY * np.maximum(gone, 1e-9 * self.largest_torque_nm))
            weight = np.exp(-forgotten - beyond / (FADE * self.largest_torque_nm))
            total += weight * np.interp(torque, at, error)
            weights += weight
            closest = np.maximum(closest, weight)
        return closest, total / np.maximum(weights, 1e-300)

    def _apart(self, branch: LoadBranch, known: ErrorBranch) -> float:
        """Distance of the starts of a branch and a recorded one; zero where they are the same.

        Parameters
        ----------
        branch : LoadBranch
        known : ErrorBranch

        Returns
        -------
        float
            In N m. Infinite for the other direction. A first loading is as far from a later one as
            the largest torque.
        """
        if known.direction != branch.direction:
            return float(np.inf)
        if known.fresh != branch.fresh:
            return self.largest_torque_nm
        away = abs(branch.from_nm - known.from_nm)
        return max(away - SAME_START * self.largest_torque_nm, 0.0)

    def as_dict(self) -> dict[str, Any]:
        """Entry of ``model.json``."""
        content: dict[str, Any] = {"largest_torque_nm": self.largest_torque_nm}
        if self.crank_deg is not None:
            content["crank_deg"] = self.crank_deg
        return content | {"branches": [branch.as_dict() for branch in self.branches]}

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Read the entry of ``model.json``.

        Parameters
        ----------
        content : mapping
            Decoded entry.

        Returns
        -------
        ModelError

        Raises
        ------
        InputError
            A branch is not as expected; one line says which and why.
        """
        found = []
        for number, entry in enumerate(list_of(content, "branches"), 1):
            try:
                found.append(ErrorBranch.from_dict(object_of({"entry": entry}, "entry")))
            except InputError as error:
                raise InputError(f"model_error: branch {number}: {error}") from error
        crank = number_of(content, "crank_deg") if "crank_deg" in content else None
        return cls(tuple(found), number_of(content, "largest_torque_nm"), crank)
