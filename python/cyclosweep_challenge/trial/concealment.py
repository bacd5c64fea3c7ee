"""Amplitudes at which each cause has the wanted signal-to-noise ratio d."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.aliens import ALIASES
from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import Programme
from cyclosweep_challenge.rig.rig import Response, measure
from cyclosweep_challenge.rig.specimen import EITHER_SIGN, VOCABULARY, Specimen
from cyclosweep_challenge.trial.signature import Visibility, visibility

Array = NDArray[np.float64]

FIRST_GUESS = {
    "friction_hysteresis": 0.05,
    "load_dependent_friction": 0.01,
    "clearance_takeup": 0.1,
    "phase_dependent_compliance": 0.02,
    "viscous_drag": 0.005,
    "contact_stiffening": 0.8,
}
LARGEST_DEG = 8.0
LARGEST_OFFSET_DEG = 3.0
LARGEST_WARMING_DEG = 8.0
"""Largest change of datum or play over ten kelvins that a bench could show [deg]."""
OFFSETS = frozenset({"datum_drift", "transmission_error", "thermal_drift", "dial_eccentricity"})
TOLERANCE = 2e-3


class ConcealmentError(ValueError):
    """The wanted visibility cannot be had on this specimen and programme."""


@dataclass(frozen=True)
class Concealed:
    """Amplitudes found, and what they do.

    Attributes
    ----------
    amplitudes : dict
        Amplitude of each cause.
    response : Response
        Noise-free readings with every cause at work.
    seen : array of bool
        Samples recorded.
    signatures_deg : array, shape (M, K)
        What each cause adds at the recorded samples, the others being at work [deg].
    visibility : Visibility
        The causes' visibility at these amplitudes.
    """

    amplitudes: dict[str, float]
    response: Response
    seen: NDArray[np.bool_]
    signatures_deg: Array
    visibility: Visibility


def _evaluate(
    specimen: Specimen,
    programme: Programme,
    noise: Noise,
    amplitudes: dict[str, float],
    lost: NDArray[np.bool_],
) -> Concealed:
    """Response, signatures by switching each cause off, and their visibility."""
    response = measure(specimen, programme, amplitudes)
    seen = response.recorded & ~lost
    if not np.any(seen):
        raise ValueError("every sample would fall into the dead zone or be lost")
    columns = []
    for name in amplitudes:
        rest = {other: a for other, a in amplitudes.items() if other != name}
        off = measure(specimen, programme, rest)
        columns.append((response.angle_deg - off.angle_deg)[seen])
    signatures = np.column_stack(columns) if columns else np.zeros((int(seen.sum()), 0))
    recorded = programme.take(seen)
    return Concealed(
        amplitudes,
        response,
        seen,
        signatures,
        visibility(signatures, recorded, noise, specimen.compliance_deg_per_nm),
    )


def conceal(
    specimen: Specimen,
    programme: Programme,
    noise: Noise,
    names: Sequence[str],
    wanted_d: Sequence[float],
    signs: Sequence[float],
    lost: NDArray[np.bool_],
    alias_amplitudes: dict[str, float],
) -> Concealed:
    """Find amplitudes at which each cause has the wanted visibility.

    Parameters
    ----------
    specimen, programme, noise
        Drive, load programme and true noise.
    names, wanted_d, signs : sequence
        Causes, their wanted d with everything else projected out, and their signs.
    lost : array of bool
        Samples that the recorder loses.
    alias_amplitudes : dict
        Amplitudes of causes that no recording can show; they are taken as they are.

    Raises
    ------
    ConcealmentError
        If a cause stays invisible at any physical amplitude, or would turn the shaft by more
        than ``LARGEST_DEG``, or ``LARGEST_OFFSET_DEG`` if it is an offset.
    """
    sizes = np.array([FIRST_GUESS.get(name, 0.3) for name in names])
    target = np.array(wanted_d, dtype=float)
    for _ in range(25):
        amplitudes = {
            name: float(s * a) for name, s, a in zip(names, signs, sizes, strict=True)
        } | alias_amplitudes
        try:
            found = _evaluate(specimen, programme, noise, amplitudes, lost)
        except ValueError as error:
            raise ConcealmentError(str(error)) from error
        reached = found.visibility.d[: len(names)]
        if len(names) == 0 or np.all(np.abs(reached / target - 1.0) < TOLERANCE):
            if abs(amplitudes.get("thermal_drift", 0.0)) > LARGEST_WARMING_DEG:
                raise ConcealmentError("the drive would have to warm up more than this one does")
            bounds = [LARGEST_OFFSET_DEG if name in OFFSETS else LARGEST_DEG for name in names]
            if np.any(found.visibility.raw_peak_deg[: len(names)] > bounds):
                raise ConcealmentError("a cause would have to be larger than any bench shows")
            if found.seen.mean() < 0.5 * (1.0 - noise.gap_share):
                raise ConcealmentError("most samples would fall into the dead zone")
            return found
        with np.errstate(divide="ignore"):
            sizes = sizes * np.clip(target / reached, 0.05, 8.0)
        if np.any(sizes > 1e4):
            raise ConcealmentError("a cause stays invisible on this programme")
    raise ConcealmentError("no amplitude gives the wanted visibility")


def rival_overlaps(
    specimen: Specimen, programme: Programme, noise: Noise, found: Concealed
) -> dict[str, float]:
    """Overlap of the first cause's signature with that of every other effect on this specimen.

    Returns
    -------
    dict
        Magnitude of the cosine of the projected, whitened signatures, by effect; effects that
        this programme cannot show are left out. Rivals have the specimen's own shapes, so a
        rival free to change its shape may come closer still.
    """
    recorded = programme.take(found.seen)
    first = next(iter(found.amplitudes))
    base = measure(specimen, programme, {}).angle_deg
    overlaps = {}
    for name in VOCABULARY:
        if name == first:
            continue
        small = measure(specimen, programme, {name: 0.2 * FIRST_GUESS.get(name, 0.3)})
        pair = np.column_stack([found.signatures_deg[:, 0], (small.angle_deg - base)[found.seen]])
        view = visibility(pair, recorded, noise, specimen.compliance_deg_per_nm)
        if view.d_alone[1] > 1e-3:
            overlaps[name] = abs(float(view.cosine[0, 1]))
    return overlaps


def opposed_signs(found: Concealed, names: Sequence[str], signs: Sequence[float]) -> list[float]:
    """Signs with which each free cause pulls against the sum of those before it."""
    turned = list(signs)
    overlap = found.visibility.cosine
    for k in range(1, len(names)):
        pull = sum(turned[j] * signs[j] * float(overlap[j, k]) for j in range(k))
        if names[k] in EITHER_SIGN and pull > 0.0:
            turned[k] = -signs[k]
    return turned


def alias_amplitude(name: str, rng: np.random.Generator) -> float:
    """Draw the amplitude of a cause that no recording can show: deg at rated torque, N m, ratio."""
    if name not in ALIASES:
        raise ValueError(f"alias: found {name!r}, expected one of {', '.join(ALIASES)}")
    sign = float(rng.choice([-1.0, 1.0]))
    if name == "rig_compliance":
        return float(rng.uniform(0.8, 4.0))
    if name == "torque_offset":
        return sign * float(rng.uniform(0.05, 0.25))
    return sign * float(rng.uniform(0.02, 0.08))
