"""Pins or teeth with unequal clearances come into contact one after another."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, listed
from cyclosweep.simulation.effects.history import Flags, Floats, History
from cyclosweep.simulation.effects.scattered import acting_beyond

LATEST_FIRST = 0.45
"""Load of the first engagement at most, as a share of the largest load."""
KINKS = 6
"""Most loads at which the slope drops."""
FIRST, WIDTH = (0.02, 0.4), (0.1, 1.0)
"""Loads of first engagement, and ranges, in which it is looked for, over the largest load."""
MIDDLE, SPREAD = (0.1, 0.55), (0.08, 0.35)
"""Loads about which scattered clearances close, over the largest load, and their spread over that
load. With a wider spread many would be closed before any load, which is a contact that stiffens."""


class ClearanceTakeup(Effect):
    """Compliance that drops while further pins engage, between two loads.

    Below `first_nm` the first pins carry alone; up to `first_nm + range_nm` the others engage, and
    the compliance falls by the amplitude. A range of zero is a single kink. Clearances are small
    against the elastic twist and differ from pin to pin, so the first engagement lies in the lower
    half of the range, and the others follow over a part of it or all; one kink far up is what a
    sensor at its limit shows. Clearances scattered about a mean close about the load ``T1`` of
    `middle_nm`, three quarters of them within ``2 w`` of it with ``w`` the `spread` times ``T1``:
    ``-dC w (log(1 + exp((|T| - T1)/w)) - log(1 + exp(-T1/w)))``.
    """

    name = "clearance_takeup"
    physics = (
        "Pins or teeth with larger clearance join in only after some twist. Each one that engages "
        "drops the slope of the curve by a step."
    )
    source = "Kumar et al. 2016, section 4 (pins that come to carry one after another)"
    tell_tale = "slope drops in steps at certain twists"
    shown_by = "a wider range of torque"
    family = "smooth odd curve"
    elastic = True
    dense = True
    shape_parameters = (
        Parameter("first_nm", "N m", "load at which the next pins engage", 1e-3, 1e6),
        Parameter("range_nm", "N m", "range of load over which they engage", 1e-3, 1e6),
        Parameter("middle_nm", "N m", "load about which scattered clearances close", 1e-3, 1e6),
        Parameter("spread", "", "logistic scale of these loads over that load", *SPREAD, True),
        *(
            Parameter(f"kink_{k}_nm", "N m", f"load at which pins of group {k} engage", 0.0, 1e6)
            for k in range(1, KINKS + 1)
        ),
    )
    forms = (
        ShapeForm(("first_nm", "range_nm")),
        ShapeForm(("middle_nm", "spread")),
        ShapeForm(numbered="kink_{}_nm"),
    )

    def shapes(self, history: History) -> Sequence[Shape]:
        """Loads of first engagement and ranges, or middles and spreads of scattered ones."""
        top = history.largest_torque_nm
        ranges: list[Shape] = [
            {"first_nm": first * top, "range_nm": width * top}
            for first in np.linspace(*FIRST, 8)
            for width in np.linspace(*WIDTH, 6)
        ]
        return ranges + [
            {"middle_nm": float(middle) * top, "spread": float(spread)}
            for middle in np.linspace(*MIDDLE, 6)
            for spread in np.geomspace(*SPREAD, 4)
        ]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Range of engagement from the lower half; kinks anywhere, as they may change places."""
        top = history.largest_torque_nm
        if parameter.name == "first_nm":
            return replace(parameter, lower=0.0, upper=LATEST_FIRST * top)
        if parameter.name == "middle_nm":
            return replace(parameter, lower=MIDDLE[0] * top, upper=MIDDLE[1] * top)
        if parameter.name == "spread":
            return parameter
        if parameter.name.startswith("kink"):
            return replace(parameter, lower=0.0, upper=0.9 * top)
        return replace(parameter, lower=1e-3 * top, upper=0.9 * top)

    def is_recognised(self, history: History, shape: Shape, amplitudes: Floats) -> bool:
        """First engagement in the lower half; a kink further out is what a sensor's limit shows."""
        return min(_kinks(shape)) <= LATEST_FIRST * history.largest_torque_nm

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist lost for a unit drop of compliance [deg]."""
        load, side = history.load_nm, history.side
        if "middle_nm" in shape:
            closed = acting_beyond(load, shape["middle_nm"], shape["spread"])
            return np.asarray(-side * closed)[:, None]
        if "first_nm" not in shape:
            return np.column_stack(
                [-side * np.maximum(load - kink, 0.0) for kink in shape.values()]
            )
        first, width = shape["first_nm"], max(shape["range_nm"], 1e-9)
        begun = np.maximum(load - first, 0.0)
        done = np.maximum(load - first - width, 0.0)
        return np.asarray(-side * (begun**2 - done**2) / (2 * width))[:, None]

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Kinks of both; a range of engagement becomes a kink at either end."""
        return listed("kink_{}_nm", [*_kinks(shape), *_kinks(found)], KINKS)

    def reduced(self, shape: Shape, wrong: Flags) -> Shape | None:
        """Kinks at which the slope drops."""
        if _is_gradual(shape):
            return None
        kept = [kink for kink, w in zip(shape.values(), wrong, strict=True) if not w]
        return listed("kink_{}_nm", kept, KINKS)

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Compliance lost by the engagement."""
        count = 1 if _is_gradual(shape) else len(shape)
        return tuple(
            Parameter(f"compliance_drop_{k}", "deg/(N m)", "compliance lost by engagement", 0.0)
            for k in range(1, count + 1)
        )


def _is_gradual(shape: Shape) -> bool:
    """Whether the slope drops over a range of loads, by one amplitude, and not at kinks."""
    return "first_nm" in shape or "middle_nm" in shape


def _kinks(shape: Shape) -> list[float]:
    """Loads at which the slope drops, or between which most of a gradual drop lies."""
    if "first_nm" in shape:
        return [shape["first_nm"], shape["first_nm"] + shape["range_nm"]]
    if "middle_nm" in shape:
        middle, half = shape["middle_nm"], 1.5 * shape["spread"] * shape["middle_nm"]
        return [middle - half, middle + half]
    return list(shape.values())
