"""Forward model of any load history: the published line, calibrated, with any set of effects."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.errors import InputError
from cyclosweep.recording import Recording
from cyclosweep.simulation.effects import Effect, find
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.slip import slip_state, solve_slip, stretch_of

SCHEMA = "cyclosweep.model/1"
ROUNDS = 12
"""Most rounds in which twist, flank and effects settle on each other."""
LAW_POINTS = 128
"""Points of an elastic law on each side of zero."""


@dataclass(frozen=True)
class EffectValue:
    """An effect with its shape and the values of its amplitudes, in the effect's order."""

    name: str
    shape: Mapping[str, float]
    amplitudes: tuple[float, ...]

    @property
    def effect(self) -> Effect:
        """The registered effect of this name."""
        return find(self.name)


@dataclass(frozen=True)
class Model:
    """Calibrated baseline and effects of one drive at one shaft.

    Attributes
    ----------
    compliance_deg_per_nm : float
        Slope of the line [deg/(N m)].
    free_play_deg : float
        Free play on each side of the datum [deg].
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

    @classmethod
    def of_drive(cls, drive: Drive, side: Literal["input", "output"] = "input") -> Self:
        """Published model of a drive at one of its shafts."""
        line = drive.nominal_line(side)
        return cls(
            compliance_deg_per_nm=line.compliance_deg_per_nm,
            free_play_deg=line.free_play_deg,
            side=side,
            output_pin_count=int(drive.output_pin_count),
            drive=drive.name,
        )

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
            "effects": [
                {
                    "name": value.name,
                    "shape": dict(value.shape),
                    "amplitudes": {
                        p.name: float(a)
                        for p, a in zip(
                            value.effect.amplitudes(value.shape), value.amplitudes, strict=False
                        )
                    },
                }
                for value in self.effects
            ],
            "notes": list(self.notes),
        }
        return json.dumps(content, indent=1)

    @classmethod
    def from_json(cls, path: str | Path) -> Self:
        """Read ``model.json``.

        Raises
        ------
        InputError
            The file is no model; one line says why.
        """
        try:
            content = json.loads(Path(path).read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
            raise InputError(f"{path}: cannot be read as a model: {error}") from error
        if not isinstance(content, dict) or content.get("schema") != SCHEMA:
            raise InputError(f"{path}: schema: expected {SCHEMA!r}")
        try:
            base: Mapping[str, Any] = content["baseline"]
            return cls(
                compliance_deg_per_nm=float(base["compliance_deg_per_nm"]),
                free_play_deg=float(base["free_play_deg"]),
                datum_deg=float(base.get("datum_deg", 0.0)),
                torque_zero_nm=float(base.get("torque_zero_nm", 0.0)),
                side="output" if content.get("side") == "output" else "input",
                effects=tuple(
                    EffectValue(
                        find(str(e["name"])).name,
                        {str(k): float(v) for k, v in e.get("shape", {}).items()},
                        tuple(float(v) for v in e["amplitudes"].values()),
                    )
                    for e in content.get("effects", [])
                ),
                output_pin_count=int(content.get("output_pin_count", 8)),
                drive=str(content.get("drive", "")),
                notes=tuple(map(str, content.get("notes", ()))),
            )
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise InputError(f"{path}: not a model: {error}") from error


def history_of(recording: Recording, model: Model) -> History:
    """Load history of a recording or programme, with the state of a linear drive."""
    torque = np.ascontiguousarray(recording.torque_nm - model.torque_zero_nm, dtype=np.float64)
    run = np.cumsum(np.r_[False, np.diff(recording.run) != 0]).astype(np.int64)
    restart = np.r_[True, np.diff(run) != 0] if len(run) else np.zeros(0, dtype=bool)
    if recording.history == "continuous":
        restart = np.arange(len(torque)) == 0
    side = _flanks(torque, restart)
    twist = model.compliance_deg_per_nm * torque
    return History(
        applied_nm=torque,
        elastic_nm=torque,
        angle_deg=model.datum_deg + side * model.free_play_deg + twist,
        side=side,
        run=run,
        restart=restart,
        compliance_deg_per_nm=model.compliance_deg_per_nm,
        free_play_deg=model.free_play_deg,
        datum_deg=model.datum_deg,
        time_s=recording.time_s,
        crank_deg=recording.crank_deg,
        temperature_c=recording.temperature_c,
        output_pin_count=model.output_pin_count,
        resets_datum=recording.reset_between_runs,
    )


def _flanks(elastic: Floats, restart: np.ndarray) -> Floats:
    """Flank in contact: the sign of the torque, and at zero torque the last one."""
    known = (elastic != 0) | restart
    sign = np.where(elastic < 0, -1.0, 1.0)
    last = np.maximum.accumulate(np.where(known, np.arange(len(elastic)), 0))
    flank = sign[last]
    # A run that starts unloaded starts on the flank that is loaded first.
    for start in np.flatnonzero(restart & (elastic == 0)):
        ahead = np.flatnonzero(elastic[start:] != 0)
        stop = int(start) + (int(ahead[0]) if len(ahead) else len(elastic) - int(start))
        flank[start:stop] = sign[stop if stop < len(elastic) else -1]
    return np.asarray(flank)


def simulate(
    model: Model | Drive,
    programme: Recording,
    predict: Literal["angle", "torque"] = "angle",
) -> Recording:
    """Predict the twist for a torque history, or the torque for a twist history.

    Parameters
    ----------
    model : Model or Drive
        A repaired model, or a drive: then the published model without calibration.
    programme : Recording
        Load history; for ``predict="torque"`` with an angle.

    Returns
    -------
    Recording
        The same history with the predicted column.

    Raises
    ------
    InputError
        The programme lacks a column that an effect of the model needs.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> load = Recording.from_arrays([0.0, 7.2575, 14.515])
    >>> simulate(cs.Drive.reference_87(), load).angle_deg.round(1)
    array([28. , 47.8, 67.6])
    """
    if isinstance(model, Drive):
        model = Model.of_drive(model, programme.side)
    _check(model, programme)
    if not len(programme):
        return programme.with_angle(np.zeros(0))
    if predict == "torque":
        return replace(programme, torque_nm=_torque(model, programme))
    return programme.with_angle(predict_history(model, programme).angle_deg)


def _check(model: Model, programme: Recording) -> None:
    if programme.side != model.side:
        raise InputError(
            f"{programme.name}: side: found {programme.side!r}, expected {model.side!r} "
            "as in the model"
        )
    for value in model.effects:
        for column in value.effect.needs:
            if getattr(programme, column) is None:
                raise InputError(
                    f"{programme.name}: column {column}: missing, "
                    f"expected because the model has {value.name}"
                )


def linear_twist(effects: Sequence[EffectValue], history: History) -> Floats:
    """Twist that effects other than friction add [deg]."""
    total = np.zeros(len(history))
    for value in effects:
        if not value.effect.slips:
            columns = value.effect.columns(history, value.shape)
            width = min(columns.shape[1], len(value.amplitudes))
            total += columns[:, :width] @ np.array(value.amplitudes[:width])
    return total


@dataclass(frozen=True, slots=True)
class ElasticLaw:
    """Twist beyond the dead zone [deg] over the elastic torque [N m], point by point."""

    torque_nm: Floats
    twist_deg: Floats


def elastic_law(model: Model, largest_torque_nm: float) -> ElasticLaw | None:
    """Elastic law of the compliance and all effects that belong to it; None for a line.

    The points lie closer towards zero; beyond three times the largest torque the law goes on
    straight. A stretch where the effects together would let the twist fall with growing torque is
    taken as rigid.
    """
    effects = [value for value in model.effects if value.effect.elastic]
    if not effects:
        return None
    reach = 3.0 * max(largest_torque_nm, 1e-9)
    half = reach * np.geomspace(1e-5, 1.0, LAW_POINTS)
    torque = np.r_[-half[::-1], half]
    side = np.sign(torque)
    history = History(
        applied_nm=torque,
        elastic_nm=torque,
        angle_deg=side * model.free_play_deg + model.compliance_deg_per_nm * torque,
        side=side,
        run=np.zeros(len(torque), dtype=np.int64),
        restart=np.arange(len(torque)) == 0,
        compliance_deg_per_nm=model.compliance_deg_per_nm,
        free_play_deg=model.free_play_deg,
        output_pin_count=model.output_pin_count,
    )
    twist = model.compliance_deg_per_nm * torque + linear_twist(effects, history)
    least = 1e-3 * model.compliance_deg_per_nm
    upper = np.maximum.accumulate(np.r_[0.0, twist[LAW_POINTS:]] - least * np.r_[0.0, half])
    lower = np.maximum.accumulate(np.r_[0.0, -twist[:LAW_POINTS][::-1]] - least * np.r_[0.0, half])
    upper, lower = upper + least * np.r_[0.0, half], lower + least * np.r_[0.0, half]
    return ElasticLaw(np.r_[-half[::-1], 0.0, half], np.r_[-lower[:0:-1], upper])


def predict_history(model: Model, programme: Recording) -> History:
    """Settle path, flank and effects along a torque history."""
    return settle(model, history_of(programme, model))


def settle(
    model: Model, history: History, rounds: int = ROUNDS, told_side: Floats | None = None
) -> History:
    """Settle path, flank and effects along a load history that is already zeroed.

    ``told_side`` gives the flank in contact sample by sample, where a recording shows it; without
    it the model finds the flank, which is a forecast.
    """
    sliding = [value for value in model.effects if value.effect.slips]
    law = elastic_law(model, history.largest_torque_nm) if sliding else None
    others = [v for v in model.effects if not sliding or not v.effect.elastic]
    for _ in range(rounds):
        added = linear_twist(others, history)
        before = history.angle_deg
        if sliding:
            history = _slide(model, history, sliding, added, law, told_side)
        else:
            base = model.datum_deg + history.side * model.free_play_deg
            angle = base + model.compliance_deg_per_nm * history.applied_nm + added
            history = history.with_state(angle_deg=angle)
        if not any(not v.effect.slips for v in others):
            break
        if float(np.max(np.abs(history.angle_deg - before))) < 1e-6:
            break
    return history


def _slide(
    model: Model,
    history: History,
    sliding: Sequence[EffectValue],
    added: Floats,
    law: ElasticLaw | None,
    told_side: Floats | None,
) -> History:
    shape = sliding[0].shape
    told = 0.0 if told_side is None else told_side * model.free_play_deg
    play = model.free_play_deg if told_side is None else 0.0
    points = None if law is None else (law.torque_nm, law.twist_deg)
    offset = model.datum_deg + added + told
    angle, friction = solve_slip(history, shape, offset, _limits(sliding), play, points)
    elastic = history.applied_nm - friction
    if told_side is not None:
        return history.with_state(elastic_nm=elastic, angle_deg=angle)
    small = 1e-9 * history.largest_torque_nm
    side = _flanks(np.where(np.abs(elastic) < small, 0.0, elastic), history.restart)
    return history.with_state(elastic_nm=elastic, angle_deg=angle, side=side)


def _limits(sliding: Sequence[EffectValue]) -> tuple[float, float]:
    """Friction limit without load [N m], and in proportion to the transmitted torque."""
    of = {
        name: float(sum(v.amplitudes[0] for v in sliding if v.name == name))
        for name in ("friction_hysteresis", "load_dependent_friction")
    }
    return of["friction_hysteresis"], of["load_dependent_friction"]


def _torque(model: Model, programme: Recording) -> Floats:
    """Torque that holds the drive at the given angles [N m]."""
    if programme.angle_deg is None:
        raise InputError(f"{programme.name}: angle_deg: missing, expected to predict a torque")
    angle = np.ascontiguousarray(programme.angle_deg, dtype=np.float64)
    sliding = [value for value in model.effects if value.effect.slips]
    limits = _limits(sliding)
    history = history_of(programme, model)
    farthest = float(np.abs(angle - model.datum_deg).max(initial=0.0))
    law = elastic_law(model, farthest / model.compliance_deg_per_nm)
    others = [value for value in model.effects if not value.effect.elastic]
    elastic = np.zeros(len(angle))
    friction = np.zeros(len(angle))
    for _ in range(ROUNDS):
        side = _flanks(elastic, history.restart)
        applied = elastic + friction
        history = history.with_state(
            applied_nm=applied, elastic_nm=elastic, angle_deg=angle, side=side
        )
        twist = angle - model.datum_deg - linear_twist(others, history)
        beyond = np.sign(twist) * np.maximum(np.abs(twist) - model.free_play_deg, 0.0)
        settled = beyond / model.compliance_deg_per_nm
        if law is not None:
            settled = np.interp(beyond, law.twist_deg, law.torque_nm)
        moved = float(np.max(np.abs(settled - elastic)))
        elastic = settled
        friction = np.zeros(len(angle))
        for value in sliding:
            state = slip_state(history, value.shape, stretch_of(history, value.shape, limits))
            load = np.abs(elastic) if value.name == "load_dependent_friction" else 1.0
            friction += value.amplitudes[0] * load * state
        if moved < 1e-9 * max(float(np.max(np.abs(elastic))), 1e-9):
            break
    return elastic + friction + model.torque_zero_nm
