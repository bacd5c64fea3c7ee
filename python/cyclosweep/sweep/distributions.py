"""Named distributions of an input: how its values are drawn, in studies and as tolerances."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from cyclosweep.design.numbers import finite_number, real_numbers
from cyclosweep.errors import InputError, did_you_mean

__all__ = [
    "KINDS",
    "Distribution",
    "Form",
    "distribution_from",
    "log_uniform",
    "normal",
    "triangular",
    "uniform",
]

Kind = Literal["uniform", "normal", "triangular", "log-uniform"]
Form = Literal["list", "linspace", "interval", "whole", "normal", "triangular", "log-uniform"]
"""How the core is told the values of an axis."""

KINDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "uniform": (("from", "to"), ()),
    "normal": (("sd",), ("mean", "from", "to")),
    "triangular": (("from", "to"), ("mode",)),
    "log-uniform": (("from", "to"), ()),
}
"""Names of the distributions, with the keys that each needs and those that it may have."""

_LEAST_SHARE = 1e-6
"""A normal distribution of which less is left between its ends is refused: its quantiles lose
digits, and hardly anyone means it."""


@dataclass(frozen=True)
class Distribution:
    """How the values of an input are spread; see :func:`uniform` and the others.

    Attributes
    ----------
    kind : {"uniform", "normal", "triangular", "log-uniform"}
        Its name.
    low, high : float
        Ends, in the input's unit; infinite for a normal distribution without ends.
    middle : float
        Mean of a normal distribution, most frequent value of a triangular one; else NaN.
    sd : float
        Standard deviation of a normal distribution (before its ends are cut off); else NaN.
    """

    kind: Kind
    low: float
    high: float
    middle: float = math.nan
    sd: float = math.nan

    def core(self) -> tuple[Form, npt.NDArray[np.float64]]:
        """Form and numbers by which the core knows it, as those of an axis."""
        if self.kind == "normal":
            shares = [_below((end - self.middle) / self.sd) for end in (self.low, self.high)]
            return "normal", np.array([self.middle, self.sd, self.low, self.high, *shares])
        if self.kind == "triangular":
            return "triangular", np.array([self.low, self.middle, self.high])
        ends = np.array([self.low, self.high])
        return ("interval", ends) if self.kind == "uniform" else ("log-uniform", ends)


def uniform(low: float, high: float) -> Distribution:
    """Every value from ``low`` to ``high`` equally often.

    Parameters
    ----------
    low, high : float
        Ends, in the input's unit.

    Returns
    -------
    Distribution

    Raises
    ------
    InputError
        Unless both are finite and in order.
    """
    return Distribution("uniform", *_ends("uniform", low, high))


def normal(
    mean: float = 0.0, sd: float = 1.0, low: float = -math.inf, high: float = math.inf
) -> Distribution:
    """Normally distributed, cut off at the ends where they are given.

    Parameters
    ----------
    mean, sd : float
        Mean and standard deviation of the whole distribution, in the input's unit.
    low, high : float
        Ends beyond which nothing is drawn.

    Returns
    -------
    Distribution

    Raises
    ------
    InputError
        For a standard deviation that is not above zero, ends that are not in order, or ends
        between which less than 1e-6 of the distribution lies.
    """
    mean, sd = finite_number("normal: mean", mean), finite_number("normal: sd", sd)
    if not sd > 0:
        raise InputError(f"normal: found a standard deviation of {sd:g}, expected more than 0")
    low, high = real_numbers("normal: ends", [low, high])
    if not low < high:
        raise InputError(f"normal: found {low:g} to {high:g}, expected low < high")
    if _below((high - mean) / sd) - _below((low - mean) / sd) < _LEAST_SHARE:
        raise InputError(
            f"normal: found {low:g} to {high:g} about a mean of {mean:g}, where almost nothing of "
            "the distribution lies"
        )
    return Distribution("normal", low, high, mean, sd)


def triangular(low: float, mode: float, high: float) -> Distribution:
    """Most often ``mode``, less and less often towards the ends.

    Parameters
    ----------
    low, mode, high : float
        Lower end, most frequent value and upper end, in the input's unit.

    Returns
    -------
    Distribution

    Raises
    ------
    InputError
        Unless they are finite and in order.
    """
    low, high = _ends("triangular", low, high)
    mode = finite_number("triangular: mode", mode)
    if not low <= mode <= high:
        raise InputError(f"triangular: found a mode of {mode:g}, expected {low:g} to {high:g}")
    return Distribution("triangular", low, high, mode)


def log_uniform(low: float, high: float) -> Distribution:
    """The logarithm uniformly distributed: equally often from 1 to 10 as from 10 to 100.

    Parameters
    ----------
    low, high : float
        Ends above zero, in the input's unit.

    Returns
    -------
    Distribution

    Raises
    ------
    InputError
        Unless they are above zero, finite and in order.
    """
    low, high = _ends("log-uniform", low, high)
    if not low > 0:
        raise InputError(f"log-uniform: found {low:g} to {high:g}, expected ends above zero")
    return Distribution("log-uniform", low, high)


def distribution_from(where: str, table: Mapping[str, Any]) -> Distribution:
    """Read a distribution from a table of a TOML file.

    Parameters
    ----------
    where : str
        What a message names: the key of the file.
    table : mapping
        ``{distribution = "normal", mean = 0.5, sd = 0.01}``, also with ``from`` and ``to``;
        ``{distribution = "triangular", from = 0.4, mode = 0.5, to = 0.6}``; ``uniform`` and
        ``log-uniform`` with ``from`` and ``to``.

    Returns
    -------
    Distribution

    Raises
    ------
    InputError
        One line that names the key, what was found and what was expected.
    """
    kind = table.get("distribution", "uniform")
    if kind not in KINDS:
        raise InputError(
            f"{where}.distribution: found {kind!r}, expected one of {', '.join(KINDS)}"
            f"{did_you_mean(kind, KINDS)}"
        )
    needed, optional = KINDS[kind]
    for key in table:
        if key not in (*needed, *optional, "distribution"):
            known = ", ".join((*needed, *optional))
            raise InputError(f"{where}.{key}: not of a {kind} distribution, expected {known}")
    for key in needed:
        if key not in table:
            raise InputError(f"{where}.{key}: missing, expected for a {kind} distribution")
    try:
        if kind == "normal":
            low, high = table.get("from", -math.inf), table.get("to", math.inf)
            return normal(table.get("mean", 0.0), table["sd"], low, high)
        low, high = table["from"], table["to"]
        if kind == "triangular":
            low, high = _ends("triangular", low, high)
            return triangular(low, table.get("mode", (low + high) / 2), high)
        return uniform(low, high) if kind == "uniform" else log_uniform(low, high)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _below(z: float) -> float:
    """Share of a standard normal distribution below ``z``."""
    return 0.5 * math.erfc(-z / math.sqrt(2))


def _ends(kind: str, low: object, high: object) -> tuple[float, float]:
    first, last = finite_number(f"{kind}: low", low), finite_number(f"{kind}: high", high)
    if not first < last:
        raise InputError(f"{kind}: found {first:g} to {last:g}, expected low < high")
    return first, last
