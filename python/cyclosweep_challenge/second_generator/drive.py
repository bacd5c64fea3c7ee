"""Drives under test: what their maker states, and how a specimen departs from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

REFERENCE_COMPLIANCE_DEG_PER_NM = 2.7261838
"""Compliance of the built-in drive ``reference-87`` at its input, by its published model."""
REFERENCE_RATED_NM = 1140.0 / (1500.0 * 2.0 * np.pi / 60.0)
"""Rated input torque of ``reference-87`` from its rated power and speed [N m]."""

SMALL_DRIVE = """name = "small-30"
ratio = 30
disc_count = 2
eccentricity_mm = 1.0
ring_pin_circle_radius_mm = 60.0
output_pin_count = 8
output_pin_circle_radius_mm = 36.0
output_pin_diameter_mm = 12.0
output_pin_length_mm = 30.0
bush_wall_mm = 1.5
disc_outer_radius_mm = 55.0
disc_bore_radius_mm = 20.0
youngs_modulus_gpa = 206.0
input_power_kw = 0.75
input_speed_rpm = 1500.0
output_torque_nm = 120.0
free_play_deg = 9.0
output_stiffness_nm_per_arcmin = 6.0
"""
"""A drive whose stiffness at the output comes from a catalogue, as its drive file."""

OUTPUT_PINS = 8
"""Output pins of both drives [-]."""


@dataclass(frozen=True)
class Specimen:
    """One drive on the bench; angles and torques are those of the measured shaft.

    Attributes
    ----------
    drive : str
        What the recording's TOML names.
    drive_file : str
        Contents of a drive file beside the recording; empty for a built-in drive.
    side : str
        Measured shaft: input or output.
    rated_nm : float
        Rated torque [N m].
    nominal_compliance_deg_per_nm, compliance_deg_per_nm : float
        Compliance by the drive file, and the true one [deg/(N m)].
    nominal_play_deg, play_deg : float
        Free play on each side of the middle, stated and true [deg].
    datum_deg : float
        Angle of the middle of the play [deg].
    mesh_per_deg : float
        Travel of the mesh zone per degree of measured twist [-].
    """

    drive: str
    drive_file: str
    side: str
    rated_nm: float
    nominal_compliance_deg_per_nm: float
    compliance_deg_per_nm: float
    nominal_play_deg: float
    play_deg: float
    datum_deg: float
    mesh_per_deg: float

    @property
    def twist_deg(self) -> float:
        """Elastic twist at the rated torque [deg]."""
        return self.compliance_deg_per_nm * self.rated_nm


def draw_specimen(rng: np.random.Generator, *, other: bool = False) -> Specimen:
    """Draw a specimen whose compliance, play and datum are a little off what the maker states.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of chance.
    other : bool
        Take the drive with a drive file, measured at its output, in place of ``reference-87``.
    """
    if other:
        ratio, stiffness, play = 30.0, 6.0, 9.0
        compliance = 1.0 / (60.0 * stiffness)
        rated, play = 120.0, play / ratio
        name, text, side, travel = "drive.toml", SMALL_DRIVE, "output", ratio
    else:
        compliance, rated, play = REFERENCE_COMPLIANCE_DEG_PER_NM, REFERENCE_RATED_NM, 28.0
        name, text, side, travel = "reference-87", "", "input", 1.0
    return Specimen(
        drive=name,
        drive_file=text,
        side=side,
        rated_nm=rated,
        nominal_compliance_deg_per_nm=compliance,
        compliance_deg_per_nm=compliance * float(np.exp(rng.normal(0.0, 0.05))),
        nominal_play_deg=play,
        play_deg=play * float(np.exp(rng.normal(0.0, 0.03))),
        datum_deg=float(rng.normal(0.0, 0.02)) * play,
        mesh_per_deg=travel,
    )
