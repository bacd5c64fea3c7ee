"""A module for --plugin: an effect, a column and a constraint of one's own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep import plugins
from cyclosweep.simulation.effects import Effect, History, Parameter, Shape, register


class SpringWasher(Effect):
    """Washers that give way between two loads, where they are neither seated nor flat."""

    name = "spring_washer"
    physics = "Spring washers give way once their preload is passed. They are flat at twice that."
    source = "the assembly drawing"
    tell_tale = "soft between two loads"
    family = "smooth odd curve"
    elastic = True  # a function of the load alone
    shape_parameters = (Parameter("preload_nm", "N m", "load that unseats the washers", 0.0, 1e3),)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Preloads up to half of the largest load, from which a fit goes on."""
        return [{"preload_nm": s * history.largest_torque_nm} for s in (0.1, 0.2, 0.3, 0.4, 0.5)]

    def columns(self, history: History, shape: Shape) -> npt.NDArray[np.float64]:
        """Twist between the preload and twice that, for a unit of compliance [deg]."""
        preload = float(shape["preload_nm"])
        twist = history.side * np.clip(history.load_nm - preload, 0.0, preload)
        return np.asarray(twist[:, None])

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """What multiplies the column: the compliance of the washers, not below zero."""
        return (Parameter("washer_compliance", "deg/(N m)", "compliance of the washers", 0.0),)


register(SpringWasher())

STEEL_KG_PER_MM3 = 7.85e-6


@plugins.column(
    "output_pin_mass_kg",
    meaning="mass of all output pins",
    needs=["output_pin_count", "output_pin_diameter_mm"],
)
def output_pin_mass(rows: pl.DataFrame) -> pl.Series:
    """Solid pins of 40 mm."""
    section = np.pi / 4 * rows["output_pin_diameter_mm"] ** 2
    return rows["output_pin_count"] * section * 40.0 * STEEL_KG_PER_MM3


@plugins.constraint("pins_apart", needs=["output_pin_count", "output_pin_diameter_mm"])
def pins_are_apart(rows: pl.DataFrame) -> pl.Series:
    """At least 10 mm between neighbouring pins on their circle of 45 mm."""
    distance = 2 * 45.0 * (np.pi / rows["output_pin_count"]).sin()
    return distance - rows["output_pin_diameter_mm"] >= 10.0
