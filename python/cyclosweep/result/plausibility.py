"""Remarks on calibrated values that lie far from what the drive file says."""

from dataclasses import dataclass
from typing import Literal

from cyclosweep.result.part import Part

Quantity = Literal["compliance", "free_play", "datum", "angle_modulo"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Doubt(Part):
    """One calibrated value far from nominal, and the mistakes that would explain it."""

    quantity: Quantity
    """Which value."""
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
