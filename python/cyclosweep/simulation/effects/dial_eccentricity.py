"""Angle sensor mounted off centre: an error periodic in the indicated angle itself."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, spread
from cyclosweep.simulation.effects.history import Floats, History

PHASES_DEG = tuple(15.0 * k for k in range(12))
"""Directions of the eccentricity in which it is looked for; half a turn, as its size may be
negative."""

BOTH: Shape = {"order": 1.0, "order_2": 2.0}
"""Errors once and twice a turn."""


class DialEccentricity(Effect):
    """Error ``a cos(angle) + b sin(angle)`` of the indicated angle.

    A disc that is tilted errs twice a turn: with `order_2` the same of twice the angle is added.
    """

    name = "dial_eccentricity"
    physics = (
        "A dial or encoder disc mounted off centre reads too much on one side and too little on "
        "the other. The error repeats with every turn of the dial."
    )
    source = "geometry: a circle read from a point off its centre"
    tell_tale = "periodic in the indicated angle itself"
    shown_by = "twists over a good part of a turn of the dial"
    family = "dial"
    vector = True
    forms = (ShapeForm(("order",), ("phase_deg",)), ShapeForm(("order", "order_2")))

    def untestable(self, history: History) -> str | None:
        """Need a good part of a turn."""
        if spread(history.angle_deg) < 30.0:
            return "the dial turned by less than 30 deg"
        return super().untestable(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Sinusoids of one and of two periods a turn of the dial, at phases all round.

        Sine and cosine together would claim a freedom that the recording may not have: over part
        of a turn the calibration takes up nearly all of the sine.
        """
        return [
            {"order": order, "phase_deg": phase} for order in (1.0, 2.0) for phase in PHASES_DEG
        ]

    def variants(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Sine and cosine together, whatever phase fits best; beside twice a turn also once."""
        return [{"order": 1.0} if shape["order"] == 1.0 else BOTH]

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Once and twice a turn."""
        return None if "order_2" in shape else BOTH

    def columns(self, history: History, shape: Shape) -> Floats:
        """Error for unit amplitudes [deg]."""
        turns = np.radians(history.angle_deg)
        angle = turns * shape["order"]
        if "phase_deg" in shape:
            return np.asarray(np.cos(angle - np.radians(shape["phase_deg"])))[:, None]
        once = [np.cos(angle), np.sin(angle)]
        if "order_2" not in shape:
            return np.column_stack(once)
        twice = turns * shape["order_2"]
        return np.column_stack([*once, np.cos(twice), np.sin(twice)])

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Amplitudes of the error."""
        if "phase_deg" in shape:
            return (Parameter("eccentric_deg", "deg", "largest error, in this direction"),)
        once = (
            Parameter("cos_deg", "deg", "error in phase with the cosine of the angle"),
            Parameter("sin_deg", "deg", "error in phase with the sine of the angle"),
        )
        if "order_2" not in shape:
            return once
        return (
            *once,
            Parameter("cos_2_deg", "deg", "error in phase with the cosine of twice the angle"),
            Parameter("sin_2_deg", "deg", "error in phase with the sine of twice the angle"),
        )
