"""Draw the pictures of docs/dynamics.md."""

from __future__ import annotations

import math
from pathlib import Path

import cyclosweep as cs
from cyclosweep.design.events import Event, transient
from cyclosweep.design.excitation import excitation_orders
from cyclosweep.figures.train import (
    campbell_figure,
    mode_shapes_figure,
    shock_map_figure,
    transient_figure,
)

DOCS = Path(__file__).parent


def main() -> None:
    """Write the pictures."""
    drive = cs.Drive.reference_87().replace(input_inertia_kg_m2=0.0035)
    train = drive.train(
        load_inertia_kg_m2=5.0, flange_inertia_kg_m2=0.012, coupling_stiffness_nm_per_rad=1e6
    )
    event = Event.from_toml(DOCS.parent / "examples" / "reversal.toml").of_drive(drive)
    transient_figure(transient(train, event)).savefig(DOCS / "shock.png", dpi=130)
    modes = train.modes()
    mode_shapes_figure(modes).savefig(DOCS / "mode-shapes.png", dpi=130)
    campbell_figure(modes, excitation_orders(drive), 1500.0).savefig(DOCS / "campbell.png", dpi=130)
    spring = drive.train().springs[0]
    mark = (spring.slopes_nm_per_rad[0], math.degrees(spring.gap_rad))
    shock_map_figure(drive.nominal_torque_nm, (5.0, 100.0), (0.0, 40.0), mark).savefig(
        DOCS / "shock-factor.png", dpi=130
    )


if __name__ == "__main__":
    main()
