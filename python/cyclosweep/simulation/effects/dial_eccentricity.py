"""Angle sensor mounted off centre or tilted: an error periodic in the indicated angle itself."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, spread
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.orders import DIAL_ORDERS

PHASES_DEG = tuple(15.0 * k for k in range(12))
"""Directions of the eccentricity in which it is looked for; half a turn, as its size may be
negative."""

BOTH: Shape = {"order": 1.0, "order_2": 2.0}
"""Errors once and twice a turn."""
TWO_ORDERS = 6.0
"""Log prior odds against an error twice a turn beside that once a turn [nat]."""
LEAST_PART = 0.03
"""Even over odd part, or odd over even, from which an error is neither."""
MOST_STEEP = 0.25
"""Slope of the error in the angle from which it is no dial's: its centre would be off by a quarter
of its radius."""


class DialEccentricity(Effect):
    """Error ``a cos(angle) + b sin(angle)`` of the indicated angle.

    A disc that is tilted, or a universal joint between shaft and dial, errs twice a turn: the order
    is then two, or with `order_2` the same of twice the angle is added.
    Over part of a turn these make many curves. They are called by this name only where the error
    has an even and an odd part: what is nearly even is a side load, what is nearly odd a contact.
    """

    name = "dial_eccentricity"
    physics = (
        "A dial or encoder disc mounted off centre reads too much on one side and too little on "
        "the other. The error repeats with every turn of the dial, twice where the disc is tilted "
        "or a universal joint turns it."
    )
    source = (
        "geometry: a circle read from a point off its centre; once and twice a turn: Lu, Trumper, "
        "CIRP Ann. 56, 2007; joints: Seherr-Thoss, Schmelz, Aucktor, Universal Joints and "
        "Driveshafts, 2006"
    )
    tell_tale = "periodic in the indicated angle itself"
    shown_by = "twists over a good part of a turn of the dial"
    family = "dial"
    vector = True
    forms = (ShapeForm(("order",), ("phase_deg",)), ShapeForm(("order", "order_2")))

    def known_shape(self, shape: Shape) -> Shape:
        """Refuse orders that are none, or the same twice; see `Effect.known_shape`.

        Parameters
        ----------
        shape : mapping
            Shape parameters by name, in any order.

        Returns
        -------
        mapping

        Raises
        ------
        InputError
            A shape parameter is unknown or missing, or the orders are neither 1, nor 2, nor both.
        """
        known = super().known_shape(shape)
        orders = [known[name] for name in ("order", "order_2") if name in known]
        if orders not in ([1.0], [2.0], [1.0, 2.0]):
            found = " ".join(f"{order:g}" for order in orders)
            raise InputError(f"order: found {found}, expected 1, or 2, or 1 and 2")
        return known

    def untestable(self, history: History) -> str | None:
        """Need a good part of a turn."""
        if spread(history.angle_deg) < 30.0:
            return "the dial turned by less than 30 deg"
        return super().untestable(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Sinusoids of one period a turn of the dial, or of two, at phases all round.

        Sine and cosine together would claim a freedom that the recording may not have: over part
        of a turn the calibration takes up nearly all of the sine.
        """
        return [
            {"order": order, "phase_deg": phase} for order in DIAL_ORDERS for phase in PHASES_DEG
        ]

    def variants(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Sine and cosine together, whatever phase fits best."""
        return [{"order": shape["order"]}]

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Once and twice a turn."""
        return None if "order_2" in shape else BOTH

    def penalty(self, shape: Shape) -> float:
        """Two orders hold many curves: they cost what a further law costs."""
        return TWO_ORDERS if "order_2" in shape else 0.0

    def is_recognised(self, history: History, shape: Shape, amplitudes: Floats) -> bool:
        """Whether an error of two orders is no larger than a dial's, and neither even nor odd."""
        if "order_2" not in shape:
            return True
        sizes = np.hypot(amplitudes[::2], amplitudes[1::2])
        if float(np.radians(sizes) @ (1.0, 2.0)) > MOST_STEEP:
            return False
        error = self.columns(history, shape) @ amplitudes
        even, odd = _even_and_odd(error, history.load_nm, history.side)
        return min(even, odd) >= LEAST_PART * max(even, odd)

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
        of = "the angle" if shape["order"] == 1.0 else f"{shape['order']:g} times the angle"
        once = (
            Parameter("cos_deg", "deg", f"error in phase with the cosine of {of}"),
            Parameter("sin_deg", "deg", f"error in phase with the sine of {of}"),
        )
        if "order_2" not in shape:
            return once
        return (
            *once,
            Parameter("cos_2_deg", "deg", "error in phase with the cosine of twice the angle"),
            Parameter("sin_2_deg", "deg", "error in phase with the sine of twice the angle"),
        )


def _even_and_odd(error: Floats, load_nm: Floats, side: Floats) -> tuple[float, float]:
    """Root mean squares of the even and of the odd part of a curve, its straight lines taken out.

    Parameters
    ----------
    error : ndarray, shape (n,)
        The curve [deg].
    load_nm : ndarray, shape (n,)
        Magnitude of the torque [N m].
    side : ndarray, shape (n,)
        Sign of the flank.

    Returns
    -------
    even, odd : float
        In deg.
    """
    part = load_nm / max(float(load_nm.max()), 1e-300)
    powers = np.column_stack([part**k for k in range(5)])
    odd_powers = side[:, None] * powers
    found = np.linalg.lstsq(np.column_stack([powers, odd_powers]), error, rcond=None)[0]
    even, odd = powers @ found[:5], odd_powers @ found[5:]
    line = np.linalg.lstsq(odd_powers[:, :2], odd, rcond=None)[0]
    return float(np.std(even)), float(np.sqrt(np.mean((odd - odd_powers[:, :2] @ line) ** 2)))
