"""Twist with rigid and with elastic discs, several meshes and positions: `make disc`."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from cyclosweep import Drive
from disc.contact import balance
from disc.plane import compliance
from disc.shape import contacts, outline

ROOT = Path(__file__).parents[2]
POSITIONS = (0.3, 1.9, 3.4, 5.0)
"""Crank angles [rad]; the first also on the finer mesh."""
CLEARANCES = ((0.0, 0.0), (0.02, 0.05))
"""At ring and holes [mm]."""


def drives() -> dict[str, tuple[Drive, list[tuple[float, float, float, float]]]]:
    """One disc each with its share of rated torque, and meshes from coarse to fine.

    A mesh is the half widths [mm] of the loaded strips at ring and holes, the elements to a half
    width, and the longest element on the profile [mm].
    """
    steel = Drive.from_toml(ROOT / "examples" / "components-87.toml").replace(
        disc_count=1, output_torque_nm=292.5, disc_1_reach_mm=16.0, disc_2_reach_mm=None,
        shaft=(), output_stiffness_nm_per_arcmin=1e9,
    )  # fmt: skip
    small = steel.replace(
        ratio=11, eccentricity_mm=1.5, ring_pin_circle_radius_mm=50.0, ring_pin_radius_mm=4.0,
        disc_width_mm=8.0, output_pin_count=6, output_pin_diameter_mm=6.0,
        output_pin_circle_radius_mm=30.0, output_torque_nm=25.0, disc_outer_radius_mm=46.0,
        disc_bore_radius_mm=15.0, disc_1_reach_mm=10.0, output_pin_length_mm=20.0,
    )  # fmt: skip
    return {
        "87:1": (steel, [(0.3, 1.5, 2.0, 2.5), (0.2, 1.0, 3.0, 1.5)]),
        "11:1": (small, [(0.4, 0.6, 2.0, 2.0), (0.3, 0.5, 3.0, 1.5)]),
    }


def main() -> None:
    """Print one line for each drive, position, mesh and clearance."""
    print("| drive | crank rad | unknowns | ring, hole mm | rigid disc ' | elastic ' | added % |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name, (drive, meshes) in drives().items():
        for crank in POSITIONS:
            for ring, hole, fine, coarse in meshes if crank == POSITIONS[0] else meshes[:1]:
                begun = time.process_time()
                touched = contacts(drive, crank)
                patches = np.full(drive.ratio + 1 + drive.output_pin_count, hole)
                patches[: drive.ratio + 1] = ring
                found = compliance(
                    outline(drive, crank, patches, fine, coarse),
                    touched,
                    patches,
                    drive.youngs_modulus_gpa * 1e3,
                    drive.poisson_ratio,
                )
                for gap, play in CLEARANCES:
                    loose = drive.replace(ring_clearance_mm=gap, hole_clearance_mm=play)
                    got = balance(loose, drive.output_torque_nm, crank, touched, found)
                    print(
                        f"| {name} | {crank:g} | {found.unknowns} | {gap:g}, {play:g} "
                        f"| {got.rigid_arcmin:.4f} | {got.elastic_arcmin:.4f} "
                        f"| {100 * got.added:.1f} |",
                        flush=True,
                    )
                print(f"{time.process_time() - begun:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
