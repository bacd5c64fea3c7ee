"""The answer as JSON, and back."""

import dataclasses
import json
import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from cyclosweep.errors import InputError
from cyclosweep.result.answer import Answer


def plain(value: Any) -> Any:
    """Turn dataclasses, numpy values, tuples and non-finite numbers into what JSON has.

    Examples
    --------
    >>> plain({"range": (1.0, np.float64(2.0)), "error": float("nan")})
    {'range': [1.0, 2.0], 'error': None}
    """
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return _object(value)
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        number = float(value)
        return number if math.isfinite(number) else None
    return value


def _object(value: Any) -> dict[str, Any]:
    """JSON object of a dataclass."""
    found: dict[str, Any] = {}
    for entry in dataclasses.fields(value):
        item = getattr(value, entry.name)
        if item is not None:
            found[entry.name] = plain(item)
            continue
        match entry.metadata.get("when_none"):
            case "left out":
                continue
            case "empty":
                found[entry.name] = {}
            case _:
                found[entry.name] = None
    return found


def content_of(answer: Answer) -> dict[str, Any]:
    """Return the content of ``diagnosis.json`` as plain dictionaries, lists, numbers and texts."""
    return _object(answer)


def json_text(answer: Answer) -> str:
    """Return the text of ``diagnosis.json``."""
    return json.dumps(content_of(answer), indent=1, ensure_ascii=False, allow_nan=False)


@cache
def answer_type() -> TypeAdapter[Answer]:
    """Reader of answers that checks every type."""
    return TypeAdapter(Answer)


def answer_of(content: Mapping[str, Any]) -> Answer:
    """Read the content of a ``diagnosis.json``.

    Parameters
    ----------
    content : mapping
        Parsed JSON. All keys but ``verdict`` may be missing, so that older files can be read.

    Returns
    -------
    Answer

    Raises
    ------
    InputError
        The verdict is missing, or a value is not of its type.

    Examples
    --------
    >>> answer_of({"verdict": "NOTHING_MISSING", "noise": {"sigma_deg": 0.2}}).noise.sigma_deg
    0.2
    """
    optional = {entry.name for entry in dataclasses.fields(Answer) if entry.metadata}
    given = {key: value for key, value in content.items() if value or key not in optional}
    try:
        return answer_type().validate_python(given)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise InputError(f"diagnosis: {place}: {first['msg']}") from error
