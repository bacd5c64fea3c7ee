"""What all parts of a result have in common: how their fields become JSON and JSON Schema."""

import math
from typing import Any, ClassVar

from pydantic import ConfigDict

Metadata = dict[str, Any]
"""What a dataclass field says about itself."""

LEFT_OUT: Metadata = {"when_none": "left out"}
"""A field that is left out of the JSON object where it is None; elsewhere None becomes null."""
EMPTY: Metadata = {"when_none": "empty"}
"""A field that becomes an empty object where it is None."""

NORMAL_95 = 1.96
"""Half width of a 95 % interval in standard errors, of a normal distribution."""


class Part:
    """Base of the frozen dataclasses of a result; the strings below fields go into the schema."""

    __slots__ = ()
    __pydantic_config__: ClassVar = ConfigDict(use_attribute_docstrings=True)


def finite(value: float) -> float | None:
    """Return a number, or None for one that JSON does not have.

    Examples
    --------
    >>> finite(0.5), finite(float("inf"))
    (0.5, None)
    """
    return float(value) if math.isfinite(value) else None
