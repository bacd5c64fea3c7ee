"""Lubricant drag: a torque in proportion to the rate of twist."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import cyclosweep._core as _core
from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.slip_path import (
    BY_READING,
    between_and_by_reading,
    check_flag,
    otherwise_read,
)

SHORTEST_LAG = 0.1
"""Lag below which nothing changes any more, in steps between samples."""
LEAST_RATE = 1e-12
"""Rate that stands for none [deg/s]."""
COARSE = 0.005
"""Usual step of the torque between readings, as a share of the largest torque, from which it
makes a difference whether the rate is that between the readings or that from reading to reading."""
THINNED, THINNING, APPROACH = "thinned_power", "thinning_deg_per_s", "approach_s"
"""Names in the shape: power of the rate above that of thinning, that rate, and the time in which
the torque rose to the first reading of a run."""
HOLDS_FRICTION = "holds_friction"
"""Name in the shape of a drag: 1 where the part that friction holds lags, as where drag and
friction act on one joint."""
OPTIONAL = (BY_READING, APPROACH, HOLDS_FRICTION)
"""What a shape may have or not."""
LEAST_THINNING, MOST_THINNING = 0.01, 10.0
"""Rates at which thinning may begin, over the usual rate of the recording."""
FAR_BELOW = 0.2
"""Rate of thinning from which its fit starts, over the usual rate."""
SHORTEST_APPROACH, LONGEST_APPROACH = 0.1, 1000.0
"""Time of the approach to a run, over the usual time between readings."""


class ViscousDrag(Effect):
    """Drag torque ``D (rate)^n`` against the motion, with n between 0.5 and 1.

    A lubricant that thins above some rate has the torque ``D rate (1 + (rate/r)^2)^((n-1)/2)``,
    over its value at 1 deg/s: r is `thinning_deg_per_s`, and n is `thinned_power`, which stands in
    place of `power`. As root mean squares it is within 1 % of Eyring's law ``asinh(rate/k)`` over
    two decades of rates, up to 20 k.

    The elastic effects carry less by this torque: where they make the drive softer, drag makes the
    loop wider (`History.drag_compliance`). The rate itself is that of the straight line.

    The rate is that of the twist itself, which lags behind the torque:
    ``T = theta/C + D (dtheta/dt)^n``, which shows at reversals. `lag_s` is the time constant, the
    drag over the rate and times the compliance, at the usual rate of the recording.

    The torque grows evenly from reading to reading, and the twist follows it in between. With
    `by_reading` 1 the rate is instead that from one reading to the next, as in simulations that
    take one implicit step a reading. The two differ where the lag is not much shorter than the time
    between readings.

    Beside friction the part that friction holds follows the torque, as where drag and friction act
    at different places. With `holds_friction` 1 that part lags, and friction turns when it turns,
    later than the torque, as where both act on one joint.

    A run is reached from zero torque at the rate of its first readings, or in the time
    `approach_s`; where that is long, its first reading does not lag. It belongs to the recorded
    programme: leave it out for another one.
    """

    name = "viscous_drag"
    physics = (
        "The lubricant shears as the drive twists and resists in proportion to the rate. "
        "The drive is twisted by what the drag leaves of the torque."
    )
    source = (
        "Volbeda, MSc thesis 2024 (viscous 1.3 N m s/rev); Newton's law of viscosity; thinning: "
        "Carreau, Trans. Soc. Rheol. 16(1), 1972"
    )
    tell_tale = "torque in proportion to twist rate"
    shown_by = "a clock, and runs at different rates"
    family = "hysteresis"
    is_drag = True
    needs = ("time_s",)
    shape_parameters = (
        Parameter("power", "", "power of the rate", 0.5, 1.0),
        Parameter(THINNED, "", "power of the rate above that of thinning", 0.1, 1.0),
        Parameter(THINNING, "deg/s", "rate at which thinning begins", 0.0, np.inf, True),
        Parameter(APPROACH, "s", "time from zero torque to the first reading", 0.0, np.inf, True),
    )
    forms = (
        ShapeForm(("power", "lag_s"), OPTIONAL),
        ShapeForm((THINNED, THINNING, "lag_s"), OPTIONAL),
    )

    def shapes(self, history: History) -> Sequence[Shape]:
        """Newtonian and thinning drag, too small yet to lag."""
        lag = SHORTEST_LAG * history.rate_step_s
        return [{"power": power, "lag_s": lag} for power in (1.0, 0.7)] if lag > 0 else []

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Rates and times near the usual ones of the recording."""
        least, most = parameter.lower, parameter.upper
        if parameter.name == THINNING:
            usual = _usual_rate(history)
            least, most = LEAST_THINNING * usual, MOST_THINNING * usual
        elif parameter.name == APPROACH:
            step = max(history.usual_step_s, LEAST_RATE)
            least, most = SHORTEST_APPROACH * step, LONGEST_APPROACH * step
        return replace(parameter, lower=least, upper=most)

    def variants(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Rates between the readings and from reading to reading, where these are few."""
        both = between_and_by_reading(shape)
        return both if _is_coarse(history) else both[:1]

    def refinements(self, history: History, shape: Shape) -> Sequence[Shape]:
        """The other rates, another approach to the runs, and drag that thins above some rate."""
        found = [otherwise_read(shape)] if _is_coarse(history) else []
        if APPROACH in shape:
            found.append({k: v for k, v in shape.items() if k != APPROACH})
        else:
            found.append({**shape, APPROACH: 10.0 * history.usual_step_s})
        found.append(_thinning_otherwise(shape, _usual_rate(history)))
        return found

    def consistent(self, history: History, shape: Shape, amplitudes: Floats) -> Shape:
        """Shape with the lag of this drag at the usual rate."""
        usual = _usual_rate(history)
        drag = max(float(amplitudes[0]), 0.0) * _resistance(shape, usual) / usual
        shortest = SHORTEST_LAG * history.rate_step_s
        return {**shape, "lag_s": max(drag * history.compliance_deg_per_nm, shortest)}

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist taken away by a drag of 1 N m at 1 deg/s [deg]."""
        lag, thinning = float(shape["lag_s"]), shape.get(THINNING)
        power = float(shape["power"] if thinning is None else shape[THINNED])
        compliance, usual = history.compliance_deg_per_nm, _usual_rate(history)
        torque, rate_nm = history.elastic_nm, usual / compliance
        by_sample = bool(shape.get(BY_READING, 0.0))
        through, lapse, restart = torque, history.lapse_s, history.restart
        if APPROACH in shape:
            lapse = np.where(restart, shape[APPROACH], lapse)
        corners = history.corners
        if len(corners) and not by_sample:
            at_corner = history.corner_nm
            if at_corner is None:
                at_corner = corners.torque_nm - corners.between(history.applied_nm - torque)
            through = corners.insert(torque, at_corner)
            lapse, restart = corners.lapse_s(lapse), corners.insert(restart, False)
        knee_nm = None if thinning is None else thinning / compliance
        carried = _core.dragged(through, lapse, restart, lag, power, rate_nm, by_sample, knee_nm)
        if len(through) > len(torque):
            carried = corners.taken_out(carried)
        # What is not carried is drag: lag times the usual rate where the twist moves at that rate.
        resisted = (torque - carried) / (lag * rate_nm)
        lost = compliance if history.drag_compliance is None else history.drag_compliance
        return np.asarray(-lost * _resistance(shape, usual) * resisted)[:, None]

    def known_shape(self, shape: Shape) -> Shape:
        """Refuse what no drag has, and a flag that is neither 0 nor 1; see `Effect`.

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
            A shape parameter is unknown, missing, or out of range.
        """
        known = super().known_shape(shape)
        if not known["lag_s"] > 0.0:
            raise InputError(f"lag_s: found {known['lag_s']:g}, expected more than 0")
        if not known.get(THINNING, LEAST_RATE) >= LEAST_RATE:
            raise InputError(
                f"{THINNING}: found {known[THINNING]:g}, expected {LEAST_RATE:g} or more"
            )
        power = known.get(THINNED, known.get("power", 1.0))
        if not 0.0 < power <= 1.0:
            raise InputError(f"power of the rate: found {power:g}, expected above 0 and up to 1")
        check_flag(known, BY_READING)
        check_flag(known, HOLDS_FRICTION)
        return known

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Drag torque at a rate of 1 deg/s."""
        return (Parameter("drag_nm", "N m", "drag torque at 1 deg/s", 0.0),)


def holds_friction(shape: Shape) -> bool:
    """Whether the part that friction holds lags with a drag of this shape."""
    return bool(shape.get(HOLDS_FRICTION, 0.0))


def placed_otherwise(shape: Shape) -> Shape:
    """Drag of the part that friction holds, or beyond it, whichever it is not."""
    if holds_friction(shape):
        return {name: value for name, value in shape.items() if name != HOLDS_FRICTION}
    return {**shape, HOLDS_FRICTION: 1.0}


def _thinning_otherwise(shape: Shape, usual_rate: float) -> Shape:
    """Drag that thins above some rate instead of at all rates, or the other way about."""
    rest = {k: v for k, v in shape.items() if k not in ("power", THINNED, THINNING)}
    if THINNING in shape:
        return {"power": max(shape[THINNED], 0.5), **rest}
    # Far above the rate of thinning the drag goes with the same power of the rate.
    return {THINNED: min(shape["power"], 0.8), THINNING: FAR_BELOW * usual_rate, **rest}


def _resistance(shape: Shape, rate: float) -> float:
    """Drag at a rate [deg/s] over that at 1 deg/s."""
    if THINNING not in shape:
        return float(rate ** shape["power"])
    square = np.array([rate, 1.0]) / shape[THINNING]
    at_rate, at_one = (1.0 + square**2) ** (0.5 * (shape[THINNED] - 1.0))
    return float(rate * at_rate / at_one)


def _is_coarse(history: History) -> bool:
    """Whether readings are so few that the two rates may be told apart."""
    step_nm = np.abs(np.diff(history.applied_nm))[np.diff(history.run) == 0]
    step_nm = step_nm[step_nm > 0.0]
    return len(step_nm) > 0 and bool(np.median(step_nm) > COARSE * history.largest_torque_nm)


def _usual_rate(history: History) -> float:
    """Root mean square rate of the elastic twist [deg/s]."""
    if history.usual_step_s <= 0.0:
        return LEAST_RATE
    rate = history.compliance_deg_per_nm * np.diff(history.applied_nm) / history.usual_step_s
    return max(float(np.sqrt(np.mean(rate**2))), LEAST_RATE)
