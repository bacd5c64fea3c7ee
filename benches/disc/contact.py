"""Twist of a drive whose disc is elastic: finite elements and contacts brought to balance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cyclosweep import Drive
from disc.plane import Compliance
from disc.shape import Contacts

__all__ = ["ElasticDisc", "balance"]

Reals = npt.NDArray[np.float64]

STEPS = 60
"""Most rounds of contacts and disc; each halves what is left."""
SETTLED = 1e-5
"""Relative change of the twist below which the rounds end."""


@dataclass(frozen=True)
class ElasticDisc:
    """What the disc's own flexibility does at one position.

    Attributes
    ----------
    rigid_arcmin, frozen_arcmin, elastic_arcmin : float
        Twist of the component model; with the disc's part by the forces of the component model;
        and with forces in balance with the elastic disc [arcmin].
    rounds : int
        Rounds until the twist stood still.
    """

    rigid_arcmin: float
    frozen_arcmin: float
    elastic_arcmin: float
    rounds: int

    @property
    def added(self) -> float:
        """Twist that the component model leaves out, over the one that it has [1]."""
        return self.elastic_arcmin / self.rigid_arcmin - 1


def _palmgren_of_disc(drive: Drive, forces: Reals) -> Reals:
    """The disc's half of Palmgren's approach [mm], steel on steel."""
    assert drive.disc_width_mm is not None
    return np.asarray(0.5 * 3.84e-5 * forces**0.9 / drive.disc_width_mm**0.8)


def _half_widths(drive: Drive, touched: Contacts, forces: Reals, modulus: float) -> Reals:
    """Half widths of Hertz's strips [mm]."""
    assert drive.ring_pin_radius_mm is not None
    assert drive.disc_width_mm is not None
    pin = np.full(len(forces), drive.output_pin_diameter_mm / 2 + drive.bush_wall_mm)
    pin[: drive.ratio + 1] = drive.ring_pin_radius_mm
    curvature = np.maximum(1 / pin + 1 / touched.radii, 1e-3)
    contact = modulus / (2 * (1 - drive.poisson_ratio**2))
    return np.asarray(np.sqrt(4 * forces / drive.disc_width_mm / (math.pi * contact * curvature)))


def left_out(drive: Drive, touched: Contacts, found: Compliance, forces: Reals) -> Reals:
    """How far each contact opens because the disc gives way more than Palmgren's law says [mm].

    Parameters
    ----------
    drive : Drive
        The drive, with one disc.
    touched : Contacts
        Where it is touched.
    found : Compliance
        Its finite elements.
    forces : ndarray, shape (contacts,)
        Forces [N], ring pins first.
    """
    assert drive.disc_width_mm is not None
    modulus = drive.youngs_modulus_gpa * 1e3
    loads = forces / drive.disc_width_mm
    moved = found.matrix @ loads
    # From the strip that was loaded to Hertz's own: the half-plane's logarithm, plane strain.
    narrow = np.maximum(_half_widths(drive, touched, forces, modulus), 1e-4)
    local = 2 * (1 - drive.poisson_ratio**2) / (math.pi * modulus)
    moved += local * loads * np.log(found.patches / narrow)
    return np.asarray(moved - _palmgren_of_disc(drive, forces))


def balance(
    drive: Drive, torque_nm: float, crank: float, touched: Contacts, found: Compliance
) -> ElasticDisc:
    """Twist with the disc's flexibility, the shape of the disc and the forces agreeing.

    Parameters
    ----------
    drive : Drive
        The drive, with one disc and no gap errors.
    torque_nm : float
        Torque of that disc [N m].
    crank : float
        Angle of the crank [rad].
    touched : Contacts
        Where it is touched.
    found : Compliance
        Its finite elements.
    """
    rigid = drive.loaded(torque_nm, crank)
    forces = np.concatenate([rigid.ring_pin_forces_n[0], rigid.output_pin_forces_n[0]])
    gaps = left_out(drive, touched, found, forces)
    frozen = float(forces @ gaps) * 1e-3 / torque_nm * 10_800 / math.pi
    gaps = np.zeros_like(forces)
    twist, rounds, share = rigid.twist_arcmin, 0, 0.3
    while rounds < STEPS:
        rounds += 1
        gaps += share * (left_out(drive, touched, found, forces) - gaps)
        ring = drive.ratio + 1
        state = drive.replace(
            ring_gap_errors_mm=tuple(gaps[:ring].tolist()),
            hole_gap_errors_mm=tuple(gaps[ring:].tolist()),
        ).loaded(torque_nm, crank)
        forces = np.concatenate([state.ring_pin_forces_n[0], state.output_pin_forces_n[0]])
        change, twist = abs(state.twist_arcmin / twist - 1), state.twist_arcmin
        if change < SETTLED:
            break
    return ElasticDisc(rigid.twist_arcmin, rigid.twist_arcmin + frozen, twist, rounds)
