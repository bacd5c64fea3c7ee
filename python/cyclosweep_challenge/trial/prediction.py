"""Prediction error of the true model when its parameters are fitted to the recording."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import Programme
from cyclosweep_challenge.rig.rig import Response, measure
from cyclosweep_challenge.rig.specimen import Specimen
from cyclosweep_challenge.trial.concealment import Concealed
from cyclosweep_challenge.trial.signature import calibration

Array = NDArray[np.float64]

ORDERS = {"transmission_error": (1, 2, 3), "phase_dependent_compliance": (1, 2, 3, 4)}
"""Orders of crank position that the true model has to fit."""


def _freedom(
    names: list[str], signatures_deg: Array, programme: Programme
) -> tuple[Array, list[int]]:
    """Columns along which the true model's fit can move, shape (N, K).

    Beside each stands the number of the cause whose waves it belongs to; minus one for none.
    """
    columns = [calibration(programme), signatures_deg]
    owner = [-1] * (3 + len(names))
    for k, name in enumerate(names):
        if name in ORDERS:
            phase = np.deg2rad(np.outer(programme.crank_deg, ORDERS[name]))
            waves = np.hstack([np.cos(phase), np.sin(phase)])
            if name == "phase_dependent_compliance":
                waves = waves * programme.torque_nm[:, None]
            columns.append(waves)
            owner += [k] * waves.shape[1]
    return np.hstack(columns), owner


def fitting_error(
    found: Concealed,
    first: Programme,
    later: Response,
    second: Programme,
    specimen: Specimen,
    noise: Noise,
) -> float:
    """Expected error that the true model's fit adds on the held-out programme, as rms [deg].

    Calibration, each cause's amplitude and the waves over crank position are fitted to the
    recording by generalised least squares; other shapes are taken as known, so that a real fit
    of the true model does somewhat worse. Waves that a few mesh positions do not determine are
    held to the size that the cause really has: a fit without that knowledge predicts so badly
    between those positions that anything would look good beside it.

    Parameters
    ----------
    found : Concealed
        The causes on the first programme.
    first, second : Programme
        The recorded and the held-out programme.
    later : Response
        Noise-free readings of the held-out programme.
    specimen, noise
        Drive and true noise.
    """
    names = list(found.amplitudes)
    held = []
    for name in names:
        rest = {other: a for other, a in found.amplitudes.items() if other != name}
        off = measure(specimen, second, rest)
        held.append((later.angle_deg - off.angle_deg)[later.recorded])
    there = second.take(later.recorded)
    signatures = np.column_stack(held) if held else np.zeros((len(there), 0))
    seen = first.take(found.seen)
    plain, owner = _freedom(names, found.signatures_deg, seen)
    predicted, _ = _freedom(names, signatures, there)
    fitted = noise.whiten(plain, seen, specimen.compliance_deg_per_nm)
    fitted = fitted * np.sqrt(noise.information())
    held_to = np.zeros((len(owner), len(owner)))
    for column, cause in enumerate(owner):
        if cause >= 0:
            # As large as all of the cause, for each wave: one over its standard deviation.
            rms = np.sqrt(np.mean(plain[:, column] ** 2))
            held_to[column, column] = rms / max(found.visibility.raw_rms_deg[cause], 1e-12)
    rows = np.vstack([fitted, held_to])
    size = np.linalg.norm(rows, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    # Directions that the recording does not determine are left where they are, as a fit would.
    _, singular, turned = np.linalg.svd(rows / size, full_matrices=False)
    known = singular > 1e-6 * singular[0]
    spread = ((predicted / size) @ turned[known].T) / singular[known]
    return float(np.sqrt(np.mean(np.sum(spread**2, axis=1))))
