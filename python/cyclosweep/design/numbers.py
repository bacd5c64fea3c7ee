"""Checks of numbers that a caller gives, plain or of NumPy, before the core uses them."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from cyclosweep.errors import InputError

__all__ = ["LOADS_TN", "checked_loads", "finite_number", "plain", "real_numbers", "whole_number"]


LOADS_TN = (1e-6, 1e6)
"""Least and greatest load [nominal torques] of a twist."""


def plain(value: object) -> object:
    """Return the Python value of a NumPy scalar, and anything else as it is.

    Parameters
    ----------
    value : object
        For example ``numpy.int64(8)``.

    Returns
    -------
    object

    Examples
    --------
    >>> plain(np.int64(8))
    8
    """
    return value.item() if isinstance(value, np.generic) else value


def real_numbers(name: str, values: Iterable[object]) -> list[float]:
    """Return values as floats, and refuse what is no real number; NaN and infinities pass.

    Parameters
    ----------
    name : str
        What they are called in a message.
    values : iterable
        Integers and floats, plain or of NumPy.

    Returns
    -------
    list of float

    Raises
    ------
    InputError
        For a truth value, a text or anything else that is no number.

    Examples
    --------
    >>> real_numbers("output_pin_count", np.array([6, 8]))
    [6.0, 8.0]
    """
    numbers = []
    for given in values:
        value = plain(given)
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise InputError(f"{name}: found {value!r}, expected a number")
        try:
            numbers.append(float(value))
        except OverflowError:
            raise InputError(f"{name}: found an integer beyond the range of floats") from None
    return numbers


def finite_number(name: str, value: object) -> float:
    """Return a value as a float, and refuse what is no finite number.

    Parameters
    ----------
    name : str
        What it is called in a message.
    value : object
        A number, plain or of NumPy.

    Returns
    -------
    float

    Raises
    ------
    InputError
        For NaN, an infinity, a truth value, a text or anything else that is no number.

    Examples
    --------
    >>> finite_number("crank_rad", np.float32(0.5))
    0.5
    """
    given = plain(value)
    if isinstance(given, (int, float)) and not isinstance(given, bool):
        number = real_numbers(name, [given])[0]
        if math.isfinite(number):
            return number
    raise InputError(f"{name}: found {given!r}, expected a finite number")


def whole_number(name: str, value: object, *, least: int = 0, most: int | None = None) -> int:
    """Return a value as a Python integer, and refuse what is none or lies outside a range.

    Parameters
    ----------
    name : str
        What it is called in a message.
    value : object
        An integer, plain or of NumPy.
    least, most : int
        Range, both ends included; without `most` it has no upper end.

    Returns
    -------
    int

    Raises
    ------
    InputError
        For a float, a truth value, a text, or an integer outside the range.

    Examples
    --------
    >>> whole_number("seed", np.uint64(7))
    7
    """
    number = plain(value)
    span = f"from {least}" if most is None else f"from {least} to {most}"
    if (least, most) == (1, None):
        span = "above zero"
    if isinstance(number, bool) or not isinstance(number, int):
        raise InputError(f"{name}: found {number!r}, expected a whole number {span}")
    if number < least or (most is not None and number > most):
        raise InputError(f"{name}: found {number}, expected a whole number {span}")
    return number


def checked_loads(values: object, *, allow_zero: bool = False) -> tuple[float, ...]:
    """Return loads as floats, and refuse those under which no twist is determined.

    Parameters
    ----------
    values : iterable of float
        Loads in nominal torques [1]; negative ones act in the other direction.
    allow_zero : bool
        Accept a load of zero, under which the twist is anywhere within the free play.

    Returns
    -------
    tuple of float

    Raises
    ------
    InputError
        For what is no number, NaN, a load beyond :data:`LOADS_TN` or, without `allow_zero`, zero.

    Examples
    --------
    >>> checked_loads([1, np.float64(-4.5)])
    (1.0, -4.5)
    """
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise InputError(f"loads_tn: found {values!r}, expected a list of loads")
    numbers = real_numbers("loads_tn", values)
    for load in numbers:
        if not math.isfinite(load) or (load == 0 and not allow_zero):
            raise InputError(
                f"loads_tn: found {load:g}, expected loads above zero, or below zero for the "
                "other direction"
            )
        if load != 0 and not LOADS_TN[0] <= abs(load) <= LOADS_TN[1]:
            raise InputError(
                f"loads_tn: found {load:g}, expected nominal torques from {LOADS_TN[0]:g} to "
                f"{LOADS_TN[1]:g}"
            )
    return tuple(load + 0.0 for load in numbers)  # -0.0 and 0.0 are one load
