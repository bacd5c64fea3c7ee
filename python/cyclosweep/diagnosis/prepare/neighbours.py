"""Angle of every row by its neighbours alone, so that it knows nothing of the row's own noise."""

import numpy as np

from cyclosweep.simulation.effects.history import Floats, Ints

REACH = 3
"""Neighbours on each side that are averaged. More of them would round a steep staircase."""


def angle_by_neighbours(angle_deg: Floats, piece: Ints) -> Floats:
    """Angle of each row as its neighbours of the same piece of the load history tell it.

    A wave along the measured angle, less the same wave along the true angle, is the noise itself:
    looked for in what a model leaves, it is found. A wave along the angle of the neighbours is not.

    Parameters
    ----------
    angle_deg : ndarray, shape (n,)
        Measured angle [deg].
    piece : ndarray of int, shape (n,)
        Label of the piece of each row; equal ones are consecutive, and torque rises or falls
        steadily on one flank there.

    Returns
    -------
    ndarray, shape (n,)
        Mean of the pairs of neighbours at equal distance; at the ends of a piece the straight line
        of the next two rows; the row's own angle in pieces of one or two rows [deg].
    """
    count = len(angle_deg)
    total, pairs = np.zeros(count), np.zeros(count)
    for distance in range(1, REACH + 1):
        inner = np.arange(distance, count - distance)
        inner = inner[piece[inner - distance] == piece[inner + distance]]
        total[inner] += 0.5 * (angle_deg[inner - distance] + angle_deg[inner + distance])
        pairs[inner] += 1.0
    out = np.where(pairs > 0, total / np.maximum(pairs, 1.0), angle_deg)
    for sign in (1, -1):
        ends = np.flatnonzero(pairs == 0)
        ends = ends[(ends + 2 * sign >= 0) & (ends + 2 * sign < count)]
        ends = ends[piece[ends + 2 * sign] == piece[ends]]
        out[ends] = 2.0 * angle_deg[ends + sign] - angle_deg[ends + 2 * sign]
    return out
