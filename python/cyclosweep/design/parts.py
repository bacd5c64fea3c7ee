"""Keys of a drive file that the component model reads, and what stands in for those left out."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal, get_args

import polars as pl
from pydantic import Field, field_validator

import cyclosweep._core as _core
from cyclosweep.design.inputs import DriveInputs
from cyclosweep.design.loaded import LoadedState, loaded_state
from cyclosweep.design.nominal_line import Side
from cyclosweep.design.numbers import checked_loads
from cyclosweep.design.pin_loads import THICK_FLANGE, Pin, pin_load_table, root_flexibility
from cyclosweep.design.shaft import NonNegative, Positive
from cyclosweep.design.torque_twist import Rig, TorqueTwist, torque_twist_curve
from cyclosweep.errors import one_of

__all__ = ["PART_DEFAULTS", "TRAIN_INPUTS", "Engine", "PartInputs"]

Engine = Literal["full", "quadratic"]
"""How equilibria are found: by power laws, or by their secants at the expected forces."""

Finite = Annotated[float, Field(allow_inf_nan=False)]
Poisson = Annotated[float, Field(gt=-1, le=0.5)]

PART_DEFAULTS = {name: (kind, number, of) for name, kind, number, of in _core.part_input_table()}
"""For each input: ``required``, ``number``, ``same`` as another, so many ``widths``, ``absent``."""

TRAIN_INPUTS = tuple(name for name, (kind, _, _) in PART_DEFAULTS.items() if kind == "absent")
"""Inputs of the torsional train alone, on which no equilibrium depends."""


class PartInputs(DriveInputs):
    """A drive with the numbers of its contacts, clearances and bearings.

    The meaning and unit of each stand in :mod:`cyclosweep.design.part_units`. A drive without
    ``ring_pin_radius_mm`` and ``disc_width_mm`` has no component model; for every other key left
    out a default stands in, which :meth:`part_table` lists as assumed.
    """

    ring_pin_radius_mm: Positive | None = None
    disc_width_mm: Positive | None = None
    ring_clearance_mm: Finite | None = None
    ring_circle_enlargement_mm: Finite | None = None
    profile_offset_mm: Finite | None = None
    profile_shift_mm: Finite | None = None
    profile_rotation_deg: NonNegative | None = None
    hole_clearance_mm: Finite | None = None
    eccentric_bearing_stiffness_n_per_mm: Positive | None = None
    eccentric_bearing_clearance_mm: NonNegative | None = None
    disc_1_reach_mm: Positive | None = None
    disc_2_reach_mm: Positive | None = None
    disc_3_reach_mm: Positive | None = None
    disc_4_reach_mm: Positive | None = None
    ring_youngs_modulus_gpa: Positive | None = None
    ring_poisson_ratio: Poisson | None = None
    disc_youngs_modulus_gpa: Positive | None = None
    disc_poisson_ratio: Poisson | None = None
    disc_density_kg_m3: Positive | None = None
    friction_ring: NonNegative | None = None
    friction_output: NonNegative | None = None
    friction_bearing: NonNegative | None = None
    contact_yield_strength_mpa: Positive | None = None
    pin_yield_strength_mpa: Positive | None = None
    load_inertia_kg_m2: Positive | None = None
    eccentric_inertia_kg_m2: NonNegative | None = None
    flange_inertia_kg_m2: Positive | None = None
    coupling_stiffness_nm_per_rad: Positive | None = None
    contact_law: Literal["palmgren", "johnson"] | None = None
    pin_root_compliance: tuple[NonNegative, Finite, NonNegative] | None = None
    ring_gap_errors_mm: tuple[Finite, ...] | None = None
    hole_gap_errors_mm: tuple[Finite, ...] | None = None

    _PARTS: ClassVar[tuple[str, ...]] = tuple(PART_DEFAULTS)
    _FIXED: ClassVar[tuple[str, ...]] = (
        "contact_law",
        "pin_root_compliance",
        "ring_gap_errors_mm",
        "hole_gap_errors_mm",
    )

    @field_validator(
        "pin_root_compliance", "ring_gap_errors_mm", "hole_gap_errors_mm", mode="before"
    )
    @classmethod
    def _lists_are_sequences(cls, value: object) -> object:
        return tuple(value) if isinstance(value, list) else value

    def every_input(self) -> tuple[str, ...]:
        """Names of every input, those of the component model after the published one's."""
        return (*self.inputs(), *self._PARTS)

    def marked(self) -> tuple[str, ...]:
        """Names of every key that can have a mark of where its number comes from."""
        return (*self.every_input(), *self._FIXED)

    def part_values(self) -> dict[str, float]:
        """Every input of the component model by name, NaN where left out."""
        given = {name: getattr(self, name) for name in self._PARTS}
        return {name: math.nan if value is None else value for name, value in given.items()}

    def part_definition(self) -> dict[str, str]:
        """Return what decides the component model's numbers, for the hash of a study."""
        names = [name for name in (*self._PARTS, *self._FIXED) if name not in TRAIN_INPUTS]
        given = {name: getattr(self, name) for name in names}
        return {name: repr(value) for name, value in given.items() if value is not None}

    def part_table(self) -> pl.DataFrame:
        """Every number that the component model uses, and whether it is given or assumed.

        Returns
        -------
        polars.DataFrame
            ``key``, ``value`` in the key's unit, ``mark``: the provenance where the file has it,
            ``given`` where it has none, ``assumed: ...`` where a default stands in; and
            ``missing``.
        """
        rows = []
        for name, (kind, number, of) in PART_DEFAULTS.items():
            if kind == "absent":
                continue
            value = getattr(self, name)
            mark = self.provenance.get(name, "given")
            if value is None:
                value, mark = self._default(kind, number, of)
            rows.append({"key": name, "value": value, "mark": mark})
        schema = {"key": pl.String, "value": pl.Float64, "mark": pl.String}
        return pl.DataFrame(rows, schema=schema)

    def _default(self, kind: str, number: float, of: str) -> tuple[float | None, str]:
        if kind == "number":
            return number, "assumed: default"
        if kind == "same":
            return getattr(self, of), f"assumed: as {of}"
        if kind == "widths" and self.disc_width_mm is not None:
            return number * self.disc_width_mm, f"assumed: {number:.3g} times {of}"
        return None, "missing"

    def loaded(
        self,
        output_torque_nm: float | None = None,
        crank_rad: float = 0.0,
        *,
        engine: Engine = "full",
    ) -> LoadedState:
        """Solve the component model at one load and one position of the crank.

        Parameters
        ----------
        output_torque_nm : float, optional
            Torque at the output [N m], not zero; the rated one by default.
        crank_rad : float
            Angle of the eccentric from ring pin 0 [rad].
        engine : {"full", "quadratic"}
            Power laws, or their secants at the expected forces.

        Returns
        -------
        LoadedState

        Raises
        ------
        DesignError
            When the drive cannot be built or has no component model.
        InputError
            For a torque that is zero or no finite number.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> drive = cs.Drive.reference_87().replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
        >>> drive.loaded(585.0, 0.3).converged
        True
        """
        torque = self.output_torque_nm if output_torque_nm is None else output_torque_nm
        study, part_study = self.accepted(engine)
        return loaded_state(study, part_study, torque, crank_rad, engine)

    def torque_twist(
        self,
        side: Side = "input",
        crank_deg: float = 0.0,
        *,
        to_load_tn: float = 4.5,
        points: int = 200,
    ) -> TorqueTwist:
        """Torque over twist by the component model, through the free play, in both directions.

        Parameters
        ----------
        side : {"input", "output"}
            Shaft that is turned, the other one locked. At the input the crank travels while it
            loads, as in the published rig, and the mesh with it.
        crank_deg : float
            Angle of the crank in the middle of its play [deg].
        to_load_tn : float
            Largest load, in T_N at the input and in rated torques at the output [1].
        points : int
            Equal steps of the turn in each direction; the end of the free play is a further point.

        Returns
        -------
        TorqueTwist

        Raises
        ------
        DesignError
            When the drive cannot be built or has no component model.
        InputError
            For an argument that is no such number.

        Notes
        -----
        Friction does not change the sharing: the loop lies by what all contacts' sliding takes on
        either side of the frictionless curve. Its rounding where the motion turns back is left out.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> drive = cs.Drive.reference_87().replace(
        ...     ring_pin_radius_mm=2.0, disc_width_mm=12.0, hole_clearance_mm=0.1
        ... )
        >>> curve = drive.torque_twist("input", points=50)
        >>> curve.reached, curve.table["load_tn"].max() > 4.4
        (True, True)
        """
        one_of("side", side, get_args(Side))
        study, parts = self.accepted("full")
        nominal = self.nominal_torque_nm if side == "input" else self.output_torque_nm
        return torque_twist_curve(study, parts, Rig(side, crank_deg, nominal, to_load_tn, points))

    def pin_loads(self, loads_tn: tuple[float, ...] = (1, 2, 3, 4, 4.5)) -> pl.DataFrame:
        """One output pin under the five loads of the paper's Fig. 13, with and without its root.

        Parameters
        ----------
        loads_tn : tuple of float
            Loads [T_N], not zero.

        Returns
        -------
        polars.DataFrame
            ``load_tn``; ``torque_nm`` and ``force_n`` of the pin, Eqs. (1), (2), (9);
            ``deflection_mm`` of its end after Timoshenko, the paper's is by finite elements;
            ``rotation_deg``, Eq. (8); ``compliance_rad_per_nm``, Eq. (10); and the last three
            ``..._with_root``, the flange's own deflection added.

        Raises
        ------
        DesignError
            When the drive cannot be built.
        InputError
            For a load that is zero or no finite number.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> table = cs.Drive.reference_87().pin_loads()
        >>> table["load_tn"].to_list()
        [1.0, 2.0, 3.0, 4.0, 4.5]
        >>> (table["deflection_with_root_mm"] / table["deflection_mm"])[0] > 1.1
        True
        """
        loads = checked_loads(loads_tn)
        study = self.study()
        if (reason := study.explain(0)) is not None:
            raise _core.DesignError(f"{self.name}: {reason}")
        names = ["force_per_pin_n", "pin_compliance_rad_per_nm"]
        force, compliance = study.evaluate_range(0, 1, names)[2][:, 0]
        length, diameter = self.output_pin_length_mm, self.output_pin_diameter_mm
        root = self.pin_root_compliance or THICK_FLANGE
        at_root = root_flexibility(root, length, diameter, self.youngs_modulus_gpa)
        pin = Pin(self.output_pin_circle_radius_mm, float(force), float(compliance), at_root)
        return pin_load_table(pin, loads)

    def accepted(self, engine: Engine) -> tuple[_core.Study, _core.PartStudy]:
        """Return the core's studies of this drive alone.

        Raises
        ------
        DesignError
            When the drive cannot be built or has no component model.
        InputError
            For another engine.
        """
        one_of("engine", engine, get_args(Engine))
        study = self.study()
        if (reason := study.explain(0)) is not None:
            raise _core.DesignError(f"{self.name}: {reason}")
        part_study = self.part_study(engine)
        if (reason := part_study.explain(study, 0)) is not None:
            raise _core.DesignError(f"{self.name}: {reason}")
        return study, part_study

    def part_study(
        self,
        engine: Engine = "quadratic",
        limits: tuple[tuple[str, float, float, int], ...] = (),
        published_limits: tuple[int, ...] = (),
    ) -> _core.PartStudy:
        """Return the core's component model of studies of this drive."""
        return _core.PartStudy(
            list(self.part_values().items()),
            self.contact_law or "palmgren",
            list(self.pin_root_compliance or THICK_FLANGE),
            list(self.ring_gap_errors_mm or ()),
            list(self.hole_gap_errors_mm or ()),
            engine,
            list(limits),
            list(published_limits),
        )
