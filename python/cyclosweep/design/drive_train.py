"""The torsional train of a drive: its inertias, and its springs by one of three models."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Literal, Protocol

import numpy as np

from cyclosweep.design.loaded import loaded_state
from cyclosweep.design.numbers import finite_number
from cyclosweep.design.published import PublishedDrive
from cyclosweep.dynamics.spring import TrainSpring
from cyclosweep.dynamics.train import Train
from cyclosweep.errors import InputError

__all__ = ["CalibratedModel", "TrainParts", "train_of"]

LOADS = (0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.5)
"""Shares of the rated torque at which the component model gives points of the elastic laws: from
where the play has just closed to the largest load of the published model."""

_ARCMIN = math.pi / 10_800
_MESH = ("ring contacts", "eccentric bearing", "clearance")
_OUTPUT = ("output contacts", "pin bending", "pin root", "output shaft")


class CalibratedModel(Protocol):
    """A model of a specimen that knows its spring: :class:`cyclosweep.Model`."""

    def train_spring(self, ratio: int, largest_input_torque_nm: float) -> TrainSpring:
        """Return the drive's spring at the input shaft."""
        ...

    @property
    def train_damping_s(self) -> float:
        """Damping time of the drive's drag [s]."""
        ...


@dataclass(frozen=True)
class TrainParts:
    """Inertias and springs around a drive that its file does not hold.

    Attributes
    ----------
    load_inertia_kg_m2 : float, optional
        Driven machine at the output shaft [kg m^2]; without it the output is locked.
    input_inertia_kg_m2 : float, optional
        Motor [kg m^2]; the drive's own by default.
    eccentric_inertia_kg_m2 : float
        Eccentric and input shaft [kg m^2].
    input_shaft_stiffness_nm_per_rad : float, optional
        Shaft between motor and eccentric [N m/rad]; rigid by default.
    flange_inertia_kg_m2 : float, optional
        Output flange [kg m^2], a node of its own in front of the coupling.
    coupling_stiffness_nm_per_rad : float, optional
        Coupling between flange and load, or ground, at the output shaft [N m/rad].
    damping_s : float
        Stiffness-proportional damping of all springs [s]; the drag of a calibrated model adds to
        it.
    """

    load_inertia_kg_m2: float | None = None
    input_inertia_kg_m2: float | None = None
    eccentric_inertia_kg_m2: float = 0.0
    input_shaft_stiffness_nm_per_rad: float | None = None
    flange_inertia_kg_m2: float | None = None
    coupling_stiffness_nm_per_rad: float | None = None
    damping_s: float = 0.0

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if value is not None:
                object.__setattr__(self, each.name, finite_number(each.name, value))
        if self.eccentric_inertia_kg_m2 < 0:
            raise InputError(
                f"eccentric_inertia_kg_m2: found {self.eccentric_inertia_kg_m2:g}, "
                "expected a number not below zero"
            )
        if (self.flange_inertia_kg_m2 is None) != (self.coupling_stiffness_nm_per_rad is None):
            raise InputError(
                "flange_inertia_kg_m2 and coupling_stiffness_nm_per_rad: found one of them, "
                "expected both or none"
            )


class _Chain:
    """Nodes and springs in order, as they are collected."""

    def __init__(self, name: str, inertia: float) -> None:
        self.names = [name]
        self.inertias = [inertia]
        self.springs: list[TrainSpring] = []
        self.spring_names: list[str] = []
        self.ratios: list[float] = []

    def join(self, spring: TrainSpring, name: str, ratio: float = 1.0) -> None:
        """Add a spring behind the last node."""
        self.springs.append(spring)
        self.spring_names.append(name)
        self.ratios.append(ratio)

    def add(self, name: str, inertia: float) -> None:
        """Add a node behind the last spring."""
        self.names.append(name)
        self.inertias.append(inertia)


