"""The bench: one specimen through one load programme, reading by reading, without sensor noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.aliens import ALIASES, ALIENS
from cyclosweep_challenge.rig.balance import (
    Balanced,
    CreepState,
    Resistance,
    effective_lapse,
    solve_free,
    solve_resisted,
)
from cyclosweep_challenge.rig.elastic import ElasticLaw
from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM
from cyclosweep_challenge.rig.programme import Programme
from cyclosweep_challenge.rig.specimen import VOCABULARY, Specimen

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Response:
    """What a perfect sensor would have read.

    Attributes
    ----------
    angle_deg : array
        Indicated angle at every sample of the programme [deg].
    recorded : array of bool
        Samples at which the shaft stood on the flank its torque pulls to.
    shown_torque_nm : array
        Torque as the rig's load cell shows it [N m].
    """

    angle_deg: Array
    recorded: NDArray[np.bool_]
    shown_torque_nm: Array


def measure(specimen: Specimen, programme: Programme, amplitudes: dict[str, float]) -> Response:
    """Turn one specimen through one programme.

    Parameters
    ----------
    specimen : Specimen
        The drive with its shapes.
    programme : Programme
        Torque, clock, trial, position and temperature.
    amplitudes : dict
        Amplitude of each cause at work, by name; names left out are absent. Units: N m for
        ``friction_hysteresis``, a ratio for ``load_dependent_friction``,
        ``clearance_takeup`` (stiffness that closes late) and ``phase_dependent_compliance``
        (rms of the pins' stiffness over a turn), N m s/deg for ``viscous_drag``, deg for the
        rest: at rated torque, over 10 K, or as rms over a turn, as each cause's file says.

    Returns
    -------
    Response
        Noise-free readings. With no amplitude it is ``datum + play sign(T) + compliance T``.

    Raises
    ------
    ValueError
        If a name is unknown or an amplitude is not physical.
    """
    unknown = set(amplitudes) - set(VOCABULARY) - set(ALIENS) - set(ALIASES)
    if unknown:
        raise ValueError(f"cause: found {sorted(unknown)!r}, expected names the rig knows")
    side = np.sign(programme.torque_nm)
    laws, law_of = _laws(specimen, programme, amplitudes)
    balanced = _balance(specimen, programme, amplitudes, laws, law_of)
    twist = np.empty(len(programme))
    for number, law in enumerate(laws):
        here = law_of == number
        twist[here] = law.twist(balanced.carried_nm[here])
    angle = specimen.datum_deg + side * (specimen.free_play_deg + twist) + balanced.crept_deg
    angle = angle + _offsets(specimen, programme, amplitudes, side)
    for name in ALIENS:
        if amplitudes.get(name, 0.0) != 0.0:
            angle = angle + amplitudes[name] * specimen.alien.added(name, programme, angle)
    indicated = specimen.dial.indicated(angle, amplitudes.get("dial_eccentricity", 0.0))
    shown = programme.torque_nm * (1.0 + amplitudes.get("torque_gain", 0.0))
    shown = shown + amplitudes.get("torque_offset", 0.0)
    return Response(indicated, balanced.on_flank, shown)


def _laws(
    specimen: Specimen, programme: Programme, amplitudes: dict[str, float]
) -> tuple[list[ElasticLaw], NDArray[np.int64]]:
    """One elastic law a mesh position, and which of them holds at each sample."""
    pulsation = amplitudes.get("phase_dependent_compliance", 0.0)
    largest = 1.6 * float(np.abs(programme.torque_nm).max())
    if pulsation == 0.0:
        law = ElasticLaw(specimen, amplitudes, 1.0, largest)
        return [law], np.zeros(len(programme), dtype=np.int64)
    positions, where = np.unique(programme.crank_deg, return_inverse=True)
    factors = 1.0 + pulsation * specimen.pins.stiffness_factor(positions)
    if np.any(factors < 0.1):
        raise ValueError("phase_dependent_compliance: the pins would lose all their stiffness")
    return [ElasticLaw(specimen, amplitudes, float(f), largest) for f in factors], where


def _balance(
    specimen: Specimen,
    programme: Programme,
    amplitudes: dict[str, float],
    laws: list[ElasticLaw],
    law_of: NDArray[np.int64],
) -> Balanced:
    """Solve the torque balance by whichever way the causes at work need."""
    final = amplitudes.get("creep", 0.0)
    creep = CreepState([], [], [])
    if final != 0.0:
        steps = [specimen.chain.step(float(t), final) for t in effective_lapse(programme)]
        creep = CreepState([s[0] for s in steps], [s[1] for s in steps], [s[2] for s in steps])
    resistance = Resistance(
        specimen.friction,
        specimen.load_friction,
        amplitudes.get("friction_hysteresis", 0.0),
        amplitudes.get("load_dependent_friction", 0.0),
        amplitudes.get("viscous_drag", 0.0),
    )
    if resistance.absent:
        return solve_free(programme, creep)
    return solve_resisted(
        programme,
        laws,
        law_of,
        specimen.free_play_deg,
        resistance,
        creep,
        RATED_INPUT_TORQUE_NM,
    )


def _offsets(
    specimen: Specimen, programme: Programme, amplitudes: dict[str, float], side: Array
) -> Array:
    """Angles that come on top of the twist [deg]."""
    total = np.zeros(len(programme))
    if amplitudes.get("datum_drift"):
        total += specimen.datum.offset(programme, amplitudes["datum_drift"])
    if amplitudes.get("transmission_error"):
        total += specimen.profile.error(programme.crank_deg, amplitudes["transmission_error"])
    if amplitudes.get("thermal_drift"):
        total += specimen.warmth.offset(programme, side, amplitudes["thermal_drift"])
    if amplitudes.get("load_asymmetry"):
        total += specimen.side_load.turn(programme.torque_nm, amplitudes["load_asymmetry"])
    if amplitudes.get("rig_compliance"):
        total += amplitudes["rig_compliance"] * programme.torque_nm / RATED_INPUT_TORQUE_NM
    return total
