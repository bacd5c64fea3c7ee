"""Draw docs/components.png, the 87:1 drive over load and clearance."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import polars as pl

import cyclosweep as cs

mpl.use("Agg")
from matplotlib import pyplot as plt

DOCS = Path(__file__).parent
PANELS = {
    "loaded_twist_arcmin": "twist [arcmin]",
    "tangent_stiffness_100pct_nm_per_arcmin": "tangent stiffness [N m/arcmin]",
    "active_output_pins_mean": "active output pins",
    "input_torque_ripple_pp": "ripple of the input torque",
}


def swept(hole_clearance_mm: float) -> pl.DataFrame:
    """Columns over the load, from 3 % to 450 % of rated torque."""
    drive = cs.Drive.from_toml(DOCS.parent / "examples" / "components-87.toml")
    loads = [0.03 + 4.47 * k / 60 for k in range(61)]
    space = cs.Space.table(
        drive.replace(hole_clearance_mm=hole_clearance_mm),
        pl.DataFrame({"output_torque_nm": [585 * load for load in loads]}),
    )
    found = cs.scan(space, model="components", solver="full").select(*PANELS).collect()
    return found.with_columns(load=pl.Series(loads))


def main() -> None:
    """Write the picture."""
    figure, axes = plt.subplots(2, 2, figsize=(9, 6), layout="constrained")
    for clearance in (0.0, 0.05, 0.1, 0.15):
        table = swept(clearance)
        for panel, name in zip(axes.flat, PANELS, strict=True):
            panel.plot(table["load"], table[name], label=f"{clearance:g} mm")
    for panel, label in zip(axes.flat, PANELS.values(), strict=True):
        panel.set_xlabel("load / rated torque")
        panel.set_ylabel(label)
        panel.grid(alpha=0.3)
    axes[0, 0].legend(title="hole clearance")
    figure.savefig(DOCS / "components.png", dpi=110)


if __name__ == "__main__":
    main()
