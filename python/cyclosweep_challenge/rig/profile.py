"""Transmission error: pitch errors of the ring pins as the teeth in mesh average them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import RATIO

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """Pitch errors of the ring.

    Attributes
    ----------
    pitch_error : array, shape (88,)
        Error of each ring pin, in units of their spread [-].
    """

    pitch_error: Array

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Profile:
        """Draw the errors of one ring."""
        return cls(rng.normal(0.0, 1.0, RATIO + 1))

    def error(self, crank_deg: Array, size_deg: float) -> Array:
        """Angle error at each crank position [deg]; its rms over a turn is ``size_deg``."""
        turn = np.linspace(0.0, 360.0, 361)[:-1]
        raw = self._average(np.concatenate([turn, crank_deg]))
        about = raw[: turn.size]
        return np.asarray(size_deg * (raw[turn.size :] - about.mean()) / about.std())

    def _average(self, crank_deg: Array) -> Array:
        """Errors weighted by the square of each tooth's arm over the loaded half turn."""
        pins = np.arange(RATIO + 1) * (360.0 / (RATIO + 1))
        arm = np.sin(np.deg2rad(crank_deg[:, None] - pins[None, :]))
        return np.maximum(arm, 0.0) ** 2 @ self.pitch_error
