"""Remarks on calibrated values far from the drive file, and on columns read against their names."""

from dataclasses import dataclass
from typing import Literal

from cyclosweep.result.part import Part

Quantity = Literal["compliance", "free_play", "datum", "angle_modulo", "columns", "range"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Doubt(Part):
    """One calibrated value far from nominal, and the mistakes that would explain it."""

    quantity: Quantity
    """Which value; columns: names or units of the file speak against its settings; range: a sensor
    is saturated."""
    found: float | None = None
    """What was found [deg/(N m) or deg]."""
    nominal: float | None = None
    """What the drive file says [deg/(N m) or deg]."""
    factor: float | None = None
    """Found over nominal; null where there is no nominal value."""
    suggests: tuple[str, ...] = ()
    """Mistakes that would give about this factor, the likeliest first; empty where none does."""
    text: str
    """The remark in words."""
