"""The ways in which a cause is concealed, and the strata of a challenge."""

from __future__ import annotations

from dataclasses import dataclass

TIERS = {
    "C0": "one effect in the open: the power and naming curves",
    "C1": "one effect of which a calibration hides seven tenths or more",
    "C2": "one effect buried: rms below a third of the noise and below one dial division",
    "C3": "one effect under another ten times as visible",
    "C4": "two or three effects at once, half of them pulling against each other",
    "C5-alien": "a cause that is on nobody's list",
    "C5-removed": "an effect whose entry was taken out of the library",
    "C6": "nothing missing, under every family of nuisance",
    "C7": "an exact alias of the calibration, on this programme or on any",
}
LOUD_TIERS = {
    "C8": "loud: friction of a real rig's size, alone or with up to three effects on top of it",
    "C8-single": "loud: one effect of any kind",
}
"""Tiers of a campaign alone."""


@dataclass(frozen=True)
class Stratum:
    """A kind of case of which a challenge makes many.

    Attributes
    ----------
    tier : str
        One of ``TIERS`` or ``LOUD_TIERS``.
    programme, noise : str
        Load programme and noise family.
    d : tuple of float
        Wanted signal-to-noise of the causes, the first cause first [-]; empty for none.
    weight : int
        Cases of this stratum among those of one full turn of the plan.
    """

    tier: str
    programme: str
    noise: str
    d: tuple[float, ...]
    weight: int

    @property
    def name(self) -> str:
        """Name of the stratum in tables, for instance ``C0/rich/white/d=6``."""
        visible = "+".join(f"{value:g}" for value in self.d)
        return f"{self.tier}/{self.programme}/{self.noise}" + (f"/d={visible}" if visible else "")
