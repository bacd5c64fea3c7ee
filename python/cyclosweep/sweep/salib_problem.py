"""Problems of SALib (names, bounds, distributions) read and written."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from cyclosweep.design.numbers import real_numbers
from cyclosweep.errors import InputError
from cyclosweep.sweep.axes import is_count
from cyclosweep.sweep.distributions import (
    Distribution,
    log_uniform,
    normal,
    triangular,
    uniform,
)

if TYPE_CHECKING:
    from cyclosweep.sweep.axes import Axis

__all__ = ["distributions_of", "problem_of"]

_NUMBERS = {"unif": 2, "norm": 2, "truncnorm": 4, "triang": 3, "logunif": 2}
"""Names of SALib's distributions that a space has, and how many bounds each takes."""


def distributions_of(problem: Mapping[str, Any]) -> dict[str, Distribution | tuple[float, float]]:
    """Read the axes of a problem.

    Parameters
    ----------
    problem : mapping
        SALib's ``names``, ``bounds`` and, unless all are uniform, ``dists``.

    Returns
    -------
    dict
        What :meth:`~cyclosweep.sweep.space.Space.sobol` takes as axes.

    Raises
    ------
    InputError
        For a missing key, groups, or a distribution that a space does not have.
    """
    for key in ("names", "bounds"):
        if key not in problem:
            raise InputError(f"problem: no {key}, expected names and bounds as of SALib")
    names, bounds = list(problem["names"]), list(problem["bounds"])
    dists = list(problem.get("dists") or ["unif"] * len(names))
    groups = problem.get("groups")
    if groups is not None and list(groups) != names:
        raise InputError("problem.groups: found groups, expected each input by itself")
    if not len(names) == len(bounds) == len(dists) == problem.get("num_vars", len(names)):
        raise InputError(
            f"problem: found {len(names)} names, {len(bounds)} bounds and {len(dists)} dists, "
            "expected as many of each as num_vars says"
        )
    return {
        name: _distribution(name, dist, numbers)
        for name, dist, numbers in zip(names, dists, bounds, strict=True)
    }


def _distribution(
    name: str, dist: str, given: Sequence[float]
) -> Distribution | tuple[float, float]:
    where = f"problem.{name}"
    if dist not in _NUMBERS:
        raise InputError(f"{where}: found {dist!r}, expected one of {', '.join(_NUMBERS)}")
    numbers = real_numbers(where, given)
    if len(numbers) != _NUMBERS[dist]:
        raise InputError(f"{where}: found {len(numbers)} bounds, expected {_NUMBERS[dist]}")
    try:
        if dist == "norm":
            return normal(*numbers)
        if dist == "truncnorm":
            low, high, mean, sd = numbers
            return normal(mean, sd, low, high)
        low, high = numbers[:2]
        if dist == "triang":
            return triangular(low, low + numbers[2] * (high - low), high)
        if dist == "logunif":
            return log_uniform(low, high)
        return (low, high) if is_count(name) else uniform(low, high)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def problem_of(axes: Iterable[Axis]) -> dict[str, Any]:
    """Write axes as a problem.

    Parameters
    ----------
    axes : iterable of Axis
        Ranges and distributions.

    Returns
    -------
    dict
        ``num_vars``, ``names``, ``bounds`` and ``dists``.

    Raises
    ------
    InputError
        For a list of values, steps or whole numbers.
    """
    names, bounds, dists = [], [], []
    for axis in axes:
        numbers = [float(number) for number in axis.numbers]
        if axis.form == "normal":
            mean, sd, low, high = numbers[:4]
            is_whole = math.isinf(low) and math.isinf(high)
            dist, bound = ("norm", [mean, sd]) if is_whole else ("truncnorm", [low, high, mean, sd])
        elif axis.form == "triangular":
            low, mode, high = numbers
            dist, bound = "triang", [low, high, (mode - low) / (high - low)]
        elif axis.form in ("interval", "log-uniform"):
            dist, bound = "unif" if axis.form == "interval" else "logunif", numbers
        else:
            raise InputError(
                f"{axis.name}: found single values, for which SALib has no distribution; expected "
                "a range or a distribution"
            )
        names.append(axis.name)
        bounds.append(bound)
        dists.append(dist)
    return {"num_vars": len(names), "names": names, "bounds": bounds, "dists": dists}
