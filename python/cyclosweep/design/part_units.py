"""The nomenclature of the component model: its inputs and results with units and meanings."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["PART_INPUTS", "PART_LISTS", "PART_OUTPUTS", "TRAIN_OUTPUTS", "Quantity"]


class Quantity(NamedTuple):
    """One named quantity.

    Attributes
    ----------
    symbol : str
        The paper's symbol, empty where it has none.
    unit : str
        Unit of the values, "1" for pure numbers.
    meaning : str
        What it is, in one sentence without a full stop.
    """

    symbol: str
    unit: str
    meaning: str


PART_INPUTS: dict[str, Quantity] = {
    "ring_pin_radius_mm": Quantity("", "mm", "radius of a ring pin; needed"),
    "disc_width_mm": Quantity("", "mm", "width of a disc, length of its contacts; needed"),
    "ring_clearance_mm": Quantity(
        "", "mm", "gap along the normal at every ring pin; below zero an interference"
    ),
    "ring_circle_enlargement_mm": Quantity(
        "", "mm", "how much larger the ring pins' circle is than the profile's"
    ),
    "profile_offset_mm": Quantity(
        "", "mm", "equidistant modification: material taken off along the normal"
    ),
    "profile_shift_mm": Quantity(
        "", "mm", "radial shift of the grinding wheel towards the disc's centre"
    ),
    "profile_rotation_deg": Quantity(
        "", "deg", "rotation modification: both flanks turned back by this angle"
    ),
    "hole_clearance_mm": Quantity(
        "", "mm", "radial gap of a hole beyond pin, bush and eccentricity; below zero a preload"
    ),
    "eccentric_bearing_stiffness_n_per_mm": Quantity(
        "", "N/mm", "radial stiffness of a disc's bearing on the eccentric"
    ),
    "eccentric_bearing_clearance_mm": Quantity("", "mm", "radial clearance of that bearing"),
    "disc_1_reach_mm": Quantity("", "mm", "from the flange to the middle of the first disc"),
    "disc_2_reach_mm": Quantity("", "mm", "the same of the second disc"),
    "disc_3_reach_mm": Quantity("", "mm", "the same of the third disc"),
    "disc_4_reach_mm": Quantity("", "mm", "the same of the fourth disc"),
    "ring_youngs_modulus_gpa": Quantity("", "GPa", "Young's modulus of ring and ring pins"),
    "ring_poisson_ratio": Quantity("", "1", "Poisson's ratio of ring and ring pins"),
    "disc_youngs_modulus_gpa": Quantity("", "GPa", "Young's modulus of the discs"),
    "disc_poisson_ratio": Quantity("", "1", "Poisson's ratio of the discs"),
    "disc_density_kg_m3": Quantity("", "kg/m^3", "density of the discs"),
    "friction_ring": Quantity("", "1", "Coulomb coefficient of disc and ring pins"),
    "friction_output": Quantity("", "1", "Coulomb coefficient of holes and output pins"),
    "friction_bearing": Quantity(
        "", "1", "coefficient of the eccentric's bearing at the disc's bore"
    ),
    "contact_yield_strength_mpa": Quantity(
        "", "MPa", "yield strength of the softer body of every contact"
    ),
    "pin_yield_strength_mpa": Quantity("", "MPa", "yield strength of the output pins"),
    "load_inertia_kg_m2": Quantity(
        "J_L", "kg m^2", "driven machine at the output; without it the output is locked"
    ),
    "eccentric_inertia_kg_m2": Quantity("", "kg m^2", "eccentric and input shaft, none by default"),
    "flange_inertia_kg_m2": Quantity("", "kg m^2", "output flange in front of a coupling"),
    "coupling_stiffness_nm_per_rad": Quantity(
        "", "N m/rad", "coupling between flange and load, at the output"
    ),
}

PART_LISTS: dict[str, Quantity] = {
    "contact_law": Quantity(
        "", "1", "palmgren, or johnson: secant of Johnson's law at the rated force"
    ),
    "pin_root_compliance": Quantity(
        "", "1", "c_uu, c_ut, c_tt of the flange at a pin's root; a thick flange's by default"
    ),
    "ring_gap_errors_mm": Quantity("", "mm", "further gap of each ring pin, ratio + 1 numbers"),
    "hole_gap_errors_mm": Quantity("", "mm", "further gap of each hole, one for each output pin"),
}

_AT_RATED = "at rated torque, mean over the crank"
TRAIN_OUTPUTS: dict[str, Quantity] = {
    "natural_frequency_1_hz": Quantity(
        "f_1",
        "Hz",
        "first natural frequency of input, drive and load beyond the play; null without the "
        "input's inertia",
    ),
    "natural_frequency_2_hz": Quantity("f_2", "Hz", "second one; null without flange and coupling"),
    "reversal_shock_factor": Quantity(
        "",
        "1",
        "peak over static torque when the nominal torque is reversed through the play, "
        "1 + 2 sqrt(1 + K gamma / T_N)",
    ),
}

PART_OUTPUTS: dict[str, Quantity] = {
    "loaded_twist_arcmin": Quantity(
        "", "arcmin", f"twist at the output from the unloaded middle, {_AT_RATED}"
    ),
    "twist_ring_contacts_arcmin": Quantity("", "arcmin", "part of it from the ring contacts"),
    "twist_output_contacts_arcmin": Quantity("", "arcmin", "part from holes and output pins"),
    "twist_pin_bending_arcmin": Quantity("", "arcmin", "part from bending and shear of the pins"),
    "twist_pin_root_arcmin": Quantity("", "arcmin", "part from the flange at the pins' roots"),
    "twist_eccentric_bearing_arcmin": Quantity("", "arcmin", "part from the eccentric's bearings"),
    "twist_shaft_arcmin": Quantity("", "arcmin", "part from the output shaft, Eqs. (4)-(7)"),
    "twist_clearance_arcmin": Quantity("", "arcmin", "part from clearances taken up"),
    "tangent_stiffness_3pct_nm_per_arcmin": Quantity(
        "", "N m/arcmin", "slope of torque over twist at 3 % of rated torque, mean over the crank"
    ),
    "tangent_stiffness_50pct_nm_per_arcmin": Quantity("", "N m/arcmin", "the same at 50 %"),
    "tangent_stiffness_100pct_nm_per_arcmin": Quantity("", "N m/arcmin", "the same at 100 %"),
    "lost_motion_3pct_arcmin": Quantity(
        "", "arcmin", "twist at +3 % less twist at -3 % of rated torque, mean over the crank"
    ),
    "backlash_arcmin": Quantity(
        "",
        "arcmin",
        "turn of the output between the first contacts in either sense without load, bearings "
        "centred or where ring pins that interfere push them to, mean over the crank",
    ),
    "active_output_pins_mean": Quantity(
        "", "1", f"hole-pin contacts above 1 % of the largest force, {_AT_RATED}"
    ),
    "active_output_pins_min": Quantity("", "1", "fewest of them"),
    "active_output_pins_max": Quantity("", "1", "most of them"),
    "effective_output_pins": Quantity(
        "", "1", f"(sum F)^2 / sum F^2 of the output pins' forces, {_AT_RATED}"
    ),
    "active_ring_pins_mean": Quantity(
        "", "1", f"ring contacts of all discs above 1 % of the largest force, {_AT_RATED}"
    ),
    "output_pin_force_max_n": Quantity("", "N", "largest force of a hole on a pin"),
    "ring_pin_force_max_n": Quantity("", "N", "largest force of a ring pin on a disc"),
    "disc_load_share_max": Quantity("", "1", "largest share of one disc in the output torque"),
    "eccentric_bearing_force_max_n": Quantity("", "N", "largest force of a disc on its bearing"),
    "ring_contact_pressure_max_mpa": Quantity(
        "", "MPa", "largest Hertz pressure of ring pin and disc"
    ),
    "output_contact_pressure_max_mpa": Quantity(
        "", "MPa", "largest Hertz pressure of hole and pin or bush"
    ),
    "efficiency": Quantity(
        "", "1", "output over input power at rated torque, sliding with the frictionless forces"
    ),
    "loss_share_ring": Quantity("", "1", "loss at the ring over the input power"),
    "loss_share_output": Quantity("", "1", "loss at the output pins over the input power"),
    "loss_share_eccentric_bearing": Quantity("", "1", "loss in the bearings over the input power"),
    "transmission_error_pp_arcmin": Quantity(
        "", "arcmin", "twist at constant rated torque over 48 positions, largest less smallest"
    ),
    "input_torque_ripple_pp": Quantity(
        "", "1", "T_in N / T_out at constant rated torque, largest less smallest"
    ),
    "profile_curvature_radius_min_mm": Quantity(
        "", "mm", "smallest convex radius of curvature of the disc's profile"
    ),
    "disc_mass_kg": Quantity("", "kg", "one disc, holes and bore taken out"),
    "disc_inertia_kg_m2": Quantity("", "kg m^2", "one disc about its own centre"),
    "drive_volume_mm3": Quantity(
        "", "mm^3", "cylinder around the ring pins, from the flange to the last disc's end"
    ),
    "tangent_stiffness_100pct_without_clearance_nm_per_arcmin": Quantity(
        "",
        "N m/arcmin",
        "slope at 100 % of the same drive without any gap, profile modification or bearing play",
    ),
    "ring_contact_pressure_max_pin": Quantity(
        "", "1", "ring pin, counted from 0, at which ring_contact_pressure_max_mpa occurs"
    ),
    "ring_contact_pressure_max_crank_deg": Quantity(
        "", "deg", "angle of the crank at which it does"
    ),
    "output_contact_pressure_max_pin": Quantity(
        "", "1", "output pin, counted from 0, at which output_contact_pressure_max_mpa occurs"
    ),
    "output_contact_pressure_max_crank_deg": Quantity(
        "", "deg", "angle of the crank at which it does"
    ),
    "ring_pin_force_peak_min_n": Quantity(
        "", "N", "smallest over the crank of the largest force of a ring pin on a disc"
    ),
    "output_pin_force_peak_min_n": Quantity(
        "", "N", "smallest over the crank of the largest force of a hole on a pin"
    ),
    "eccentric_bearing_force_min_n": Quantity(
        "", "N", "smallest force of a disc on its bearing over the crank"
    ),
    "pin_root_stress_max_mpa": Quantity(
        "", "MPa", "largest bending stress at an output pin's root by the contacts' forces"
    ),
    "contact_yield_ratio_max": Quantity(
        "",
        "1",
        "twice the largest shear stress below a contact over its yield strength; above 1 it yields",
    ),
    "pin_yield_ratio_max": Quantity(
        "", "1", "pin_root_stress_max_mpa over the pins' yield strength; above 1 it yields"
    ),
    "solver_status": Quantity(
        "", "1", "engine of the equilibria at rated torque: quadratic, full, or failed"
    ),
}
