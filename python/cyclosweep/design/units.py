"""The nomenclature: every input and result with its symbol, unit and meaning, in one place."""

from __future__ import annotations

import re

import cyclosweep._core as _core
from cyclosweep.design.part_units import (
    PART_INPUTS,
    PART_LISTS,
    PART_OUTPUTS,
    TRAIN_OUTPUTS,
    Quantity,
)

__all__ = ["INPUTS", "OUTPUTS", "Quantity", "is_input", "is_quantity", "quantity", "twist_column"]


INPUTS: dict[str, Quantity] = {
    "ratio": Quantity("i", "1", "reduction ratio, whole, 3 to 300"),
    "disc_count": Quantity("n", "1", "cycloid discs, equally phased, 1 to 4"),
    "eccentricity_mm": Quantity("e", "mm", "eccentricity of the input shaft"),
    "ring_pin_circle_radius_mm": Quantity("R", "mm", "radius of the ring pins' circle"),
    "hole_clocking_deg": Quantity(
        "",
        "deg",
        "clocking of the hole pattern: of the published model from the position symmetric about "
        "ring pin 0, with holes half a pitch on either side of it; of the component model and "
        "drawings from the position with a hole at ring pin 0",
    ),
    "output_pin_count": Quantity("N_OP", "1", "output pins, equispaced, 3 to 64"),
    "output_pin_circle_radius_mm": Quantity("R_OP", "mm", "radius of the output pins' circle"),
    "output_pin_diameter_mm": Quantity("d_OP", "mm", "outer diameter of an output pin"),
    "output_pin_bore_mm": Quantity("", "mm", "bore of an output pin, 0 for a solid one"),
    "output_pin_length_mm": Quantity("L", "mm", "free length of an output pin, a cantilever"),
    "bush_wall_mm": Quantity("", "mm", "wall of the bush on an output pin"),
    "disc_outer_radius_mm": Quantity("", "mm", "root radius of the disc, to which the web counts"),
    "disc_bore_radius_mm": Quantity("", "mm", "radius of the disc's bore"),
    "youngs_modulus_gpa": Quantity("E", "GPa", "Young's modulus of shaft and pins"),
    "poisson_ratio": Quantity("nu", "1", "Poisson's ratio of shaft and pins"),
    "keyway_coefficient": Quantity("k", "1", "coefficient of Eq. (5), 10 as printed"),
    "input_power_kw": Quantity("P", "kW", "rated input power"),
    "input_speed_rpm": Quantity("", "rpm", "rated input speed"),
    "output_torque_nm": Quantity("T_O", "N m", "rated output torque"),
    "free_play_deg": Quantity("gamma", "deg", "free play at the input, each side of the middle"),
    "input_inertia_kg_m2": Quantity("J", "kg m^2", "inertia at the input"),
    "output_stiffness_nm_per_arcmin": Quantity(
        "1/C_OS", "N m/arcmin", "torsional stiffness at the output; given, it replaces the shaft"
    ),
    "criterion": Quantity("", "1", "rule by which a pin counts as active in the twist"),
}

_SEGMENT_FIELDS = {
    "diameter_mm": "diameter at the free end",
    "end_diameter_mm": "diameter at the flange end of a frustum",
    "length_mm": "length",
    "keyway_depth_mm": "depth of the keyway",
}

