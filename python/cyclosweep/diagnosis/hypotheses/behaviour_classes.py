"""Classes of behaviour: what mismatches look like, whatever the law behind them.

Each class is a flexible group of columns, all amplitudes of which are small or large together. A
loop that opens with the load is of the same class by whichever law friction follows, so that a
class can be told where no law of the library holds.
"""

from collections.abc import Iterator

import numpy as np

import cyclosweep._core as _core
from cyclosweep.diagnosis.hypotheses.shape_columns import hats, lapse, rates
from cyclosweep.simulation.effects.bounds import FEWEST_STEPS
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.mesh_range import mesh_positions

ODD_CURVE = "odd curve of the torque"
EVEN_CURVE = "even curve of the torque"
LOOP = "loop of constant width"
OPENING_LOOP = "loop that opens with the load"
RATE_LOOP = "loop that opens with the rate"
RELAXATION = "slow change with time"
POSITION = "offset that goes with the position of the mesh"
POSITION_COMPLIANCE = "compliance that goes with the position of the mesh"
RUN = "zero that moves from run to run"
RUN_COMPLIANCE = "compliance that changes from run to run"
RUN_PLAY = "play that changes from run to run"
TEMPERATURE = "change that follows the temperature"

CLASSES_OF_FAMILY = {
    "smooth odd curve": (ODD_CURVE,),
    "even curve": (EVEN_CURVE,),
    "dial": (ODD_CURVE, EVEN_CURVE),
    "hysteresis": (RATE_LOOP,),
    "relaxation": (RELAXATION,),
    "run offsets": (RUN, POSITION, TEMPERATURE),
    "position": (POSITION_COMPLIANCE,),
}
"""The classes of which effects of a family are, by the name of the family; frictions apart, whose
loops are of constant width or open with the load by their own limits."""
CLASSES_OF_EFFECT = {
    "datum_drift": (RUN,),
    "transmission_error": (POSITION,),
    "thermal_drift": (TEMPERATURE,),
}
"""The same for effects of a family whose members differ in what they follow."""
LOOPS = frozenset({LOOP, OPENING_LOOP, RATE_LOOP})
"""Classes of what tells loading from unloading."""
WAYS_APART = LOOPS | {RELAXATION}
"""Classes of what parts the ways to and fro."""
ONE_CAUSE = (POSITION, POSITION_COMPLIANCE, TEMPERATURE)
"""Classes that say what the twist follows. Any law that follows the same has the same name, however
its waves or its delays differ."""

KNOTS = 24
"""Intervals of the load in which a smooth curve bends."""
CROWDED = 1.5
"""Power of the even spread by which the knots crowd at small loads, where contacts bend most."""
PLAYS = (0.01, 0.03, 0.08, 0.2, 0.4)
"""Half widths of the plays whose sum is a loop, as shares of the largest torque."""
SENSE_SHARE = 0.3
"""Size of the loop without presliding beside the plays, whose largest size is their half width."""
DELAYS = 6
"""Time constants of a relaxation, from a few samples to a third of the recording."""
DIGRESSIVE = 0.75
"""Power of the rate between a square root and the rate itself."""
WARMING_S = (60.0, 300.0, 1000.0)
"""Delays with which a drive follows the temperature that is read [s]."""
FEWEST_STATES = 3
"""Positions or runs from which what differs between them is a class of its own."""
MOST_POSITIONS, MOST_RUNS = 40, 60
"""Positions and runs beyond which offsets of their own would follow anything."""


def class_columns(history: History, conditioning_nm: float = 0.0) -> dict[str, Floats]:
    """Columns of every class that a recording can show.

    Parameters
    ----------
    history : History
        Load history of n rows.
    conditioning_nm : float
        Load to and fro before each run, with the sign of its last end [N m]; zero: loops begin
        fresh.

    Returns
    -------
    dict of str to ndarray, shape (n, k)
        By the name of the class.
    """
    return (
        dict(_curves_and_loops(history, conditioning_nm))
        | dict(_in_time(history))
        | dict(_by_state(history))
    )