def train_of(
    drive: PublishedDrive,
    model: Literal["published", "components"] | CalibratedModel,
    parts: TrainParts,
    with_efficiency: bool,
) -> Train:
    """Train of a drive.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : {"published", "components"} or CalibratedModel
        Where the drive's springs come from.
    parts : TrainParts
        What is around it.
    with_efficiency : bool
        Whether the published compliance carries the torque transfer efficiency of Eq. (13).

    Returns
    -------
    Train

    Raises
    ------
    InputError
        When the input's inertia is unknown or a number is out of range.
    DesignError
        When the drive cannot be built.
    """
    inertia = parts.input_inertia_kg_m2
    if inertia is None:
        inertia = drive.input_inertia_kg_m2
    if inertia is None:
        raise InputError(
            f"{drive.name}: input_inertia_kg_m2: missing, expected the motor's inertia"
        )
    by_name = model if isinstance(model, str) else ""
    orbit, disc = _discs(drive) if by_name == "components" else (0.0, 0.0)
    eccentric = parts.eccentric_inertia_kg_m2 + orbit
    shaft = parts.input_shaft_stiffness_nm_per_rad
    damping = parts.damping_s
    if shaft is None:
        chain = _Chain("input", inertia + eccentric)
    else:
        chain = _Chain("input", inertia)
        chain.join(TrainSpring.linear(shaft), "input_shaft")
        chain.add("eccentric", eccentric)
    if by_name == "components":
        mesh, output = _component_springs(drive)
        chain.join(mesh, "mesh", drive.ratio)
        chain.add("discs", disc)
        chain.join(output, "output_pins")
    elif by_name == "published":
        chain.join(_published_spring(drive, with_efficiency), "drive", drive.ratio)
    elif isinstance(model, str) or not hasattr(model, "train_spring"):
        raise InputError(f"model: found {model!r}, expected 'published', 'components' or a Model")
    else:
        largest = LOADS[-1] * drive.nominal_torque_nm
        damping += model.train_damping_s
        chain.join(model.train_spring(drive.ratio, largest), "drive", drive.ratio)
    if parts.flange_inertia_kg_m2 is not None and parts.coupling_stiffness_nm_per_rad is not None:
        chain.add("flange", parts.flange_inertia_kg_m2)
        chain.join(TrainSpring.linear(parts.coupling_stiffness_nm_per_rad), "coupling")
    if parts.load_inertia_kg_m2 is not None:
        chain.add("load", parts.load_inertia_kg_m2)
    return Train(
        chain.inertias,
        grounded=parts.load_inertia_kg_m2 is None,
        ratios=chain.ratios,
        names=chain.names,
        springs=chain.springs,
        spring_names=chain.spring_names,
        damping_s=damping,
    )


def _published_spring(drive: PublishedDrive, with_efficiency: bool) -> TrainSpring:
    """Dead zone and line of Eq. (13) at the input."""
    line = drive.nominal_line("input")
    compliance = math.radians(line.compliance_deg_per_nm)
    if not with_efficiency:
        compliance /= drive.evaluate(()).get("compliance_factor") or 1.0
    return TrainSpring.linear(1.0 / compliance, math.radians(line.free_play_deg))


def _discs(drive: PublishedDrive) -> tuple[float, float]:
    """Orbiting inertia of all discs at the input, and their spin's at the output [kg m^2]."""
    names = ["disc_mass_kg", "disc_inertia_kg_m2"]
    _, _, columns = drive.part_study().evaluate_range(drive.study(), 0, 1, names)
    mass, inertia = (float(column[0]) for column in columns)
    orbit = drive.disc_count * mass * (drive.eccentricity_mm * 1e-3) ** 2
    return orbit, drive.disc_count * inertia


def _component_springs(drive: PublishedDrive) -> tuple[TrainSpring, TrainSpring]:
    """Mesh at the input shaft, and output pins with the shaft at the output."""
    loads = [share * drive.output_torque_nm for share in LOADS]
    study, parts = drive.accepted("full")
    states = [loaded_state(study, parts, load, 0.0, "full") for load in loads]
    budgets = [
        dict(state.budget.select("component", "twist_arcmin").iter_rows()) for state in states
    ]

    def twists(names: Sequence[str]) -> list[float]:
        return [_ARCMIN * sum(budget[name] for name in names) for budget in budgets]

    gap = _ARCMIN * budgets[0]["clearance"]
    mesh = _mirrored(twists(_MESH), loads, gap)
    output = _mirrored(twists(_OUTPUT), loads, 0.0)
    return mesh.scaled(drive.ratio), output


def _mirrored(twist: Sequence[float], torque: Sequence[float], gap: float) -> TrainSpring:
    """Law through points of one flank, the other flank being its mirror image."""
    rising = np.maximum.accumulate(np.r_[gap, twist] + 1e-15 * np.arange(len(twist) + 1))
    flank = np.r_[0.0, torque]
    if gap > 0:
        return TrainSpring.through_points(np.r_[-rising[::-1], rising], np.r_[-flank[::-1], flank])
    return TrainSpring.through_points(np.r_[-rising[:0:-1], rising], np.r_[-flank[:0:-1], flank])
