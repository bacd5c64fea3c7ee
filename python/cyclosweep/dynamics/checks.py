"""Checks of the lists from which a train is made."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from cyclosweep.dynamics.spring import TrainSpring
from cyclosweep.errors import InputError, instance_of

__all__ = ["finite", "floats", "numbered", "real", "same_length", "spring_of"]


def numbered(word: str, count: int) -> tuple[str, ...]:
    """Names such as ``node_1``, one for each of ``count``."""
    return tuple(f"{word}_{k}" for k in range(1, count + 1))


def spring_of(number: int, stiffness_nm_per_rad: float, gap_rad: float) -> TrainSpring:
    """Return a spring by stiffness [N m/rad] and half play [rad], or say which one is wrong."""
    try:
        return TrainSpring.linear(float(stiffness_nm_per_rad), float(gap_rad))
    except InputError as error:
        raise InputError(f"spring {number}: {error}") from None


def floats(what: str, values: object) -> tuple[float, ...]:
    """Return a list of numbers as floats; InputError for what is none."""
    instance_of(what, values, Sequence, np.ndarray)
    try:
        return tuple(float(value) for value in values)  # type: ignore[attr-defined]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{what}: found {values!r}, expected a list of numbers") from None


def real(what: str, value: object) -> float:
    """Return a number as a float; InputError for what is none."""
    instance_of(what, value, int, float, np.integer, np.floating)
    try:
        return float(value)  # type: ignore[arg-type]
    except OverflowError:
        raise InputError(f"{what}: found an integer beyond the range of floats") from None


def finite(what: str, value: object) -> float:
    """Return a number as a float; InputError for what is none, NaN or an infinity."""
    number = real(what, value)
    if not math.isfinite(number):
        raise InputError(f"{what}: found {number:g}, expected a finite number")
    return number


def same_length(what: str, found: int, expected: int, where: str = "") -> None:
    """Require that a list has the length that it must have.

    Parameters
    ----------
    what : str
        Name of the list.
    found, expected : int
        Lengths.
    where : str
        What the message ends with.

    Raises
    ------
    InputError
        When it has another.
    """
    if found != expected:
        raise InputError(f"{what}: found {found}, expected {expected}{where}")
