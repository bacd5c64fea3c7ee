"""A calibrated model of a drive: the published line, what it leaves out, and its file."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, Self

from cyclosweep.design.drive import Drive
from cyclosweep.design.json_files import JsonSource, json_object, name_of
from cyclosweep.design.numbers import finite_number, real_numbers
from cyclosweep.dynamics.spring import TrainSpring
from cyclosweep.errors import InputError, instance_of, one_of
from cyclosweep.notebook import html_table
from cyclosweep.simulation.effect_value import EffectValue, linear_twist
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.elastic_curve import ElasticCurve
from cyclosweep.simulation.json_fields import (
    count_of,
    flag_of,
    list_of,
    number_of,
    object_of,
    text_of,
)
from cyclosweep.simulation.model_error import ModelError
from cyclosweep.simulation.train_spring import drag_time_s, spring_of

__all__ = ["SCHEMA", "EffectValue", "Model", "linear_twist"]

SCHEMA = "cyclosweep.model/1"

PRESLIDING = 1e-3
"""Presliding distance over the largest twist where the component model gives the friction: small,
since that model knows none."""


@dataclass(frozen=True)
class Model:
    """Calibrated baseline and effects of one drive at one shaft.

    Attributes
    ----------
    compliance_deg_per_nm : float
        Slope of the line [deg/(N m)], above zero.
    free_play_deg : float
        Free play on each side of the datum [deg], not below zero.
    datum_deg : float
        Middle of the dead zone on the dial [deg].
    torque_zero_nm : float
        What the torque column reads without load [N m]. It shows only where both crossings of the
        dead zone were recorded.
    side : {"input", "output"}
        Shaft to which angles and torques belong.
    effects : tuple of EffectValue
        What the published model leaves out.
    output_pin_count : int
        Pins of the drive, for the orders of the mesh position.
    drive : str
        Name of the drive.
    notes : tuple of str
        What a user of the model should know, one sentence each.
    elastic_curve : ElasticCurve or None
        Twist over torque beyond the free play, instead of the line.
    model_error : ModelError or None
        What line and effects miss at the same state of load, learned from a recording. A forecast
        of the twist adds it; a torque for a given twist and a spring of a torsional train leave it
        out.
    one_history : bool
        Runs of a programme go on from each other, unless the programme says that the rig is reset
        between them or its clock starts anew. Without it, the programme's ``history`` decides.
    fitted_torque_nm : tuple of float and float, or None
        Least and greatest torque of the recording to which the model was fitted [N m]; beyond
        them its effects are extrapolated.
    """

    compliance_deg_per_nm: float
    free_play_deg: float
    datum_deg: float = 0.0
    side: Literal["input", "output"] = "input"
    effects: tuple[EffectValue, ...] = ()
    output_pin_count: int = 8
    drive: str = ""
    torque_zero_nm: float = 0.0
    notes: tuple[str, ...] = field(default=())
    elastic_curve: ElasticCurve | None = None
    model_error: ModelError | None = None
    one_history: bool = False
    fitted_torque_nm: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        numbers = ("compliance_deg_per_nm", "free_play_deg", "datum_deg", "torque_zero_nm")
        for name in numbers:
            finite_number(name, getattr(self, name))
        if self.free_play_deg < 0:
            raise InputError(
                f"free_play_deg: found {self.free_play_deg:g}, expected a number not below zero"
            )
        one_of("side", self.side, ("input", "output"))
        instance_of("effects", self.effects, tuple)
        instance_of("one_history", self.one_history, bool)
        if self.fitted_torque_nm is not None:
            ends = real_numbers("fitted_torque_nm", list(self.fitted_torque_nm))
            if len(ends) != 2 or not -math.inf < ends[0] <= ends[1] < math.inf:
                raise InputError(f"fitted_torque_nm: found {ends}, expected least and greatest")
        for value in self.effects:
            instance_of("effects", value, EffectValue)
        if not self.effects:  # beside effects that bend it the line of a fit may be anything
            check_line(self)

    def elastic_twist(self, torque_nm: Floats) -> Floats:
        """Twist beyond the free play without effects, by the curve or by the line.

        Parameters
        ----------
        torque_nm : ndarray, shape (n,)
            Torque at the model's shaft [N m]; its sign is that of the twist.

        Returns
        -------
        ndarray, shape (n,)
            Elastic twist [deg]: zero at zero torque, the play not in it.
        """
        if self.elastic_curve is None:
            return self.compliance_deg_per_nm * torque_nm
        return self.elastic_curve.twist(torque_nm)

    @classmethod
    def of_drive(cls, drive: Drive, side: Literal["input", "output"] = "input") -> Self:
        """Published model of a drive at one of its shafts.

        Parameters
        ----------
        drive : Drive
            The drive.
        side : {"input", "output"}
            Shaft to which angles and torques belong.

        Returns
        -------
        Model
        """
        instance_of("drive", drive, Drive)
        line = drive.nominal_line(side)
        return cls(
            compliance_deg_per_nm=line.compliance_deg_per_nm,
            free_play_deg=line.free_play_deg,
            side=side,
            output_pin_count=int(drive.output_pin_count),
            drive=drive.name,
        )

    @classmethod
    def of_components(
        cls,
        drive: Drive,
        side: Literal["input", "output"] = "input",
        crank_deg: float = 0.0,
        *,
        friction: bool = False,
    ) -> Self:
        """Component model of a drive at one of its shafts, free play and curve from its clearances.

        Parameters
        ----------
        drive : Drive
            A drive that has a component model.
        side : {"input", "output"}
            Shaft to which angles and torques belong, the other one locked.
        crank_deg : float
            Angle of the crank in the middle of its play [deg].
        friction : bool
            Whether the contacts' Coulomb friction is added, as ``load_dependent_friction`` of the
            share that it has in the whole curve. At the output, where the component model knows no
            sliding, there is none.

        Returns
        -------
        Model

        Raises
        ------
        DesignError
            When the drive has no component model.
        InputError
            When the curve ends before 4.5 times the nominal torque.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> drive = cs.Drive.reference_87().replace(
        ...     ring_pin_radius_mm=2.0, disc_width_mm=12.0, hole_clearance_mm=0.1
        ... )
        >>> cs.Model.of_components(drive).free_play_deg < drive.free_play_deg
        True
        """
        curve = drive.torque_twist(side, crank_deg)
        if not (curve.reached and curve.table["converged"].all()):
            raise InputError(
                f"{drive.name}: the component model finds no equilibria up to 4.5 times "
                f"{curve.nominal_torque_nm:.4g} N m at the {side}"
            )
        below, above = curve.free_play_deg
        share = curve.friction_share() if friction else 0.0
        farthest = float(curve.table["angle_deg"].to_numpy().max())
        presliding = {"slip_deg": PRESLIDING * farthest, "scatter": 0.3}
        return cls(
            compliance_deg_per_nm=curve.line().compliance_deg_per_nm,
            free_play_deg=0.5 * (above - below),
            datum_deg=0.5 * (above + below),
            side=side,
            effects=(EffectValue("load_dependent_friction", presliding, (share,)),)
            if share > 0
            else (),
            output_pin_count=int(drive.output_pin_count),
            drive=drive.name,
            notes=("Twist and free play are the component model's, not the published one's.",),
            elastic_curve=ElasticCurve.of_curve(curve),
        )

    def train_spring(self, ratio: int, largest_input_torque_nm: float) -> TrainSpring:
        """Spring of this model in a torsional train, at the input shaft.

        Parameters
        ----------
        ratio : int
            Reduction ratio of the drive [1].
        largest_input_torque_nm : float
            Largest torque at the input for which the law has to hold [N m].

        Returns
        -------
        TrainSpring
            With play, elastic effects and friction; see
            :func:`cyclosweep.simulation.train_spring.spring_of`.

        Raises
        ------
        InputError
            The compliance is not above zero.
        """
        check_line(self)
        if self.side == "input":
            return spring_of(self, largest_input_torque_nm)
        return spring_of(self, largest_input_torque_nm * ratio).scaled(ratio)

    @property
    def train_damping_s(self) -> float:
        """Damping time of a train with this model's drag [s]."""
        return drag_time_s(self)

    def __repr__(self) -> str:
        effects = ", ".join(value.name for value in self.effects) or "no effects"
        return (
            f"<Model of {self.drive or 'a drive'} at the {self.side}: "
            f"{self.compliance_deg_per_nm:.4g} deg/(N m), play {self.free_play_deg:.4g} deg, "
            f"{effects}>"
        )

    def _repr_html_(self) -> str:
        rows: dict[str, object] = {
            "compliance": f"{self.compliance_deg_per_nm:.5g} deg/(N m) at the {self.side}",
            "free play": f"{self.free_play_deg:.5g} deg",
            "datum": f"{self.datum_deg:.5g} deg",
        }
        for value in self.effects:
            named = zip(value.effect.amplitudes(value.shape), value.amplitudes, strict=False)
            rows[value.name] = ", ".join(f"{p.name} {a:.4g} {p.unit}" for p, a in named)
        return html_table(f"Model of {self.drive or 'a drive'}", rows, " ".join(self.notes))

    def to_json(self) -> str:
        """Return the content of ``model.json``."""
        content = {
            "schema": SCHEMA,
            "drive": self.drive,
            "side": self.side,
            "output_pin_count": self.output_pin_count,
            "baseline": {
                "compliance_deg_per_nm": self.compliance_deg_per_nm,
                "free_play_deg": self.free_play_deg,
                "datum_deg": self.datum_deg,
                "torque_zero_nm": self.torque_zero_nm,
            },
            "effects": [value.as_dict() for value in self.effects],
            "notes": list(self.notes),
        }
        if self.elastic_curve is not None:
            content["elastic_curve"] = self.elastic_curve.as_dict()
        if self.model_error is not None:
            content["model_error"] = self.model_error.as_dict()
        if self.one_history:
            content["one_history"] = True
        if self.fitted_torque_nm is not None:
            least, greatest = self.fitted_torque_nm
            content["fitted_torque_nm"] = {"from": least, "to": greatest}
        return json.dumps(content, indent=1)

    @classmethod
    def from_json(cls, path: JsonSource) -> Self:
        """Read ``model.json``, or what `to_json` returned.

        Parameters
        ----------
        path : str, Path or mapping
            File as `to_json` writes it, its text, or its decoded content. The order of its keys
            does not matter.

        Returns
        -------
        Model

        Raises
        ------
        InputError
            The file is no model, or holds an effect, a shape parameter or an amplitude that is
            unknown, missing or no finite number; one line says which.
        """
        name = name_of(path)
        try:
            content = json_object(path)
        except InputError as error:
            raise InputError(f"{name}: {error}") from error
        if content.get("schema") != SCHEMA:
            raise InputError(f"{name}: schema: expected {SCHEMA!r}")
        try:
            return cls._of(content)
        except InputError as error:
            raise InputError(f"{name}: not a model: {error}") from error

    @classmethod
    def _of(cls, content: Mapping[str, Any]) -> Self:
        """Model of a decoded file."""
        base = object_of(content, "baseline")
        side = text_of(content, "side", "input")
        if side not in ("input", "output"):
            raise InputError(f"side: found {side!r}, expected 'input' or 'output'")
        entries = list_of(content, "effects")
        notes = list_of(content, "notes")
        curve = object_of(content, "elastic_curve", {})
        missed = object_of(content, "model_error", {})
        fitted = object_of(content, "fitted_torque_nm", {})
        model = cls(
            compliance_deg_per_nm=number_of(base, "compliance_deg_per_nm"),
            free_play_deg=number_of(base, "free_play_deg"),
            datum_deg=number_of(base, "datum_deg", 0.0),
            torque_zero_nm=number_of(base, "torque_zero_nm", 0.0),
            side="output" if side == "output" else "input",
            effects=tuple(
                EffectValue.from_dict(object_of({f"effect {k}": entry}, f"effect {k}"))
                for k, entry in enumerate(entries, 1)
            ),
            output_pin_count=count_of(content, "output_pin_count", 8),
            drive=text_of(content, "drive", ""),
            notes=tuple(text_of({"note": note}, "note") for note in notes),
            elastic_curve=ElasticCurve.from_dict(curve) if curve else None,
            model_error=ModelError.from_dict(missed) if missed else None,
            one_history=flag_of(content, "one_history"),
            fitted_torque_nm=(number_of(fitted, "from"), number_of(fitted, "to"))
            if fitted
            else None,
        )
        check_line(model)
        return model


def check_line(model: Model) -> None:
    """Refuse a model whose twist falls as the torque rises; `InputError` with its compliance."""
    if not model.compliance_deg_per_nm > 0:
        raise InputError(
            f"compliance_deg_per_nm: found {model.compliance_deg_per_nm:g}, "
            "expected a number above zero"
        )
