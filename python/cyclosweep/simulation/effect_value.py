"""An effect with values: an entry of a model, and the twist that it adds."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from cyclosweep.errors import InputError, did_you_mean
from cyclosweep.simulation.effects import Effect, find
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.json_fields import flag_of, number_of, object_of, text_of

__all__ = ["EffectValue", "linear_twist", "twist_with_and_without"]


@dataclass(frozen=True)
class EffectValue:
    """An effect with its shape and the values of its amplitudes.

    Attributes
    ----------
    name : str
        Name of a registered effect.
    shape : mapping
        Shape parameters by name, each in the unit that the effect states.
    amplitudes : tuple of float
        In the order of ``effect.amplitudes(shape)``, each in the unit stated there.
    in_series : bool
        An elastic effect lies in series with the part that friction holds: its twist follows from
        the applied torque, not from the torque that friction leaves.
    """

    name: str
    shape: Mapping[str, float]
    amplitudes: tuple[float, ...]
    in_series: bool = False

    @property
    def effect(self) -> Effect:
        """The registered effect of this name."""
        return find(self.name)

    @property
    def elastic(self) -> bool:
        """Whether the twist follows from the torque that friction leaves alone."""
        return self.effect.elastic and not self.in_series

    def as_dict(self) -> dict[str, Any]:
        """Entry of ``model.json``."""
        parameters = self.effect.amplitudes(self.shape)
        return {
            "name": self.name,
            **({"in_series": True} if self.in_series else {}),
            "shape": dict(self.shape),
            "amplitudes": {
                parameter.name: float(value)
                for parameter, value in zip(parameters, self.amplitudes, strict=False)
            },
        }

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Read an entry of ``model.json``; amplitudes are told apart by name.

        Parameters
        ----------
        content : mapping
            Decoded entry with ``name``, ``shape`` and ``amplitudes``.

        Returns
        -------
        EffectValue

        Raises
        ------
        InputError
            The effect, a shape parameter or an amplitude is unknown, missing or no finite number,
            or a shape parameter is not above zero that has to be.
        """
        try:
            effect = find(text_of(content, "name"))
        except ValueError as error:
            raise InputError(str(error)) from error
        try:
            given = object_of(content, "shape", {})
            shape = effect.known_shape({key: number_of(given, key) for key in given})
            _require_positive(effect, shape)
            in_series = _in_series(effect, content)
            return cls(effect.name, shape, _amplitudes(effect, shape, content), in_series)
        except InputError as error:
            raise InputError(f"{effect.name}: {error}") from error


def _in_series(effect: Effect, content: Mapping[str, Any]) -> bool:
    """Whether an entry lies in series with the part that friction holds.

    Parameters
    ----------
    effect : Effect
        The effect.
    content : mapping
        Entry of ``model.json``.

    Returns
    -------
    bool

    Raises
    ------
    InputError
        The value is neither true nor false, or true for an effect that is not elastic.
    """
    in_series = flag_of(content, "in_series")
    if in_series and not effect.elastic:
        raise InputError("in_series: found true, expected only for an effect of the elastic law")
    return in_series


def _require_positive(effect: Effect, shape: Mapping[str, float]) -> None:
    """Refuse shape parameters that are fitted by their logarithm and are not above zero.

    Parameters
    ----------
    effect : Effect
        The effect.
    shape : mapping of str to float
        Its shape.

    Raises
    ------
    InputError
        A parameter is zero or less.
    """
    for parameter in effect.shape_parameters:
        value = shape.get(parameter.name, 1.0)
        if parameter.logarithmic and value <= 0.0:
            raise InputError(f"{parameter.name}: found {value:g}, expected a number above zero")


def _amplitudes(
    effect: Effect, shape: Mapping[str, float], content: Mapping[str, Any]
) -> tuple[float, ...]:
    """Amplitudes of an entry in the order of the effect.

    Parameters
    ----------
    effect : Effect
        The effect.
    shape : mapping of str to float
        Its shape.
    content : mapping
        Entry of ``model.json``.

    Returns
    -------
    tuple of float
        Each in its own unit.

    Raises
    ------
    InputError
        An amplitude is unknown, missing or no number.
    """
    given = object_of(content, "amplitudes")
    names = [parameter.name for parameter in effect.amplitudes(shape)]
    for name in given:
        if name not in names:
            hint = did_you_mean(name, names)
            raise InputError(f"amplitude {name!r}: unknown, expected {', '.join(names)}{hint}")
    count = len(names) if not effect.fewer_amplitudes(shape) else max(len(given), 1)
    return tuple(number_of(given, name) for name in names[:count])


def linear_twist(effects: Sequence[EffectValue], history: History) -> Floats:
    """Twist that effects other than friction add.

    Parameters
    ----------
    effects : sequence of EffectValue
        Effects with their amplitudes; those that act through slip elements are passed over.
    history : History
        Load history of n samples with the state of the model along it.

    Returns
    -------
    ndarray, shape (n,)
        Twist [deg].
    """
    return twist_with_and_without((), effects, history)[0]


def twist_with_and_without(
    left_out: Collection[EffectValue], effects: Sequence[EffectValue], history: History
) -> tuple[Floats, Floats]:
    """Twist that effects other than friction add, and the same without some of them.

    Parameters
    ----------
    left_out : collection of EffectValue
        Effects that do not count in the second sum.
    effects : sequence of EffectValue
        As of `linear_twist`.
    history : History
        As there.

    Returns
    -------
    ndarray, shape (n,)
        Twist by all of them [deg].
    ndarray, shape (n,)
        Twist without those left out [deg].
    """
    total, without = np.zeros(len(history)), np.zeros(len(history))
    for value in effects:
        if not value.effect.slips:
            seen = history.under_applied_torque if value.in_series else history
            columns = value.effect.columns(seen, value.shape)
            width = min(columns.shape[1], len(value.amplitudes))
            twist = columns[:, :width] @ np.array(value.amplitudes[:width])
            total += twist
            if value not in left_out:
                without += twist
    return total, without
