"""One output pin's deflection under the loads of the paper's Fig. 13, without and with its root."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import polars as pl

__all__ = ["THICK_FLANGE", "Pin", "pin_load_table", "root_flexibility"]

THICK_FLANGE = (1.224, 0.231, 5.117)
"""c_uu, c_ut, c_tt [1] of a thick flange at a round pin's root, Poisson's ratio 0.3: fitted to
finite elements of the pin on a block of 16 diameters for free lengths of 0.5 to 5 diameters."""


def root_flexibility(
    root: tuple[float, float, float], length_mm: float, diameter_mm: float, modulus_gpa: float
) -> float:
    """Deflection of a pin's end that comes of the flange at its root alone, under one newton.

    Parameters
    ----------
    root : tuple of float
        c_uu, c_ut, c_tt [1].
    length_mm : float
        Distance of the force from the flange [mm].
    diameter_mm : float
        Diameter of the pin [mm].
    modulus_gpa : float
        Young's modulus of the flange [GPa].

    Returns
    -------
    float
        In mm/N: ``(c_uu + 2 c_ut L/d + c_tt (L/d)^2) / (E d)``.
    """
    c_uu, c_ut, c_tt = root
    slenderness = length_mm / diameter_mm
    factor = c_uu + 2 * c_ut * slenderness + c_tt * slenderness**2
    return factor / (modulus_gpa * 1e3 * diameter_mm)


class Pin(NamedTuple):
    """One output pin as the published model has it, and the flange's compliance at its root.

    Attributes
    ----------
    circle_radius_mm : float
        Radius of the pins' circle [mm].
    force_n : float
        Force of one pin at one T_N, Eq. (9) [N].
    compliance_rad_per_nm : float
        C_OP, the limit of Eq. (10) for a small force [rad/(N m)].
    root_mm_per_n : float
        What the root adds to the deflection [mm/N].
    """

    circle_radius_mm: float
    force_n: float
    compliance_rad_per_nm: float
    root_mm_per_n: float


def pin_load_table(pin: Pin, loads_tn: tuple[float, ...]) -> pl.DataFrame:
    """One pin under several loads.

    Parameters
    ----------
    pin : Pin
        The pin.
    loads_tn : tuple of float
        Loads [T_N].

    Returns
    -------
    polars.DataFrame
        See :meth:`cyclosweep.design.parts.PartInputs.pin_loads`.
    """
    radius = pin.circle_radius_mm
    load = np.array(loads_tn, dtype=np.float64)
    force = pin.force_n * load
    columns = {"load_tn": load, "torque_nm": force * radius * 1e-3, "force_n": force}
    softness = pin.compliance_rad_per_nm * radius**2 * 1e-3
    for name, flexibility in (("", softness), ("_with_root", softness + pin.root_mm_per_n)):
        deflection = flexibility * force
        rotation = np.arctan(deflection / radius)
        columns[f"deflection{name}_mm"] = deflection
        columns[f"rotation{name}_deg"] = np.degrees(rotation)
        columns[f"compliance{name}_rad_per_nm"] = rotation / columns["torque_nm"]
    return pl.DataFrame(columns)