def smooth_columns(share: Floats) -> Floats:
    """Curves whose slope is a random walk: independent amplitudes of them make any smooth curve.

    Parameters
    ----------
    share : ndarray, shape (n,)
        Load over the largest load, from 0 to 1.

    Returns
    -------
    ndarray, shape (n, k)
        Of variance one at a share of one, by the prior of a cubic smoothing spline.
    """
    knots = np.linspace(0.0, 1.0, KNOTS + 1) ** CROWDED
    low, high = np.minimum.outer(knots, knots), np.maximum.outer(knots, knots)
    covariance = low**2 * (3.0 * high - low) / 2.0
    size, mix = np.linalg.eigh(covariance)
    kept = size > 1e-8 * size[-1]
    return np.asarray(hats(share, knots) @ (mix[:, kept] * np.sqrt(size[kept])))


def _curves_and_loops(history: History, conditioning_nm: float) -> Iterator[tuple[str, Floats]]:
    """Curves of the torque and loops that need no clock.

    Parameters
    ----------
    history : History
        Load history of n rows.
    conditioning_nm : float
        See `class_columns`.

    Yields
    ------
    str, ndarray of shape (n, k)
        Name of a class, and its columns.
    """
    top, side, sense = history.largest_torque_nm, history.side, history.sense
    load = np.clip(history.load_nm / top, 0.0, 1.0)
    smooth = smooth_columns(load)
    yield ODD_CURVE, side[:, None] * smooth
    if np.any(side > 0) and np.any(side < 0):
        yield EVEN_CURVE, np.column_stack([smooth, load])
    torque, worked = history.applied_nm, np.array([-conditioning_nm, conditioning_nm])
    followed = []
    for width in (share * top for share in PLAYS):
        left_at = _core.play(worked, width, np.zeros(2, dtype=bool), np.zeros(2))[-1]
        start = np.full(len(history), left_at)
        followed.append(_core.play(torque, width, history.restart, start))
    plays = (torque[:, None] - np.column_stack(followed)) / top
    yield LOOP, np.column_stack([plays, SENSE_SHARE * sense])
    yield OPENING_LOOP, np.column_stack([load[:, None] * plays, load * sense])


def _in_time(history: History) -> Iterator[tuple[str, Floats]]:
    """Relaxation and what goes with the rate, where there is a clock."""
    if history.time_s is None or history.usual_step_s <= 0:
        return
    top = history.largest_torque_nm
    shortest = FEWEST_STEPS * history.usual_step_s
    longest = max(float(np.bincount(history.run, lapse(history)).max()), 3.0 * shortest)
    late = [
        _core.creep_state(history.applied_nm, history.time_s, history.restart, float(delay))
        for delay in np.geomspace(shortest, longest, DELAYS)
    ]
    yield RELAXATION, np.column_stack(late) / top
    rate = rates(history)[:, 0]
    share = np.abs(rate) / max(float(np.abs(rate).max()), 1e-300)
    powers = [np.sign(rate) * share**power for power in (0.5, DIGRESSIVE, 1.0)]
    yield RATE_LOOP, np.column_stack(powers)


def _by_state(history: History) -> Iterator[tuple[str, Floats]]:
    """What differs between positions, between runs, and with the temperature."""
    elastic = history.elastic_nm / history.largest_torque_nm
    if history.crank_deg is not None:
        place = mesh_positions(history.crank_deg)
        places = np.unique(place)
        if FEWEST_STATES <= len(places) <= MOST_POSITIONS:
            one = (place[:, None] == places).astype(np.float64)
            yield POSITION, one
            yield POSITION_COMPLIANCE, one * elastic[:, None]
    if FEWEST_STATES <= history.run_count <= MOST_RUNS:
        one = (history.run[:, None] == np.arange(history.run_count)).astype(np.float64)
        yield RUN, one
        yield RUN_COMPLIANCE, one * elastic[:, None]
        if np.any(history.side > 0) and np.any(history.side < 0):
            yield RUN_PLAY, one * history.side[:, None]
    if history.temperature_c is None or not np.ptp(history.temperature_c) > 0:
        return
    warm = history.temperature_c - float(np.mean(history.temperature_c))
    warm = warm / float(np.abs(warm).max())
    parts = [warm, warm * history.side, warm * elastic]
    if history.time_s is not None:
        once = np.arange(len(history)) == 0
        for delay in WARMING_S:
            late = _core.creep_state(warm, history.time_s, once, delay)
            parts += [late, late * history.side]
    yield TEMPERATURE, np.column_stack(parts)