OUTPUTS: dict[str, Quantity] = {
    "active_pins_mean": Quantity("", "1", "active hole-pin contacts, mean over one turn"),
    "active_pins_min": Quantity("", "1", "active hole-pin contacts, fewest"),
    "active_pins_max": Quantity("", "1", "active hole-pin contacts, most"),
    "torque_transfer_efficiency": Quantity(
        "eta_OP", "1", "torque transfer efficiency by the chosen criterion, Eqs. (1)-(3)"
    ),
    "torque_transfer_efficiency_inside": Quantity("", "1", "the same by the criterion inside"),
    "torque_transfer_efficiency_published_map": Quantity(
        "", "1", "the same by the criterion published-map"
    ),
    "pin_participation_statics": Quantity(
        "p",
        "1",
        "sum of sin^2 over the loaded contacts per output pin, mean over one turn; null for more "
        "than two discs, where statics do not apply",
    ),
    "statics_applicable": Quantity("", "1", "whether statics hold: at most two discs"),
    "hole_diameter_mm": Quantity(
        "", "mm", "hole in the disc without clearance: pin + 2 bush walls + 2 e"
    ),
    "hole_web_mm": Quantity(
        "",
        "mm",
        "least material between holes without clearance, to the rim at disc_outer_radius_mm and "
        "to the bore",
    ),
    "short_width_coefficient": Quantity("K1", "1", "e (i + 1) / R, below 1"),
    "nominal_torque_nm": Quantity("T_N", "N m", "nominal input torque P / omega"),
    "natural_frequency_hz": Quantity(
        "",
        "Hz",
        "sqrt(K*_OS / J) / (2 pi) with the output locked; null without an inertia or a K*_OS",
    ),
    "natural_frequency_with_efficiency_hz": Quantity(
        "", "Hz", "the same with the compliance of Eq. (13), compliance_factor C*_OS, for 1 / K*_OS"
    ),
    "shaft_compliance_rad_per_nm": Quantity("C_OS^t", "rad/(N m)", "output shaft, Eqs. (4)-(7)"),
    "pin_compliance_rad_per_nm": Quantity(
        "C_OP", "rad/(N m)", "one output pin, delta / (F R_OP^2), Eqs. (8)-(10)"
    ),
    "output_compliance_rad_per_nm": Quantity(
        "C_OS",
        "rad/(N m)",
        "at the output, Eq. (11); by statics with the pins' share; given where a stiffness is; "
        "null by statics for more than two discs, with all that follows from it, twists included",
    ),
    "output_compliance_statics_rad_per_nm": Quantity(
        "",
        "rad/(N m)",
        "at the output with the pins' share by statics, C_OS^t + C_OP / (N_OP p), whatever the "
        "criterion; given where a stiffness is, else null for more than two discs",
    ),
    "reflected_compliance_rad_per_nm": Quantity("C*_OS", "rad/(N m)", "at the input, Eq. (12)"),
    "reflected_stiffness_nm_per_rad": Quantity("K*_OS", "N m/rad", "1 / C*_OS"),
    "output_stiffness_nm_per_arcmin": Quantity("1/C_OS", "N m/arcmin", "at the output"),
    "compliance_factor": Quantity(
        "",
        "1",
        "factor on C*_OS in Eq. (13): eta_OP; 1 by statics and where a stiffness is given",
    ),
    "torque_per_pin_nm": Quantity(
        "T_O*",
        "N m",
        "torque of one pin, T_O over the mean number of active hole-pin contacts, Eqs. (1), (2); "
        "of one contact for more than two discs, where a pin has several",
    ),
    "force_per_pin_n": Quantity("F_n", "N", "force of a pin that carries T_O*, Eq. (9)"),
    "pin_force_max_n": Quantity(
        "", "N", "largest force on one pin at rated output torque by statics, at its worst position"
    ),
    "pin_bending_stress_mpa": Quantity("", "MPa", "bending stress at the pin's root by that force"),
}


def twist_column(load_tn: float) -> str:
    """Name of the twist column for a load.

    Parameters
    ----------
    load_tn : float
        Load in nominal torques [1]; below zero it acts in the other direction.

    Returns
    -------
    str
        For example ``twist_4p5tn_deg``, or ``twist_minus_4p5tn_deg`` for a load of -4.5.

    Examples
    --------
    >>> twist_column(4.5)
    'twist_4p5tn_deg'
    """
    return [name for name, _ in _core.output_table([load_tn])][-1]


def quantity(name: str) -> Quantity:
    """Symbol, unit and meaning of any column of a sweep.

    Parameters
    ----------
    name : str
        An input, a shaft segment's input, a result, ``variant`` or ``status``.

    Returns
    -------
    Quantity

    Raises
    ------
    KeyError
        For a name that is none of them.

    Examples
    --------
    >>> quantity("twist_1tn_deg").unit
    'deg'
    """
    if name in OUTPUTS:
        return OUTPUTS[name]
    for known in (INPUTS, PART_OUTPUTS, TRAIN_OUTPUTS, PART_INPUTS, PART_LISTS):
        if name in known:
            return known[name]
    if match := re.fullmatch(r"twist_((?:minus_)?[0-9a-z]+)tn_deg", name):
        load = match[1].replace("minus_", "-").replace("p", ".")
        return Quantity("theta'", "deg", f"twist at the input under {load} T_N, Eq. (13)")
    if match := re.fullmatch(r"shaft_(\d+)_(\w+)", name):
        return Quantity("", "mm", f"{_SEGMENT_FIELDS[match[2]]}, shaft segment {match[1]}")
    return {
        "variant": Quantity("", "1", "number of the variant within its study"),
        "status": Quantity("", "1", "ok, or why the variant cannot be built"),
    }[name]


def is_quantity(name: str) -> bool:
    """Whether a name is that of an input or result of any drive."""
    try:
        quantity(name)
    except KeyError:
        return False
    return True


def is_input(name: str) -> bool:
    """Whether a name is that of an input of any drive, however many segments its shaft has."""
    is_of_shaft = name.startswith("shaft_") and name not in OUTPUTS
    return name in INPUTS or name in PART_INPUTS or (is_of_shaft and is_quantity(name))
