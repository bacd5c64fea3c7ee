"""Compliance of a disc between its contacts, by plane finite elements."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import gmsh
import numpy as np
import numpy.typing as npt
import skfem
from scipy.sparse.linalg import splu
from skfem.models.elasticity import linear_elasticity

from disc.shape import Contacts, Outline

__all__ = ["Compliance", "compliance", "mesh"]

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Compliance:
    """How a disc gives way at its contacts, seen from its bore.

    Attributes
    ----------
    matrix : ndarray, shape (contacts, contacts)
        Movement along each contact's force under one newton per millimetre of width at each
        [mm^2/N]; the bore's mean shift and turn are zero.
    patches : ndarray, shape (contacts,)
        Half width of the strip over which each was loaded [mm].
    unknowns : int
        Displacements solved for.
    """

    matrix: Reals
    patches: Reals
    unknowns: int


def mesh(outline: Outline) -> skfem.MeshTri:
    """Triangles inside a disc's curves."""
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        loops = [
            _loop(points, sizes)
            for points, sizes in ((outline.profile, outline.profile_sizes), *outline.holes)
        ]
        angles = 2 * math.pi * np.arange(120) / 120
        bore = outline.bore_radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        loops.append(_loop(bore, np.full(120, 2 * math.pi * outline.bore_radius / 120)))
        gmsh.model.geo.addPlaneSurface(loops)
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(2)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        _, _, triangles = gmsh.model.mesh.getElements(2)
    finally:
        gmsh.finalize()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(len(tags))
    points = coordinates.reshape(-1, 3)[:, :2].T
    corners = number[triangles[0].astype(np.int64)].reshape(-1, 3).T
    used, corners = np.unique(corners, return_inverse=True)
    return skfem.MeshTri(points[:, used].copy(), corners.reshape(3, -1))


def _loop(points: Reals, sizes: Reals) -> int:
    tags = [
        gmsh.model.geo.addPoint(float(x), float(y), 0.0, float(size))
        for (x, y), size in zip(points, sizes, strict=True)
    ]
    lines = [
        gmsh.model.geo.addLine(tag, after)
        for tag, after in zip(tags, [*tags[1:], tags[0]], strict=True)
    ]
    for line in lines:
        gmsh.model.geo.mesh.setTransfiniteCurve(line, 2)
    loop: int = gmsh.model.geo.addCurveLoop(lines)
    return loop


def compliance(
    outline: Outline, touched: Contacts, patches: Reals, modulus: float, poisson: float
) -> Compliance:
    """Load each contact in turn and see how all of them move.

    Parameters
    ----------
    outline : Outline
        Curves of the disc.
    touched : Contacts
        Where and along what it is pushed.
    patches : ndarray, shape (contacts,)
        Half widths of the loaded strips [mm].
    modulus : float
        Young's modulus [MPa].
    poisson : float
        Poisson's ratio [1]; plane stress.
    """
    triangles = mesh(outline)
    element = skfem.ElementVector(skfem.ElementTriP2())
    basis = skfem.Basis(triangles, element)
    shear = modulus / (2 * (1 + poisson))
    first = modulus * poisson / (1 - poisson**2)  # Lame's, for plane stress
    stiffness = linear_elasticity(first, shear).assemble(basis)
    facets = skfem.FacetBasis(triangles, element, intorder=6)
    loads = np.column_stack(
        [
            _strip(facets, point, direction, half)
            for point, direction, half in zip(
                touched.points, touched.directions, patches, strict=True
            )
        ]
    )
    bore = _bore(facets, outline.bore_radius)
    # Loads are balanced by the bore: radial and tangential tractions that vary as a rigid motion
    # would have them; then the mean motion of the bore is the one these tractions work on.
    rigid = _rigid_motions(basis)
    balanced = loads - bore @ np.linalg.solve(rigid.T @ bore, rigid.T @ loads)
    moved = _free_solution(stiffness, balanced, basis)
    moved -= rigid @ np.linalg.solve(bore.T @ rigid, bore.T @ moved)
    readings = _readings(basis, touched)
    matrix = readings.T @ moved
    return Compliance(matrix, patches, stiffness.shape[0])


def _strip(
    facets: skfem.FacetBasis, point: Reals, direction: Reals, half: float
) -> npt.NDArray[np.float64]:
    """One newton per millimetre of width, spread over a strip as Hertz's pressure."""
    x = facets.default_parameters()["x"]
    away = np.hypot(x[0] - point[0], x[1] - point[1]) / half
    pressure = np.sqrt(np.clip(1 - away**2, 0, None))
    total = float((pressure * facets.dx).sum())

    @skfem.LinearForm
    def push(v: Any, w: Any) -> Any:
        return w.pressure * (direction[0] * v[0] + direction[1] * v[1])

    load: Reals = push.assemble(facets, pressure=pressure / total)
    return load


def _bore(facets: skfem.FacetBasis, radius: float) -> Reals:
    """Two forces and a moment spread over the bore: cos and sin radially, even tangentially."""

    @skfem.LinearForm
    def push(v: Any, w: Any) -> Any:
        return w.px * v[0] + w.py * v[1]

    x = facets.default_parameters()["x"]
    r = np.hypot(x[0], x[1])
    on = (r < radius * 1.0001).astype(float)
    c, s = x[0] / r, x[1] / r
    loads = [
        push.assemble(facets, px=on * c * c, py=on * c * s),
        push.assemble(facets, px=on * s * c, py=on * s * s),
        push.assemble(facets, px=-on * s, py=on * c),
    ]
    return np.column_stack(loads)


def _rigid_motions(basis: skfem.Basis) -> Reals:
    x = basis.doflocs
    along = np.zeros(basis.N, dtype=bool)
    for dofs in (basis.nodal_dofs, basis.facet_dofs):
        along[dofs[0]] = True
    return np.column_stack(
        [along.astype(float), (~along).astype(float), np.where(along, -x[1], x[0])]
    )


def _free_solution(stiffness: Any, loads: Reals, basis: skfem.Basis) -> Reals:
    """Displacements of a body that nothing holds, under balanced loads: three are set to zero."""
    nodes = basis.mesh.p
    left, right = int(nodes[0].argmin()), int(nodes[0].argmax())
    held = [*basis.nodal_dofs[:, left], basis.nodal_dofs[1, right]]
    free = np.setdiff1d(np.arange(basis.N), held)
    solution = np.zeros_like(loads)
    factors = splu(
        stiffness.tocsc()[free][:, free],
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    solution[free] = factors.solve(loads[free])
    return solution


def _readings(basis: skfem.Basis, touched: Contacts) -> Reals:
    """What takes each contact's movement along its force from the displacements."""
    readings = np.zeros((basis.N, len(touched.points)))
    for number, (point, direction) in enumerate(
        zip(touched.points, touched.directions, strict=True)
    ):
        away = np.hypot(*(basis.mesh.p - point[:, None]))
        node = int(away.argmin())
        assert away[node] < 1e-6, away[node]
        readings[basis.nodal_dofs[0, node], number] = direction[0]
        readings[basis.nodal_dofs[1, node], number] = direction[1]
    return readings
