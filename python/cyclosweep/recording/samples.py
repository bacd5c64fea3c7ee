"""The samples of a recording as plain arrays, one entry a sample, in the order recorded."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import ArrayLike, NDArray

from cyclosweep.errors import InputError

__all__ = ["COLUMNS", "Flags", "Floats", "Ints", "Samples", "floats_of", "numbers_of"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

COLUMNS: dict[str, type] = {
    "time_s": np.float64,
    "torque_nm": np.float64,
    "angle_deg": np.float64,
    "run": np.int64,
    "crank_deg": np.float64,
    "temperature_c": np.float64,
    "unscored": np.bool_,
}
"""Every column of samples and the type of its values."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Samples:
    """Torque, twist and what was recorded with them; every array is read-only.

    Attributes
    ----------
    torque_nm : ndarray of float, shape (n,)
        Torque at the measured shaft [N m].
    angle_deg : ndarray of float, shape (n,), or None
        Twist at the measured shaft [deg], unwrapped, positive with the torque; None for a load
        programme.
    time_s : ndarray of float, shape (n,), or None
        Clock [s]. Without it only the order of rows is known and rate effects are untestable.
    run : ndarray of int, shape (n,)
        Trial each sample belongs to.
    crank_deg : ndarray of float, shape (n,), or None
        Position of the mesh zone at which the output was locked [deg].
    temperature_c : ndarray of float, shape (n,), or None
        Temperature [degC].
    unscored : ndarray of bool, shape (n,), or None
        Samples simulated for their effect on the state, neither fitted nor scored; None: all count.
    """

    torque_nm: Floats
    angle_deg: Floats | None = None
    time_s: Floats | None = None
    run: Ints
    crank_deg: Floats | None = None
    temperature_c: Floats | None = None
    unscored: Flags | None = None

    def __post_init__(self) -> None:
        for name, kind in COLUMNS.items():
            given = getattr(self, name)
            if given is None:
                continue
            array: NDArray[Any] = np.asarray(given)
            _refuse_complex(name, array)
            if kind is np.int64 and array.dtype.kind == "f":
                _refuse_fractions(name, array)
            array = np.asarray(array, dtype=kind)
            if array.ndim != 1 or len(array) != len(self.torque_nm):
                raise InputError(
                    f"{name}: found shape {array.shape}, expected ({len(self.torque_nm)},)"
                )
            if array.flags.writeable:
                array = array.copy()
                array.flags.writeable = False
            object.__setattr__(self, name, array)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        for name in COLUMNS:  # arrays come out of a pickle writeable
            array = state.get(name)
            if array is not None:
                array.flags.writeable = False

    def __len__(self) -> int:
        return len(self.torque_nm)

    @property
    def is_program(self) -> bool:
        """Whether this is a load programme, without a measured angle."""
        return self.angle_deg is None

    @property
    def runs(self) -> tuple[int, ...]:
        """Numbers of the runs in the order recorded."""
        if not len(self):
            return ()
        first = np.unique(self.run, return_index=True)[1]
        return tuple(int(k) for k in self.run[np.sort(first)])

    def in_runs(self, runs: Iterable[int]) -> Flags:
        """Mask of the samples that belong to the given runs."""
        return np.isin(self.run, list(runs))

    def to_frame(self) -> pl.DataFrame:
        """Canonical columns as a polars frame."""
        return pl.DataFrame(
            {
                name: array
                for name in COLUMNS
                if name != "unscored" and (array := getattr(self, name)) is not None
            }
        )


def _refuse_fractions(name: str, values: NDArray[Any]) -> None:
    """Refuse numbers that are not whole, which a change of type would cut off.

    Parameters
    ----------
    name : str
        What they are called in the message.
    values : ndarray, shape (n,)
        Numbers.

    Raises
    ------
    InputError
        With the first of them.
    """
    wrong = np.flatnonzero(~(np.isfinite(values) & (values == np.rint(values))))
    if len(wrong):
        found = values.flat[wrong[0]]
        raise InputError(f"{name}, sample {wrong[0] + 1}: found {found:g}, expected an integer")


def _refuse_complex(name: str, values: NDArray[Any]) -> None:
    """Refuse complex numbers, of which numpy would keep the real part.

    Parameters
    ----------
    name : str
        What they are called in the message.
    values : ndarray
        Numbers.

    Raises
    ------
    InputError
        For any of them.
    """
    if values.dtype.kind == "c":
        raise InputError(f"{name}: found complex numbers, expected real ones")


def floats_of(name: str, values: ArrayLike | None) -> Floats | None:
    """Make an array of floats, where there is one to make.

    Parameters
    ----------
    name : str
        What it is called in a message.
    values : array_like or None
        Numbers.

    Returns
    -------
    ndarray or None
    """
    return None if values is None else numbers_of(name, values)


def numbers_of(name: str, values: ArrayLike) -> Floats:
    """Make an array of numbers of one dimension, or say what is none.

    Parameters
    ----------
    name : str
        What it is called in a message.
    values : array_like
        Numbers.

    Returns
    -------
    ndarray, shape (n,)
    """
    try:
        given: NDArray[Any] = np.asarray(values)
        array = given if given.dtype.kind == "c" else np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name}: expected numbers, one a sample") from None
    _refuse_complex(name, array)
    if array.ndim != 1:
        raise InputError(f"{name}: found shape {array.shape}, expected numbers, one a sample")
    return array
