"""A round pin on a flange by finite elements: what its own bending and what its root give way.

Pin and flange are bodies of revolution under a load across their axis, whose displacements are
``u_r = U cos``, ``u_t = V sin``, ``u_z = W cos``: a plane problem in radius and height. Diameter
and Young's modulus are one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from skfem import (
    Basis,
    BilinearForm,
    ElementQuad2,
    ElementVector,
    FacetBasis,
    LinearForm,
    MeshQuad,
    condense,
    solve,
)

RADIUS = 0.5


def _towards(end: float, other: float, cells: int, grading: float) -> npt.NDArray[np.float64]:
    """Nodes from `end` to `other`, closer and closer towards `end`."""
    part = np.linspace(0.0, 1.0, cells + 1) ** grading
    return np.asarray(end + (other - end) * part)


def end_deflection(
    length: float, *, flange: float | None, cells: int = 12, poisson: float = 0.3
) -> float:
    """Mean deflection of the end face under a unit force spread evenly over it.

    Parameters
    ----------
    length : float
        Free length of the pin over its diameter [1].
    flange : float or None
        Radius and depth of the flange over the pin's diameter, its far face and rim held; None for
        a pin whose root face is held.
    cells : int
        Cells from the re-entrant corner to each end.
    poisson : float
        Poisson's ratio [1].

    Returns
    -------
    float
        ``E d delta / F`` [1].
    """
    inside = _towards(RADIUS, 0.0, cells, 2.0)[::-1]
    up = _towards(0.0, length, cells * 2, 1.6)
    if flange is None:
        mesh = MeshQuad.init_tensor(inside, up)
    else:
        across = np.r_[inside, _towards(RADIUS, flange, cells * 2, 3.0)[1:]]
        height = np.r_[_towards(0.0, -flange, cells * 2, 3.0)[::-1], up[1:]]
        mesh = MeshQuad.init_tensor(across, height)
        middle = mesh.p[:, mesh.t].mean(axis=1)
        mesh = mesh.remove_elements(np.flatnonzero((middle[0] > RADIUS) & (middle[1] > 0)))
    basis = Basis(mesh, ElementVector(ElementQuad2(), 3), intorder=6)
    first = poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = 1 / (2 * (1 + poisson))

    def strains(w: Any, r: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], ...]:
        (u, v, a), (du, dv, da) = w, w.grad
        return (
            *(du[0], (u + v) / r, da[1]),
            *(-u / r + dv[0] - v / r, du[1] + da[0], dv[1] - a / r),
        )

    @BilinearForm  # type: ignore[untyped-decorator]
    def energy(trial: Any, test: Any, point: Any) -> Any:
        r = point.x[0]
        mine, other = strains(trial, r), strains(test, r)
        volume = sum(mine[:3]) * sum(other[:3])
        direct = sum(a * b for a, b in zip(mine[:3], other[:3], strict=True))
        across = sum(a * b for a, b in zip(mine[3:], other[3:], strict=True))
        return (first * volume + 2 * shear * direct + shear * across) * r

    @LinearForm  # type: ignore[untyped-decorator]
    def push(test: Any, point: Any) -> Any:
        u, v, _ = test
        return (u - v) * point.x[0] / (np.pi * RADIUS**2)

    end = mesh.facets_satisfying(lambda x: np.isclose(x[1], length))
    load = push.assemble(FacetBasis(mesh, basis.elem, facets=end, intorder=6))
    held = mesh.facets_satisfying(
        lambda x: (
            np.isclose(x[1], 0.0)
            if flange is None
            else np.isclose(x[1], -flange) | np.isclose(x[0], flange)
        )
    )
    moved = solve(*condense(energy.assemble(basis), load, D=basis.get_dofs(held)))
    return float(load @ moved) * np.pi
