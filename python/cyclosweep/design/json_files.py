"""Reading of JSON that holds one object: from a file, from its text, or decoded already."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cyclosweep.errors import InputError

__all__ = ["JsonSource", "json_object", "name_of"]

JsonSource = str | Path | Mapping[str, Any]
"""A file, the text of one, or its decoded content."""


def json_object(source: JsonSource) -> dict[str, Any]:
    """Read a JSON object.

    Parameters
    ----------
    source : str, Path or mapping
        Path of a file in UTF-8; a text that begins with ``{`` is the JSON itself; a mapping is
        taken as it is.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        It cannot be read, is no JSON object, repeats a key, or holds NaN or Infinity.

    Examples
    --------
    >>> json_object('{"ratio": 87}')
    {'ratio': 87}
    """
    if isinstance(source, Mapping):
        return dict(source)
    if not isinstance(source, (str, Path)):
        raise InputError(f"found {type(source).__name__}, expected a file, JSON or a mapping")
    try:
        text = source if _is_json(source) else Path(source).read_text(encoding="utf-8")
        content = json.loads(str(text), object_pairs_hook=_distinct, parse_constant=_refuse)
    except (OSError, UnicodeDecodeError, ValueError, RecursionError) as error:
        raise InputError(f"cannot be read as JSON: {error}") from error
    if not isinstance(content, dict):
        raise InputError("schema: expected an object")
    return content


def name_of(source: JsonSource) -> str:
    """How a message names a source: the file, or what it is instead.

    Parameters
    ----------
    source : str, Path or mapping
        What is read.

    Returns
    -------
    str
    """
    if isinstance(source, (str, Path)) and not _is_json(source):
        return str(source)
    return "JSON"


def _is_json(source: str | Path) -> bool:
    return isinstance(source, str) and source.lstrip().startswith("{")


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Object of these pairs, each key once."""
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"{key}: given twice")
        found[key] = value
    return found


def _refuse(constant: str) -> float:
    raise ValueError(f"{constant}: expected a finite number")
