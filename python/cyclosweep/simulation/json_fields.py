"""Typed look-ups in a decoded JSON object; what is missing or of the wrong type is one line."""

import json
import math
from collections.abc import Mapping
from typing import Any, TypeVar

from cyclosweep.errors import InputError

T = TypeVar("T")


def number_of(content: Mapping[str, Any], key: str, default: float | None = None) -> float:
    """Finite number under a key.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the number.
    default : float, optional
        What is taken where the key is missing; without it a missing key is an error.

    Returns
    -------
    float

    Raises
    ------
    InputError
        The key is missing, or its value is no finite number.
    """
    if key not in content:
        if default is None:
            raise InputError(f"{key}: missing, expected a number")
        return default
    value = content[key]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{key}: found {_short(value)}, expected a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{key}: found {_short(value)}, expected a finite number")
    return number


def count_of(content: Mapping[str, Any], key: str, default: int) -> int:
    """Positive whole number under a key.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the number.
    default : int
        What is taken where the key is missing.

    Returns
    -------
    int

    Raises
    ------
    InputError
        The value is no positive whole number.
    """
    value = content.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(f"{key}: found {_short(value)}, expected a positive whole number")
    return value


def text_of(content: Mapping[str, Any], key: str, default: str | None = None) -> str:
    """Text under a key.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the text.
    default : str, optional
        What is taken where the key is missing; without it a missing key is an error.

    Returns
    -------
    str

    Raises
    ------
    InputError
        The key is missing, or its value is no text.
    """
    return _of_type(content, key, default, str, "a text")


def object_of(
    content: Mapping[str, Any], key: str, default: Mapping[str, Any] | None = None
) -> Mapping[str, Any]:
    """Object under a key.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the inner object.
    default : mapping, optional
        What is taken where the key is missing; without it a missing key is an error.

    Returns
    -------
    mapping

    Raises
    ------
    InputError
        The key is missing, or its value is no object.
    """
    return _of_type(content, key, default, dict, "an object")


def list_of(content: Mapping[str, Any], key: str) -> list[Any]:
    """List under a key; empty where the key is missing.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the list.

    Returns
    -------
    list

    Raises
    ------
    InputError
        The value is no list.
    """
    return _of_type(content, key, [], list, "a list")


def numbers_of(content: Mapping[str, Any], key: str) -> tuple[float, ...]:
    """List of finite numbers under a key; empty where the key is missing.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the list.

    Returns
    -------
    tuple of float

    Raises
    ------
    InputError
        The value is no list, or holds what is no finite number; its place from one is said.
    """
    return tuple(
        number_of({f"{key} {place}": value}, f"{key} {place}")
        for place, value in enumerate(list_of(content, key), 1)
    )


def flag_of(content: Mapping[str, Any], key: str) -> bool:
    """Truth value under a key; false where the key is missing.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the value.

    Returns
    -------
    bool

    Raises
    ------
    InputError
        The value is neither true nor false.
    """
    return _of_type(content, key, False, bool, "true or false")


def _of_type(
    content: Mapping[str, Any], key: str, default: object, kind: type[T], expected: str
) -> T:
    """Value of one type under a key.

    Parameters
    ----------
    content : mapping
        Decoded object.
    key : str
        Name of the value.
    default : object
        What is taken where the key is missing; None makes a missing key an error.
    kind : type
        What the value has to be.
    expected : str
        The same in words.

    Returns
    -------
    object of that type

    Raises
    ------
    InputError
        The key is missing, or its value is of another type.
    """
    if key not in content and default is None:
        raise InputError(f"{key}: missing, expected {expected}")
    value = content.get(key, default)
    if not isinstance(value, kind):
        raise InputError(f"{key}: found {_short(value)}, expected {expected}")
    return value


def _short(value: object) -> str:
    """Value as it would stand in the file, cut to a few characters."""
    text = json.dumps(value)
    return text if len(text) <= 40 else text[:37] + "..."
