"""Unnamed shapes of a residual, such as steps, bumps and drifts, which compete with named effects.

Where one of them explains the recording better than every named effect, no effect is named.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    FEWEST_STATES,
    MOST_POSITIONS,
    MOST_RUNS,
)
from cyclosweep.diagnosis.hypotheses.shape_columns import (
    after,
    beyond,
    bump,
    clipped,
    clock_of,
    constant,
    hats,
    lapse,
    one_run,
    rates,
    relaxing,
    softer_after,
    wider_after,
)
from cyclosweep.simulation.effects.bounds import FEWEST_STEPS
from cyclosweep.simulation.effects.history import Flags, Floats, History
from cyclosweep.simulation.effects.mesh_range import mesh_positions


@dataclass(frozen=True, eq=False)
class UnnamedShape:
    """One shape of twist that is no known effect.

    Attributes
    ----------
    family : str
        What kind of shape it is, in words for a reader.
    place : str
        Where it sits, in words for a reader.
    make : callable
        From a load history of n rows to columns for unit amplitudes, shape (n, k) [deg].
    positive : bool
        Whether its amplitude cannot be negative.
    elastic : bool
        Whether it is a function of the elastic torque, flank and direction alone.
    """

    family: str
    place: str
    make: Callable[[History], Floats]
    positive: bool = False
    elastic: bool = False


_OFFSETS = frozenset({"run offsets"})
_LOOPS = frozenset({"hysteresis"})
_PLACES = frozenset({"position"})
_CURVES = frozenset({"smooth odd curve", "dial"})
FAMILIES_ALIKE = {
    "step of the angle": _OFFSETS,
    "slip within a run": _OFFSETS,
    "change of play": _OFFSETS | _PLACES,
    "one run apart": _OFFSETS,
    "slow drift": _OFFSETS,
    "drift within runs": _OFFSETS,
    "wandering of the zero": _OFFSETS | _PLACES,
    "position offsets": _OFFSETS,
    "compliance by run": _PLACES,
    "compliance by position": _PLACES,
    "change of compliance": _PLACES,
    "bump at a load": _CURVES | {"even curve"},
    "saturation at the end of the range": _CURVES | {"even curve"},
    "smooth odd curve": _CURVES,
    "even curve": frozenset({"even curve", "dial"}),
    "hysteresis": _LOOPS,
    "loop by rate": _LOOPS,
    "torque and direction": _LOOPS,
    "relaxation": frozenset({"relaxation"}),
}
"""Families of effects that look like an unnamed shape: beside it they are not named, because part
of what they explain belongs to it."""


def unnamed_shapes(history: History, fitted: Flags) -> Iterator[UnnamedShape]:
    """All unnamed shapes that a recording can show.

    Parameters
    ----------
    history : History
        All n rows of the recording.
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.

    Yields
    ------
    UnnamedShape
    """
    yield from _steps(history, fitted)
    yield from _bumps(history)
    yield from _clips(history)
    yield from _curves(history)
    yield from _cells(history)
    yield from _runs(history)
    yield from _trends(history)
    yield from _windows(history, fitted)
    yield from _positions(history)


def _steps(history: History, fitted: Flags) -> Iterator[UnnamedShape]:
    """Steps of angle, play or compliance at places spread evenly over the fitted rows.

    Parameters
    ----------
    history : History
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.

    Yields
    ------
    UnnamedShape
    """
    index = np.flatnonzero(fitted)
    count = min(60, len(index) // 8)
    if count < 1:
        return
    places = index[np.linspace(0, len(index) - 1, count + 2)[1:-1].astype(int)]
    for place in places:
        label = from_place(history, place)
        yield UnnamedShape(
            "step of the angle",
            label,
            partial(after, place, None),
        )
        yield UnnamedShape(
            "slip within a run",
            label + " to the end of that run",
            partial(after, place, int(history.run[place])),
        )
        if np.any(history.side > 0) and np.any(history.side < 0):
            yield UnnamedShape("change of play", label, partial(wider_after, place))
    for place in places[::3]:
        yield UnnamedShape(
            "change of compliance",
            from_place(history, place),
            partial(softer_after, place),
        )


def from_place(history: History, row: int) -> str:
    """Words for the rows of a recording from one on.

    Parameters
    ----------
    history : History
    row : int
        The first of them.

    Returns
    -------
    str
    """
    what = "t = {:.4g} s" if history.time_s is not None else "row {:.0f}"
    return f"from {what.format(clock_of(history)[row])} (run {history.run[row] + 1})"


def _bumps(history: History) -> Iterator[UnnamedShape]:
    """Bumps at a load, on both flanks or on one."""
    top = history.largest_torque_nm
    for width in (0.03, 0.06, 0.12):
        for centre in np.arange(0.05, 1.0, 1.2 * width):
            for flank in (0, 1, -1):
                if flank and not np.any(history.side == flank):
                    continue
                where = "" if flank == 0 else f" {'positive' if flank > 0 else 'negative'}"
                yield UnnamedShape(
                    "bump at a load",
                    f"near{where} {centre * top:.3g} N m",
                    partial(bump, centre=centre * top, width=width * top, flank=flank),
                )


def _clips(history: History) -> Iterator[UnnamedShape]:
    """Sensors at a limit, of the reading or of the load, on both flanks or on one."""
    widest = float(np.max(np.abs(history.angle_deg), initial=0.0))
    for share in np.linspace(0.45, 0.97, 14):
        yield UnnamedShape(
            "saturation at the end of the range",
            f"beyond {share * widest:.3g} deg",
            partial(clipped, limit=float(share) * widest),
            positive=True,
        )
    top = history.largest_torque_nm
    for share in (0.46, 0.53, 0.6, 0.67, 0.74, 0.81, 0.87, 0.93, 0.97):
        for flank in (0, 1, -1):
            if flank and not np.any(history.side == flank):
                continue
            yield UnnamedShape(
                "saturation at the end of the range",
                f"beyond {(flank or 1) * share * top:.3g} N m",
                partial(beyond, start=share * top, flank=flank),
                positive=True,
            )


def _curves(history: History) -> Iterator[UnnamedShape]:
    """Smooth functions of load, of load and direction, of the rate, and of earlier loads."""
    top = history.largest_torque_nm
    knots = np.array([0.0, 0.08, 0.2, 0.4, 0.65, 1.0]) * top
    yield UnnamedShape(
        "smooth odd curve",
        "over the whole range of torque",
        lambda h: h.side[:, None] * hats(h.load_nm, knots),
        elastic=True,
    )
    if np.any(history.side > 0) and np.any(history.side < 0):
        yield UnnamedShape(
            "even curve",
            "over the whole range of torque",
            lambda h: hats(h.load_nm, knots),
            elastic=True,
        )
    rough = np.array([0.0, 0.3, 1.0]) * top
    yield UnnamedShape(
        "hysteresis",
        "loading against unloading",
        lambda h: h.sense[:, None] * hats(h.load_nm, rough),
    )
    if history.time_s is not None and history.usual_step_s > 0:
        yield UnnamedShape("loop by rate", "where the rate is high", rates)
        longest = float(np.bincount(history.run, lapse(history)).max())
        delays = np.geomspace(FEWEST_STEPS * history.usual_step_s, max(longest, 1e-9), 5)[:4]
        yield UnnamedShape(
            "relaxation", "at holds and after reversals", partial(relaxing, delays=delays)
        )


def _cells(history: History) -> Iterator[UnnamedShape]:
    """A function of load of its own for each flank and direction."""
    knots = np.linspace(0.0, 1.0, 5) * history.largest_torque_nm

    def cells(h: History) -> Floats:
        basis = hats(h.load_nm, knots)
        parts = [
            basis * ((h.side == flank) & (h.sense == sense))[:, None]
            for flank in (1, -1)
            for sense in (1, -1)
        ]
        return np.column_stack(parts)

    yield UnnamedShape(
        "torque and direction", "over the whole range of torque", cells, elastic=True
    )


def _runs(history: History) -> Iterator[UnnamedShape]:
    """A compliance of its own for each run, and single runs apart."""
    if not FEWEST_STATES <= history.run_count <= MOST_RUNS:
        return
    runs = np.arange(history.run_count)
    yield UnnamedShape(
        "compliance by run",
        "from run to run",
        lambda h: (h.run[:, None] == runs) * h.elastic_nm[:, None],
    )
    for number in range(history.run_count):
        yield UnnamedShape(
            "one run apart",
            f"run {number + 1}",
            partial(one_run, number),
        )


def _trends(history: History) -> Iterator[UnnamedShape]:
    """Drifts over the recording and within runs."""
    clock = clock_of(history)
    length = max(float(np.ptp(clock)), 1e-12)
    share = (clock - clock[0]) / length
    starts = clock[history.run_starts][history.run]
    since = (clock - starts) / length
    yield UnnamedShape("slow drift", "over the recording", lambda h: share[:, None])
    yield UnnamedShape(
        "slow drift",
        "over the recording",
        lambda h: np.column_stack([share, share**2, share**3]),
    )
    if history.run_count > 1:
        yield UnnamedShape("drift within runs", "over each run", lambda h: since[:, None])
    for tau in (0.02, 0.1, 0.3):
        yield UnnamedShape(
            "slow drift",
            "dying out over the recording",
            partial(constant, np.exp(-share / tau)[:, None]),
        )


def _windows(history: History, fitted: Flags) -> Iterator[UnnamedShape]:
    """An offset of its own for each of many consecutive windows.

    Parameters
    ----------
    history : History
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.

    Yields
    ------
    UnnamedShape
    """
    index = np.flatnonzero(fitted)
    for count in (15, 40):
        if len(index) < 12 * count:
            continue
        window = np.zeros(len(history), dtype=np.int64)
        window[index] = np.arange(len(index)) * count // len(index)
        window = np.maximum.accumulate(window)
        yield UnnamedShape(
            "wandering of the zero",
            "over the whole recording",
            partial(constant, (window[:, None] == np.arange(count)).astype(np.float64)),
        )


def _positions(history: History) -> Iterator[UnnamedShape]:
    """An offset and a compliance of its own for each position of the mesh."""
    if history.crank_deg is None:
        return
    place = mesh_positions(history.crank_deg)
    places = np.unique(place)
    if not FEWEST_STATES <= len(places) <= MOST_POSITIONS:
        return
    which = np.searchsorted(places, place)
    one = (which[:, None] == np.arange(len(places))).astype(np.float64)
    if len(places) > 7:
        # With fewer positions the first three orders of the mesh say the same.
        yield UnnamedShape("position offsets", "from position to position", lambda h: one)
    yield UnnamedShape(
        "compliance by position", "from position to position", lambda h: one * h.elastic_nm[:, None]
    )
