"""Draw the pictures of docs/components.md: the 87:1 drive over load, clearance and twist."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import polars as pl

import cyclosweep as cs
from cyclosweep.design.nominal_line import Side
from cyclosweep.figures.series import load_series_figure
from cyclosweep.figures.style import save

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

DOCS = Path(__file__).parent
LOADS = (0.03, 0.5, 1.0, 4.0)
SHARING = {
    "active_output_pins_mean": "active output pins (2 discs)",
    "effective_output_pins": "effective output pins",
    "force_over_sine": "largest force / (4 T / (Z R))",
    "stiffness_over_tight": "tangent stiffness / without clearance",
}


def beside_the_paper(loads: Sequence[float], clearances: Sequence[float]) -> pl.DataFrame:
    """The published counts and the component model's over load and clearance, discs at equal reach.

    Parameters
    ----------
    loads : sequence of float
        Loads over the rated torque [1].
    clearances : sequence of float
        Clearances of the holes [mm]; at zero the ring has none either.

    Returns
    -------
    polars.DataFrame
        One row a clearance and load.
    """
    drive = cs.Drive.from_toml(DOCS.parent / "examples" / "components-87.toml")
    rows = [(clearance, load) for clearance in clearances for load in loads]
    variants = pl.DataFrame(
        {
            "hole_clearance_mm": [clearance for clearance, _ in rows],
            "ring_clearance_mm": [0.02 if clearance > 0 else 0.0 for clearance, _ in rows],
            "output_torque_nm": [drive.output_torque_nm * load for _, load in rows],
        }
    )
    level = drive.replace(disc_1_reach_mm=16.0, disc_2_reach_mm=16.0)
    found = cs.sweep(cs.Space.table(level, variants), model="components", solver="full")
    sine = 4 * pl.col("output_torque_nm") / (2 * 8 * 0.045)
    tight = pl.col("tangent_stiffness_100pct_without_clearance_nm_per_arcmin")
    return found.with_columns(
        load=pl.col("output_torque_nm") / drive.output_torque_nm,
        force_over_sine=pl.col("output_pin_force_max_n") / sine,
        stiffness_over_tight=pl.col("tangent_stiffness_100pct_nm_per_arcmin") / tight,
    )


def draw_sharing() -> None:
    """Write the picture of the counts, and print the table beside it."""
    figure, axes = plt.subplots(2, 2, figsize=(9, 6), layout="constrained")
    loads = [0.03 + 4.47 * k / 60 for k in range(61)]
    # Half of eight pins on each of two discs, their forces by the sine; the mean over the crank.
    of_sine = {"active_output_pins_mean": 8.0, "effective_output_pins": 6.49, "force_over_sine": 1}
    for clearance in (0.0, 0.05, 0.15):
        table = beside_the_paper(loads, [clearance])
        for panel, name in zip(axes.flat, SHARING, strict=True):
            panel.plot(table["load"], table[name], label=f"{clearance:g} mm")
    for panel, (name, label) in zip(axes.flat, SHARING.items(), strict=True):
        if name in of_sine:
            panel.axhline(of_sine[name], color="0.3", linestyle=":", label="sine statics")
        if name == "active_output_pins_mean":
            mean = table["active_pins_mean"][0]
            panel.axhline(mean, color="0.3", linestyle="--", label="published map")
        panel.set_xlabel("load / rated torque")
        panel.set_ylabel(label)
        panel.grid(alpha=0.3)
    axes[0, 0].legend(title="hole clearance", fontsize=8)
    figure.savefig(DOCS / "component-sharing.png", dpi=110)
    names = (
        *("hole_clearance_mm", "load", "active_pins_mean", "torque_transfer_efficiency"),
        *("pin_participation_statics", "active_output_pins_min", *SHARING),
    )
    print("|", " | ".join(names), "|")
    for row in beside_the_paper(LOADS, (0.0, 0.05, 0.15)).select(names).iter_rows():
        print("|", " | ".join(f"{value:.3g}" for value in row), "|")


def draw_curves() -> None:
    """Write the picture of torque over twist, from either shaft."""
    drive = cs.Drive.from_toml(DOCS.parent / "examples" / "components-87.toml")
    figure, (at_input, at_output) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
    for clearance in (0.0, 0.05, 0.2):
        of = drive.replace(
            hole_clearance_mm=clearance, ring_clearance_mm=0.02 if clearance else 0.0
        )
        panels: tuple[tuple[Axes, Side], ...] = ((at_input, "input"), (at_output, "output"))
        for panel, side in panels:
            table = of.torque_twist(side).table
            (line,) = panel.plot(table["angle_deg"], table["load_tn"], label=f"{clearance:g} mm")
            if side == "input" and clearance == 0.2:
                for name in ("loading_torque_nm", "unloading_torque_nm"):
                    load = table[name] / drive.nominal_torque_nm
                    panel.plot(
                        table["angle_deg"],
                        load,
                        color=line.get_color(),
                        linestyle=":",
                        lw=1,
                        label="with friction" if name == "loading_torque_nm" else None,
                    )
    play, slope = drive.nominal_line("input")
    twist = [play + slope * drive.nominal_torque_nm * load for load in (0, 4.5)]
    at_input.plot(twist, (0, 4.5), color="0.3", linestyle="--", label="published model")
    for panel, label in (
        (at_input, "turn of the crank, output locked [deg]"),
        (at_output, "turn of the output, crank locked [deg]"),
    ):
        panel.set_xlabel(label)
        panel.set_ylabel("load / nominal torque")
        panel.grid(alpha=0.3)
    at_input.legend(title="hole clearance", fontsize=8)
    figure.savefig(DOCS / "component-curves.png", dpi=110)


def draw_loads() -> None:
    """Write the picture of twist, stiffness, active pins and ripple."""
    drive = cs.Drive.from_toml(DOCS.parent / "examples" / "components-87.toml")
    save(load_series_figure(drive), DOCS / "components.png", dpi=130)


def main() -> None:
    """Write all pictures."""
    draw_loads()
    draw_sharing()
    draw_curves()


if __name__ == "__main__":
    main()
