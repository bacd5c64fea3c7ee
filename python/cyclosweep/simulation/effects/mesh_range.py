"""Where the mesh stood in a recording: at how many positions, how far apart, and its travel."""

import numpy as np

from cyclosweep.simulation.effects.base import spread
from cyclosweep.simulation.effects.history import Floats, History

LEAST_TRAVEL_DEG = 60.0
"""Travel of the mesh under load from which orders are looked for: a sixth of a turn. Below it even
three cycles within the travel are of order 18 and more, beyond most pins of a drive."""
LEAST_PHASE_DEG = 20.0
"""Phase through which an order of the position has to go while the mesh travels, from which it is
looked for along the travel from several recorded positions."""
LOADED = 0.05
"""Load over the largest one from which a flank counts as loaded."""
LEAST_POSITIONS = 3
"""Recorded positions of the mesh from which orders of the position are looked for."""
LEAST_SPREAD_DEG = 60.0
"""Part of a turn that the recorded positions have to span for low orders of a travel: from
neighbouring ones a low order is the same as an eccentric dial."""
LEAST_LOADS = 6
"""Different torques that are needed for these orders: with fewer, a wave along the travel is the
same as one of the locking position and a pulsating compliance."""

PLACES_A_CYCLE = 8
"""Recorded positions a cycle from which an order beyond the usual ones is looked for: so many there
are where the shaft was turned under load, not locked at a few places."""
USUAL_ORDER, HIGHEST_LOCKED_ORDER = 4, 6
"""Highest order of the position that is always looked for, and where there are positions enough."""
HIGHEST_TURNED_ORDER = 12
"""Highest order of the position that is looked for where the shaft was turned under load."""


def short_way_deg(turned_deg: Floats) -> Floats:
    """Angle between two positions the short way round, from -180 to 180.

    Parameters
    ----------
    turned_deg : ndarray, shape (n,)
        One position less the other [deg]; full turns do not count.

    Returns
    -------
    ndarray, shape (n,)
        In deg.
    """
    return np.asarray((turned_deg + 180.0) % 360.0 - 180.0)


def mesh_positions(crank_deg: Floats) -> Floats:
    """Positions of the mesh that are told apart: tenths of a degree within a turn.

    Parameters
    ----------
    crank_deg : ndarray, shape (n,)
        Angle of the crank, over any number of turns [deg].

    Returns
    -------
    ndarray, shape (n,)
        From 0 to below 360 [deg]; just below a full turn is 0.
    """
    return np.asarray(np.round(crank_deg % 360.0, 1) % 360.0)


def position_count(history: History) -> int:
    """Count the positions of the mesh zone in a recording, to a tenth of a degree."""
    if history.crank_deg is None:
        return 0
    return len(np.unique(mesh_positions(history.crank_deg)))


def locked_orders(history: History) -> range:
    """Orders that are looked for where the mesh was locked at some positions.

    Those of which two positions an order, and one, tell the amplitudes.

    Parameters
    ----------
    history : History
        Load history of the recording.

    Returns
    -------
    range
        The usual ones at least.
    """
    told_apart = (position_count(history) - 1) // 2
    return range(1, 1 + min(max(told_apart, USUAL_ORDER), HIGHEST_LOCKED_ORDER))


def turned_orders(history: History, above: int) -> range:
    """Orders beyond the usual ones that a shaft which was turned under load shows.

    Parameters
    ----------
    history : History
        Load history of the recording.
    above : int
        Highest of the usual orders.

    Returns
    -------
    range
        Empty where the mesh was locked at a few positions.
    """
    seen = position_count(history) // PLACES_A_CYCLE
    return range(above + 1, 1 + min(HIGHEST_TURNED_ORDER, seen))


def _positions_span_deg(history: History) -> float:
    """Part of a turn that holds all recorded positions of the mesh zone [deg]."""
    if history.crank_deg is None:
        return 0.0
    places = np.unique(history.crank_deg % 360.0)
    return 360.0 - float(np.max(np.diff(places, append=places[0] + 360.0)))


def load_count(history: History) -> int:
    """Number of different torques."""
    return len(np.unique(np.round(history.applied_nm, 6)))


def whole_travel_deg(history: History) -> float:
    """Range over which the mesh travelled [deg], at however many places it stood."""
    return history.mesh_ratio * spread(history.travelled_deg)


def loaded_travel_deg(history: History) -> float:
    """Range over which the mesh travelled [deg], less the play that it crossed.

    No readings within the play are fitted, so that a wave of which only two short parts are seen
    would pass for three cycles.
    """
    loaded = history.load_nm > LOADED * history.largest_torque_nm
    crossed = 2.0 * history.free_play_deg if len(np.unique(history.side[loaded])) > 1 else 0.0
    return max(whole_travel_deg(history) - history.mesh_ratio * crossed, 0.0)


def travels_far_from_positions(history: History, order: float) -> bool:
    """Whether an order may go with the travel of the mesh from several recorded positions.

    Parameters
    ----------
    history : History
        Load history with the position of the mesh zone at each sample.
    order : float
        Cycles a turn of the mesh zone.

    Returns
    -------
    bool
    """
    return (
        order * whole_travel_deg(history) >= LEAST_PHASE_DEG
        and _positions_span_deg(history) >= LEAST_SPREAD_DEG
        and load_count(history) >= LEAST_LOADS
    )
