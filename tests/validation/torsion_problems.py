"""Torsion of a stepped shaft and of a shaft with a keyway, solved on grids, for the tests alone."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse.linalg import spsolve

Reals = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


def shoulder_extra_length(ratio: float, cells: int) -> float:
    """Extra length of a sharp shoulder over the smaller diameter.

    Finite volumes of div(r^3 grad psi) = 0, psi the twist, with ``cells`` over the smaller radius.
    """
    h = 1 / cells
    small, large = 3 * cells, round(2.5 * ratio * cells)
    inside = np.zeros((round(ratio * cells), small + large), dtype=bool)
    inside[:cells, :] = True
    inside[:, small:] = True
    number = np.full(inside.shape, -1)
    number[inside] = np.arange(inside.sum())
    faces = np.arange(len(inside) + 1) * h
    ring = (faces[1:] ** 4 - faces[:-1] ** 4) / 4

    i, j = np.nonzero(inside[:, :-1] & inside[:, 1:])
    along = (number[i, j], number[i, j + 1], ring[i] / h)
    i, j = np.nonzero(inside[:-1] & inside[1:])
    outward = (number[i, j], number[i + 1, j], faces[i + 1] ** 3)
    first, second = (np.concatenate([along[k], outward[k]]) for k in (0, 1))
    conductance: Reals = np.concatenate([along[2], outward[2]])
    count = int(inside.sum())
    diagonal = np.bincount(first, conductance, count) + np.bincount(second, conductance, count)
    load = np.zeros(count)
    held, turned = np.nonzero(inside[:, 0])[0], np.nonzero(inside[:, -1])[0]
    diagonal[number[held, 0]] += 2 * ring[held] / h
    diagonal[number[turned, -1]] += 2 * ring[turned] / h
    load[number[turned, -1]] += 2 * ring[turned] / h
    twist = _solve(diagonal.astype(float), first, second, conductance, load, symmetric=True)
    torque = float((twist[number[held, 0]] * 2 * ring[held] / h).sum())
    plain = 4 * small * h + 4 * large * h / ratio**4
    return (1 / torque - plain) / 8


def shoulder_on_no_grid(ratio: float) -> float:
    """The same in the limit of a fine grid; the corner makes the error go with h^(4/3)."""
    coarse, fine = shoulder_extra_length(ratio, 24), shoulder_extra_length(ratio, 48)
    return fine + (fine - coarse) / (2 ** (4 / 3) - 1)


def torsion_constant(diameter: float, width: float, depth: float, h: float) -> float:
    """Torsion constant of a round bar with a rectangular keyway, Saint-Venant's problem.

    Finite differences of Prandtl's stress function; cells at the circle keep their true arms.
    ``h`` must divide the keyway's half width and the radius less its depth.
    """
    radius = 0.5 * diameter
    axis = np.arange(-round(radius / h), round(radius / h) + 1) * h
    x_all, y_all = np.meshgrid(axis, axis, indexing="ij")
    inside = x_all**2 + y_all**2 < radius**2 - 1e-9
    inside &= ~((np.abs(x_all) <= 0.5 * width + 1e-9) & (y_all >= radius - depth - 1e-9))
    count = int(inside.sum())
    number = np.full(inside.shape, -1)
    number[inside] = np.arange(count)
    i, j = np.nonzero(inside)
    x, y = axis[i], axis[j]
    diagonal = np.zeros(count)
    links: list[tuple[Indices, Indices, Reals]] = []
    for along_x in (True, False):
        to_circle = np.sqrt(radius**2 - (y if along_x else x) ** 2)
        arms, neighbours = [], []
        for sign in (1, -1):
            neighbour = number[i + sign, j] if along_x else number[i, j + sign]
            arm = np.minimum(to_circle - sign * (x if along_x else y), h)
            arms.append(np.where(neighbour < 0, arm, h))
            neighbours.append(neighbour)
        for neighbour, arm, other in zip(neighbours, arms, arms[::-1], strict=True):
            weight = 2 / (arm * (arm + other))
            diagonal += weight
            there = neighbour >= 0
            links.append((np.nonzero(there)[0], neighbour[there], weight[there]))
    first, second, weight = map(np.concatenate, zip(*links, strict=True))
    stress = _solve(diagonal, first, second, weight, np.full(count, 2.0), symmetric=False)
    return 2 * float(stress.sum()) * h * h


def keyway_ratio(diameter: float, width: float, depth: float, h: float) -> float:
    """Compliance of a shaft with a keyway over that of the plain shaft."""
    return math.pi * diameter**4 / 32 / torsion_constant(diameter, width, depth, h)


def _solve(
    diagonal: Reals,
    first: Indices,
    second: Indices,
    weight: Reals,
    load: Reals,
    *,
    symmetric: bool,
) -> Reals:
    """Solve a system with ``diagonal`` and minus ``weight`` at (first, second)."""
    size = len(diagonal)
    matrix = sparse.coo_array((-weight, (first, second)), shape=(size, size))
    total = matrix + matrix.T if symmetric else matrix
    solved: Reals = spsolve((total + sparse.diags_array(diagonal)).tocsc(), load)
    return solved
