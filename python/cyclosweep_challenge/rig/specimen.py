"""One drive on the bench: its own stiffness, play, zero and every shape an effect can take."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cyclosweep_challenge.rig.aliens import AlienShape
from cyclosweep_challenge.rig.bristles import Bristles
from cyclosweep_challenge.rig.creep import CreepChain
from cyclosweep_challenge.rig.datum import Datum
from cyclosweep_challenge.rig.dial import Dial
from cyclosweep_challenge.rig.joint import Joint
from cyclosweep_challenge.rig.nominal import COMPLIANCE_DEG_PER_NM, FREE_PLAY_DEG
from cyclosweep_challenge.rig.pins import Pins
from cyclosweep_challenge.rig.profile import Profile
from cyclosweep_challenge.rig.sideload import SideLoad
from cyclosweep_challenge.rig.warmth import Warmth

VOCABULARY = (
    "friction_hysteresis",
    "load_dependent_friction",
    "contact_stiffening",
    "clearance_takeup",
    "overload_softening",
    "datum_drift",
    "creep",
    "phase_dependent_compliance",
    "transmission_error",
    "thermal_drift",
    "viscous_drag",
    "load_asymmetry",
    "dial_eccentricity",
)
"""Names of the effects a diagnosis may give."""

EITHER_SIGN = frozenset(
    {
        "datum_drift",
        "phase_dependent_compliance",
        "transmission_error",
        "thermal_drift",
        "load_asymmetry",
        "dial_eccentricity",
        "slip_event",
        "load_bump",
        "hum",
        "telegraph_datum",
        "cross_talk",
        "wear_step",
        "torque_offset",
        "torque_gain",
    }
)
"""Causes whose amplitude physics leaves free to be negative."""


@dataclass(frozen=True)
class Specimen:
    """Parameters and shapes of one drive; amplitudes are given to the rig apart.

    Attributes
    ----------
    compliance_deg_per_nm, free_play_deg, datum_deg : float
        Calibration of this drive on this bench: compliance seen at the input [deg/(N m)], half
        the free play [deg] and zero of the dial [deg].
    pins, joint, friction, load_friction, chain, datum, profile, warmth, side_load, dial, alien
        Shapes of what may be added; an amplitude of zero takes each of them away exactly.
    """

    compliance_deg_per_nm: float
    free_play_deg: float
    datum_deg: float
    pins: Pins
    joint: Joint
    friction: Bristles
    load_friction: Bristles
    chain: CreepChain
    datum: Datum
    profile: Profile
    warmth: Warmth
    side_load: SideLoad
    dial: Dial
    alien: AlienShape

    @classmethod
    def draw(cls, rng: np.random.Generator, *, far: bool = False) -> Specimen:
        """Draw a drive near the nominal one, or, if ``far``, one that is nothing like it."""
        if far:
            scale = float(np.exp(rng.choice([-1.0, 1.0]) * rng.uniform(0.45, 1.0)))
            play = FREE_PLAY_DEG * float(rng.choice([rng.uniform(0.3, 0.7), rng.uniform(1.3, 2.0)]))
            zero = float(rng.choice([-1.0, 1.0]) * rng.uniform(8.0, 25.0))
        else:
            scale = float(np.exp(np.clip(rng.normal(0.0, 0.1), -0.25, 0.25)))
            play = FREE_PLAY_DEG * float(1.0 + np.clip(rng.normal(0.0, 0.06), -0.15, 0.15))
            zero = float(rng.uniform(-2.5, 2.5))
        return cls(
            compliance_deg_per_nm=COMPLIANCE_DEG_PER_NM * scale,
            free_play_deg=play,
            datum_deg=zero,
            pins=Pins.draw(rng),
            joint=Joint.draw(rng),
            friction=Bristles.draw(rng, 1.2, 5.0),
            # At rated load; a bristle's slip distance grows with its load.
            load_friction=Bristles.draw(rng, 0.5, 2.0),
            chain=CreepChain.draw(rng),
            datum=Datum.draw(rng),
            profile=Profile.draw(rng),
            warmth=Warmth.draw(rng),
            side_load=SideLoad.draw(rng),
            dial=Dial.draw(rng),
            alien=AlienShape.draw(rng),
        )
