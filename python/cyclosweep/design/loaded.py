"""One equilibrium of the component model: twist, forces, pressures, and each part's twist."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.numbers import finite_number
from cyclosweep.errors import InputError

__all__ = ["LoadedState", "loaded_state"]

ARCMIN = math.pi / 10_800
"""One arc minute [rad]."""

_COMPONENTS = (
    "ring contacts",
    "output contacts",
    "pin bending",
    "pin root",
    "eccentric bearing",
    "clearance",
)

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class LoadedState:
    """A drive under an output torque at one position of its crank.

    Attributes
    ----------
    twist_arcmin : float
        Rotation of the output from the unloaded middle [arcmin], the shaft's own twist included.
    tangent_stiffness_nm_per_arcmin : float
        Slope of torque over twist there [N m/arcmin].
    input_torque_nm : float
        Torque at the input that holds the output torque without friction [N m].
    converged : bool
        Whether the forces balance.
    steps : int
        Newton steps taken.
    output_pin_forces_n : ndarray, shape (discs, output pins)
        Force of each disc on each output pin [N], zero where they do not touch.
    ring_pin_forces_n : ndarray, shape (discs, ring pins)
        Force of each ring pin on each disc [N].
    disc_rotation_rad : ndarray, shape (discs,)
        Rotation of each disc [rad].
    disc_translation_mm : ndarray, shape (discs, 2)
        Shift of each disc's centre along and across the eccentricity [mm].
    contact_pressures_mpa : dict
        Largest Hertz pressures [MPa] at ``ring`` and ``output``.
    budget : polars.DataFrame
        ``component``, ``twist_arcmin``, ``share``: work of each part's force on its own closing,
        over the torque. The parts sum to the twist.
    """

    twist_arcmin: float
    tangent_stiffness_nm_per_arcmin: float
    input_torque_nm: float
    converged: bool
    steps: int
    output_pin_forces_n: Reals
    ring_pin_forces_n: Reals
    disc_rotation_rad: Reals
    disc_translation_mm: Reals
    contact_pressures_mpa: dict[str, float]
    budget: pl.DataFrame


def loaded_state(
    study: _core.Study, part_study: _core.PartStudy, torque_nm: float, crank_rad: float, engine: str
) -> LoadedState:
    """Solve one equilibrium of the only variant of a study.

    Parameters
    ----------
    study : cyclosweep._core.Study
        A drive's study.
    part_study : cyclosweep._core.PartStudy
        Its component model.
    torque_nm : float
        Torque at the output [N m].
    crank_rad : float
        Angle of the eccentric [rad].
    engine : str
        ``full`` or ``quadratic``.

    Returns
    -------
    LoadedState

    Raises
    ------
    InputError
        For a torque that is zero or no finite number, or an angle that is no finite number.
    """
    torque_nm = finite_number("output_torque_nm", torque_nm)
    if torque_nm == 0:
        raise InputError("output_torque_nm: found 0, expected a number but zero")
    crank_rad = finite_number("crank_rad", crank_rad)
    found = part_study.state(study, 0, torque_nm, crank_rad, engine)
    shaft = torque_nm * found["shaft_compliance"]
    discs = np.array(found["discs"])
    parts = [*found["budget"], shaft]
    total = sum(parts)
    budget = pl.DataFrame(
        {
            "component": [*_COMPONENTS, "output shaft"],
            "twist_arcmin": [part / ARCMIN for part in parts],
            "share": [part / total for part in parts],
        }
    )
    ring, output = (pressure * 1e-6 for pressure in found["pressures"])
    return LoadedState(
        twist_arcmin=(found["twist"] + shaft) / ARCMIN,
        tangent_stiffness_nm_per_arcmin=ARCMIN
        / (1 / found["stiffness"] + found["shaft_compliance"]),
        input_torque_nm=found["input_torque"],
        converged=found["converged"],
        steps=found["steps"],
        output_pin_forces_n=np.array(found["pin_forces"]),
        ring_pin_forces_n=np.array(found["ring_forces"]),
        disc_rotation_rad=discs[:, 0] / found["pin_circle_radius"],
        disc_translation_mm=discs[:, 1:] * 1e3,
        contact_pressures_mpa={"ring": ring, "output": output},
        budget=budget,
    )
