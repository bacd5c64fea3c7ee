"""Parameters of an effect, and what a shape may consist of."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.history import Floats

Shape = Mapping[str, float]
"""Values of the parameters that enter an effect's response nonlinearly, by name."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of an effect.

    Attributes
    ----------
    name, unit, meaning : str
        As they stand in files and reports.
    lower, upper : float
        Where it can lie, in its unit.
    logarithmic : bool
        Whether it is fitted by its logarithm.
    """

    name: str
    unit: str
    meaning: str
    lower: float = -np.inf
    upper: float = np.inf
    logarithmic: bool = False


@dataclass(frozen=True, slots=True)
class ShapeForm:
    """Names that make up one kind of shape.

    Attributes
    ----------
    needed : tuple of str
        Names that have to be there.
    optional : tuple of str
        Names that may be there.
    numbered : str
        Pattern such as ``order_{}`` of names numbered 1, 2, ... without a gap, at least one.
    """

    needed: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    numbered: str = ""

    def ordered(self, names: Collection[str]) -> list[str] | None:
        """Names in the order of this form; None where they do not make it up."""
        found = [*self.needed, *(name for name in self.optional if name in names)]
        if self.numbered:
            count = max(len(names) - len(found), 1)
            found += [self.numbered.format(k + 1) for k in range(count)]
        return found if set(found) == set(names) else None

    def __str__(self) -> str:
        parts = [*self.needed, *(f"[{name}]" for name in self.optional)]
        if self.numbered:
            parts.append(f"{self.numbered.format(1)} ...")
        return " ".join(parts)


def in_form(shape: Shape, forms: Sequence[ShapeForm]) -> Shape:
    """Return a shape with its parameters in the order of the form that it has.

    Parameters
    ----------
    shape : mapping
        Shape parameters by name, in any order.
    forms : sequence of ShapeForm
        What a shape may consist of.

    Returns
    -------
    mapping

    Raises
    ------
    InputError
        A shape parameter is unknown or missing.
    """
    for form in forms:
        names = form.ordered(shape)
        if names is not None:
            return {name: shape[name] for name in names}
    expected = ", or ".join(map(str, forms))
    raise InputError(f"shape: found {' '.join(shape) or 'nothing'}, expected {expected}")


def listed(name: str, values: Iterable[float], most: int = 4) -> Shape | None:
    """Shape ``name_1 ... name_k`` of distinct values in order.

    Parameters
    ----------
    name : str
        Pattern of the names, such as ``order_{}``.
    values : iterable of float
        Values in any order.
    most : int
        Most values that are accepted.

    Returns
    -------
    mapping or None
        None for no values or too many.
    """
    distinct = sorted(set(map(float, values)))
    if not 0 < len(distinct) <= most:
        return None
    return {name.format(k): value for k, value in enumerate(distinct, 1)}


def spread(values: Floats) -> float:
    """Range of values; zero where there are none."""
    return float(np.ptp(values)) if len(values) else 0.0
