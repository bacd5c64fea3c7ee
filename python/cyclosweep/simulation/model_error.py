"""What the laws of a model miss at the same state of load: a table learned from a recording.

A state of load is the torque, whether it rises or falls, and the torque at which it began to. The
laws of the effects are never quite right; what they miss stays the same when a loop is repeated,
and so can be forecast although it has no name (the discrepancy of Kennedy and O'Hagan, Bayesian
calibration of computer models, J. R. Stat. Soc. B 63(3), 2001, as a table instead of a Gaussian
process).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, Self

import numpy as np

from cyclosweep.errors import InputError, one_of
from cyclosweep.recording.structure import REVERSAL_SHARE, turning_points
from cyclosweep.simulation.effects.history import Flags, Floats, History, Ints
from cyclosweep.simulation.json_fields import list_of, number_of, object_of, text_of

SAME_START = 0.05
"""Share of the largest torque within which branches begin at the same place."""
MEMORY = 0.5
"""Distance of two starts over the way since, at which the start counts for a factor of e: a loop
that has gone far has forgotten where it turned."""
FADE = 0.1
"""Distance beyond the ends of a branch over the largest torque, at which its error has fallen by a
factor of e."""

Direction = Literal["rising", "falling"]
DIRECTIONS: tuple[Direction, Direction] = ("rising", "falling")


@dataclass(frozen=True, eq=False, slots=True)
class LoadPath:
    """Branches of a load history: from a turning point of the torque to the next.

    Attributes
    ----------
    branch : ndarray of int, shape (n,)
        Number of the branch of each sample.
    from_nm : ndarray, shape (n,)
        Torque at which the branch of each sample began [N m]; zero where play, slip and creep
        started afresh.
    rising : ndarray of bool, shape (n,)
        Whether the torque rises along the branch.
    """

    branch: Ints
    from_nm: Floats
    rising: Flags

    @classmethod
    def of(cls, history: History) -> Self:
        """Split a load history at its turning points.

        Parameters
        ----------
        history : History
            Load history of n samples.

        Returns
        -------
        LoadPath
        """
        torque = history.applied_nm
        count = len(torque)
        branch = np.zeros(count, dtype=np.int64)
        from_nm, rising = np.zeros(count), np.ones(count, dtype=bool)
        least = REVERSAL_SHARE * float(np.ptp(torque)) if count else 0.0
        number = 0
        for start, stop in pairwise([*np.flatnonzero(history.restart).tolist(), count]):
            turns = turning_points(torque[start:stop], least) + start
            for first, last in pairwise([start, *(turns + 1).tolist(), stop]):
                here = slice(first, last)
                begun = 0.0 if first == start else float(torque[first - 1])
                branch[here], from_nm[here] = number, begun
                rising[here] = torque[last - 1] >= begun
                number += 1
        return cls(branch, from_nm, rising)


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
    """

    direction: Direction
    from_nm: float
    torque_nm: tuple[float, ...]
    error_deg: tuple[float, ...]

    def __post_init__(self) -> None:
        one_of("direction", self.direction, DIRECTIONS)
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
        torque, error = (
            tuple(
                number_of({f"{key} {k}": value}, f"{key} {k}")
                for k, value in enumerate(list_of(content, key), 1)
            )
            for key in ("torque_nm", "error_deg")
        )
        direction = text_of(content, "direction", "")
        one_of("direction", direction, DIRECTIONS)
        known: Direction = "falling" if direction == "falling" else "rising"
        return cls(known, number_of(content, "from_nm"), torque, error)


@dataclass(frozen=True, slots=True)
class ModelError:
    """What a model misses along the branches of the loops that were recorded.

    Attributes
    ----------
    branches : tuple of ErrorBranch
        One for each direction and torque at which branches began.
    """

    branches: tuple[ErrorBranch, ...]

    def twist(self, history: History) -> Floats:
        """Twist that the model misses along a load history.

        A branch that begins where a recorded one did has its error. It fades where the branch
        began elsewhere and has not gone far since, and beyond the torques that were recorded.

        Parameters
        ----------
        history : History
            Load history of n samples.

        Returns
        -------
        ndarray, shape (n,)
            In deg.
        """
        path, torque, top = LoadPath.of(history), history.applied_nm, history.largest_torque_nm
        gone = np.maximum(np.abs(torque - path.from_nm), 1e-9 * top)
        total, weights, closest = np.zeros((3, len(history)))
        for known in self.branches:
            nodes = np.array(known.torque_nm)
            apart = np.maximum(np.abs(path.from_nm - known.from_nm) - SAME_START * top, 0.0)
            beyond = np.maximum(np.maximum(nodes[0] - torque, torque - nodes[-1]), 0.0)
            weight = np.exp(-apart / (MEMORY * gone) - beyond / (FADE * top))
            weight = np.where(path.rising == (known.direction == "rising"), weight, 0.0)
            total += weight * np.interp(torque, nodes, known.error_deg)
            weights += weight
            closest = np.maximum(closest, weight)
        return np.asarray(closest * total / np.maximum(weights, 1e-300))

    def as_list(self) -> list[dict[str, Any]]:
        """Entry of ``model.json``."""
        return [branch.as_dict() for branch in self.branches]

    @classmethod
    def from_list(cls, entries: Sequence[Any]) -> Self:
        """Read the entry of ``model.json``.

        Parameters
        ----------
        entries : sequence
            Decoded branches.

        Returns
        -------
        ModelError

        Raises
        ------
        InputError
            A branch is not as expected; one line says which and why.
        """
        found = []
        for number, entry in enumerate(entries, 1):
            name = f"model_error {number}"
            try:
                found.append(ErrorBranch.from_dict(object_of({name: entry}, name)))
            except InputError as error:
                raise InputError(f"{name}: {error}") from error
        return cls(tuple(found))
