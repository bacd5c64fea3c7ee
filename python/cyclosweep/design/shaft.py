"""The segments of an output shaft, from its free end to the flange."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

import cyclosweep._core as _core
from cyclosweep.design.toml_files import TomlTable

__all__ = ["Cylinder", "Frustum", "Keyway", "NonNegative", "Positive", "Segment", "dimensions"]

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class Keyway(TomlTable):
    """Cylindrical shaft segment with a keyway, Eq. (5).

    Attributes
    ----------
    diameter_mm, length_mm, keyway_depth_mm : float
        Dimensions [mm]; the keyway must not reach the axis.

    Notes
    -----
    ``c = 32 / (pi G) (l + k h l / D) / D^4`` is a reading of an ambiguous print: its form is 85 %
    sure, k = 10 (``keyway_coefficient``) about 75 %. A Saint-Venant torsion solution of standard
    keyways gives k of about 1.2 to 1.3 on the same depth.
    """

    kind: Literal["keyway"] = "keyway"
    diameter_mm: Positive
    length_mm: Positive
    keyway_depth_mm: NonNegative


class Cylinder(TomlTable):
    """Plain cylindrical shaft segment.

    Attributes
    ----------
    diameter_mm, length_mm : float
        Dimensions [mm].
    """

    kind: Literal["cylinder"] = "cylinder"
    diameter_mm: Positive
    length_mm: Positive


class Frustum(TomlTable):
    """Conical shaft segment, Eq. (7).

    Attributes
    ----------
    diameter_mm, end_diameter_mm, length_mm : float
        Diameter at the free end and at the flange end, length [mm].
    """

    kind: Literal["frustum"] = "frustum"
    diameter_mm: Positive
    end_diameter_mm: Positive
    length_mm: Positive


Segment = Annotated[Keyway | Cylinder | Frustum, Field(discriminator="kind")]


def dimensions(
    shaft: tuple[Keyway | Cylinder | Frustum, ...],
) -> Iterator[tuple[str, float]]:
    """Name and value of every dimension of a shaft, as a study's axes call them.

    Parameters
    ----------
    shaft : tuple of Keyway, Cylinder or Frustum
        Segments from the free end to the flange.

    Yields
    ------
    str, float
        Such as ``shaft_2_diameter_mm`` and its value [mm], segment by segment.
    """
    for number, segment in enumerate(shaft, start=1):
        for field in _core.SEGMENT_FIELDS:
            if field in type(segment).model_fields:
                yield f"shaft_{number}_{field}", float(getattr(segment, field))
