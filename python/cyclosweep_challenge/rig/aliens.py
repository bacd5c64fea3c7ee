"""Causes outside the vocabulary, and causes that a calibration absorbs completely."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM
from cyclosweep_challenge.rig.programme import Programme

Array = NDArray[np.float64]

ALIENS = (
    "slip_event",
    "load_bump",
    "hum",
    "telegraph_datum",
    "saturation",
    "cross_talk",
    "wear_step",
)
"""Causes outside the vocabulary: the right answer is an unknown with its place."""

ALIASES = ("rig_compliance", "torque_offset", "torque_gain")
"""Causes that a calibration absorbs whole: the right answer is that they cannot be tested."""


@dataclass(frozen=True)
class AlienShape:
    """Where and how the causes outside the vocabulary act, as fractions of the recording.

    Attributes
    ----------
    moment : float
        Share of the samples before a sudden change [-].
    load : float
        Torque of the bump over the largest torque, signed [-].
    width : float
        Width of the bump over the largest torque [-].
    frequency_hz, phase_rad : float
        The hum.
    dwell_s : float
        Mean time between two jumps of the telegraph [s].
    ceiling : float
        Angle above which the sensor compresses, over the largest angle [-].
    telegraph_seed : int
        Seed of the jumps.
    """

    moment: float
    load: float
    width: float
    frequency_hz: float
    phase_rad: float
    dwell_s: float
    ceiling: float
    telegraph_seed: int

    @classmethod
    def draw(cls, rng: np.random.Generator) -> AlienShape:
        """Draw the shapes of one specimen."""
        return cls(
            moment=float(rng.uniform(0.25, 0.75)),
            load=float(rng.choice([-1.0, 1.0]) * rng.uniform(0.25, 0.75)),
            width=float(rng.uniform(0.03, 0.08)),
            frequency_hz=float(np.exp(rng.uniform(np.log(0.008), np.log(0.4)))),
            phase_rad=float(rng.uniform(0.0, 2.0 * np.pi)),
            dwell_s=float(rng.uniform(40.0, 180.0)),
            ceiling=float(rng.uniform(0.6, 0.85)),
            telegraph_seed=int(rng.integers(2**31)),
        )

    def added(self, name: str, programme: Programme, angle_deg: Array) -> Array:
        """Angle that a cause of unit amplitude adds to every sample [deg].

        Raises
        ------
        ValueError
            If the name is none of ``ALIENS``.
        """
        torque = programme.torque_nm
        largest = float(np.abs(torque).max())
        count = len(programme)
        after = np.arange(count) >= int(self.moment * count)
        if name == "slip_event":
            return np.where(after, 1.0, 0.0)
        if name == "wear_step":
            return np.where(after, np.sign(torque), 0.0)
        if name == "load_bump":
            distance = (torque - self.load * largest) / (self.width * largest)
            return np.exp(-0.5 * distance**2)
        swing = np.sin(2.0 * np.pi * self.frequency_hz * programme.time_s + self.phase_rad)
        if name == "hum":
            return swing
        if name == "cross_talk":
            return swing * torque / RATED_INPUT_TORQUE_NM
        if name == "saturation":
            limit = self.ceiling * float(np.abs(angle_deg).max())
            over = np.maximum(np.abs(angle_deg) - limit, 0.0)
            return -np.sign(angle_deg) * over / 10.0
        if name == "telegraph_datum":
            return self._telegraph(programme.time_s)
        raise ValueError(f"cause: found {name!r}, expected one of {', '.join(ALIENS)}")

    def _telegraph(self, time_s: Array) -> Array:
        """Zero or one, jumping at random times."""
        rng = np.random.default_rng(self.telegraph_seed)
        lapse = np.diff(time_s, prepend=time_s[:1])
        # A rest between runs counts as one dwell at most, or the state would be fresh each run.
        jump = rng.random(time_s.size) < -np.expm1(-np.minimum(lapse, self.dwell_s) / self.dwell_s)
        return (np.cumsum(jump) % 2).astype(float)
