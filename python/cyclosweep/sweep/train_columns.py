"""Result columns of the torsional train, in closed form from those of either model."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from cyclosweep.design.part_units import TRAIN_OUTPUTS

__all__ = ["TRAIN_COLUMNS", "needed_inputs", "needed_results", "train_columns"]

Reals = npt.NDArray[np.float64]

TRAIN_COLUMNS = frozenset(TRAIN_OUTPUTS)
"""Names of the columns."""

_PUBLISHED = ("reflected_compliance_rad_per_nm", "compliance_factor", "nominal_torque_nm")
_COMPONENTS = (
    "tangent_stiffness_100pct_nm_per_arcmin",
    "backlash_arcmin",
    "nominal_torque_nm",
    "disc_mass_kg",
)
_INPUTS = (
    "ratio",
    "free_play_deg",
    "input_inertia_kg_m2",
    "eccentric_inertia_kg_m2",
    "load_inertia_kg_m2",
    "flange_inertia_kg_m2",
    "coupling_stiffness_nm_per_rad",
)


def needed_results(with_components: bool) -> tuple[str, ...]:
    """Results from which the columns follow, by the component model or by the published one."""
    return _COMPONENTS if with_components else _PUBLISHED


def needed_inputs(with_components: bool) -> tuple[str, ...]:
    """Inputs from which the columns follow."""
    return (*_INPUTS, "eccentricity_mm", "disc_count") if with_components else _INPUTS


def train_columns(
    names: list[str], values: Mapping[str, Reals | float], with_components: bool
) -> dict[str, Reals]:
    """Columns of the torsional train.

    The drive is one spring between the input and the flange or load: by the published model
    ``1 / (compliance_factor C*_OS)`` behind the free play, by the component model the tangent
    stiffness at rated torque behind half of the backlash, with the discs' orbit at the input.

    Parameters
    ----------
    names : list of str
        Columns wanted.
    values : mapping of str to ndarray or float
        Inputs and results by name, NaN where left out.
    with_components : bool
        Which model the results are of.

    Returns
    -------
    dict of str to ndarray
        NaN where an inertia or the stiffness is missing; of no meaning in rows that are refused.
    """
    ratio = np.asarray(values["ratio"], dtype=np.float64)
    at_input = np.nan_to_num(values["eccentric_inertia_kg_m2"]) + values["input_inertia_kg_m2"]
    if with_components:
        per_arcmin = values["tangent_stiffness_100pct_nm_per_arcmin"]
        stiffness = np.asarray(per_arcmin) * (10_800 / math.pi) / ratio**2
        gap = 0.5 * np.asarray(values["backlash_arcmin"]) * (math.pi / 10_800) * ratio
        radius = np.asarray(values["eccentricity_mm"]) * 1e-3
        at_input = at_input + values["disc_count"] * values["disc_mass_kg"] * radius**2
    else:
        compliance = np.asarray(values["reflected_compliance_rad_per_nm"])
        stiffness = 1.0 / (compliance * values["compliance_factor"])
        gap = np.radians(values["free_play_deg"])
    found: dict[str, Reals] = {}
    if "reversal_shock_factor" in names:
        found["reversal_shock_factor"] = np.asarray(
            1.0 + 2.0 * np.sqrt(1.0 + stiffness * gap / values["nominal_torque_nm"])
        )
    if "natural_frequency_1_hz" in names or "natural_frequency_2_hz" in names:
        first, second = _frequencies(values, ratio, at_input, stiffness)
        found |= {"natural_frequency_1_hz": first, "natural_frequency_2_hz": second}
    return {name: found[name] for name in names}


def _frequencies(
    values: Mapping[str, Reals | float], ratio: Reals, at_input: Reals, stiffness: Reals
) -> tuple[Reals, Reals]:
    """Frequencies of input, flange and load, or of input and load where there is no flange.

    With the inverse inertias a, b, c of a chain of three, free or held at its end (c = 0), the
    squares of the angular frequencies are the roots of ``x^2 - S x + P`` with ``S = k1 (a + b) +
    k2 (b + c)`` and ``P = k1 k2 (a b + b c + c a)``.
    """
    square = ratio**2
    load = np.asarray(values["load_inertia_kg_m2"], dtype=np.float64)
    flange = np.asarray(values["flange_inertia_kg_m2"], dtype=np.float64)
    coupling = np.asarray(values["coupling_stiffness_nm_per_rad"], dtype=np.float64) / square
    # Rows that are refused may have any number.
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        inverse_load = np.nan_to_num(square / load, nan=0.0)
        inverse_input = 1.0 / at_input
        alone = np.sqrt(stiffness * (inverse_input + inverse_load))
        inverse_flange = square / flange
        total = stiffness * (inverse_input + inverse_flange) + coupling * (
            inverse_flange + inverse_load
        )
        pairs = (
            inverse_input * inverse_flange
            + inverse_flange * inverse_load
            + inverse_load * inverse_input
        )
        product = stiffness * coupling * pairs
        larger = 0.5 * (total + np.sqrt(np.maximum(total**2 - 4.0 * product, 0.0)))
        first = np.where(np.isnan(flange) | np.isnan(coupling), alone, np.sqrt(product / larger))
        second = np.sqrt(larger)
    return np.asarray(first / math.tau), np.asarray(second / math.tau) + 0.0 * first
