"""cycloidgen 8.0.0 on designs of both, with its own analyses of contacts and stiffness.

It solves the same two stages one after the other (ring on a rigid carrier, then output pins on a
rigid ring), on profiles of 2000 points; its gaps at many lobes are errors of that polyline.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cyclosweep as cs

__all__ = ["CASES", "Case", "analyse"]


@dataclass(frozen=True)
class Case:
    """A design of both programmes, mm and N m."""

    name: str
    ring: float
    pin: float
    eccentricity: float
    lobes: int
    width: float
    discs: int
    pins: int
    pin_diameter: float
    circle: float
    ring_clearance: float
    hole_clearance: float
    """On the diameter."""
    torque: float
    gaps_hold: bool = True
    """Whether its polyline resolves the gaps at the ring."""

    def drive(self) -> cs.Drive:
        """The design as ours: steel 210 GPa, Poisson's ratio 0.3 throughout."""
        reach = [
            (0.5 + disc) * self.width + disc * min(1.0, self.width) for disc in range(self.discs)
        ]
        return cs.Drive.reference_87().replace(
            ratio=self.lobes,
            disc_count=self.discs,
            eccentricity_mm=self.eccentricity,
            ring_pin_circle_radius_mm=self.ring,
            hole_clocking_deg=0.0,
            output_pin_count=self.pins,
            output_pin_circle_radius_mm=self.circle,
            output_pin_diameter_mm=self.pin_diameter,
            bush_wall_mm=0.0,
            disc_outer_radius_mm=self.ring - self.pin,
            disc_bore_radius_mm=0.4 * self.circle,
            youngs_modulus_gpa=210.0,
            shaft=(),
            output_stiffness_nm_per_arcmin=1e9,
            output_torque_nm=self.torque,
            ring_pin_radius_mm=self.pin,
            disc_width_mm=self.width,
            ring_clearance_mm=self.ring_clearance,
            hole_clearance_mm=0.5 * self.hole_clearance,
            ring_youngs_modulus_gpa=210.0,
            disc_youngs_modulus_gpa=210.0,
            **{f"disc_{disc + 1}_reach_mm": value for disc, value in enumerate(reach)},
        )

    def spec(self) -> Any:
        """The design as cycloidgen's."""
        from cycloidgen.core.spec import GearSpec

        steel = "Bearing steel 100Cr6"
        return GearSpec(
            pin_circle_radius=self.ring,
            pin_radius=self.pin,
            eccentricity=self.eccentricity,
            lobes=self.lobes,
            disc_thickness=self.width,
            disc_count=self.discs,
            output_pin_count=self.pins,
            output_pin_diameter=self.pin_diameter,
            output_bolt_circle_radius=self.circle,
            profile_clearance=self.ring_clearance,
            hole_clearance=self.hole_clearance,
            output_torque_Nm=self.torque,
            disc_material=steel,
            pin_material=steel,
            housing_material="Steel 1045",
        )


CASES = (
    Case("11:1, 50 N m", 50, 4, 1.5, 11, 8, 2, 6, 6, 30, 0.01, 0.02, 50),
    Case("11:1, 200 N m", 50, 4, 1.5, 11, 8, 2, 6, 6, 30, 0.01, 0.02, 200),
    Case("11:1, no clearance", 50, 4, 1.5, 11, 8, 2, 6, 6, 30, 0.0, 0.0, 50),
    Case("29:1", 52.5, 3.5, 1.25, 29, 13.5, 2, 8, 12, 34, 0.01, 0.02, 116, gaps_hold=False),
    Case("87:1", 90, 2, 0.9, 87, 12, 2, 8, 16, 45, 0.02, 0.1, 585, gaps_hold=False),
)


def analyse(spec: Any) -> dict[str, float]:
    """Its stiffness, contacts and efficiency of one design; ours without the fine turn."""
    from cycloidgen.analysis.efficiency import (
        analyse_efficiency,
    )
    from cycloidgen.analysis.mechanics import (
        analyse_contacts,
    )
    from cycloidgen.analysis.stiffness import (
        analyse_stiffness,
    )

    stiffness, contacts = analyse_stiffness(spec), analyse_contacts(spec)
    analyse_efficiency(spec)
    return {
        "ring_force_n": float(contacts.max_pin_force_N),
        "output_force_n": float(contacts.max_output_force_N),
        "ring_pressure_mpa": float(contacts.max_pin_pressure_MPa),
        "lost_motion_arcmin": float(stiffness.lost_motion_arcmin),
        "contact_stiffness": float(stiffness.contact_only_Nm_per_arcmin),
    }
