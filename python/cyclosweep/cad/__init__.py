"""Discs and drives for the shop and the CAD: DXF, SVG, points of the profile, STEP."""

from cyclosweep.cad.disc import LEAST_WALL_MM, Disc, disc_profile
from cyclosweep.cad.drawing import Circle, Drawing, Outline, drawing
from cyclosweep.cad.profile import DiscProfile, FlankPoints
from cyclosweep.cad.write import write_dxf, write_points, write_step, write_svg

__all__ = [
    "LEAST_WALL_MM",
    "Circle",
    "Disc",
    "DiscProfile",
    "Drawing",
    "FlankPoints",
    "Outline",
    "disc_profile",
    "drawing",
    "write_dxf",
    "write_points",
    "write_step",
    "write_svg",
]
