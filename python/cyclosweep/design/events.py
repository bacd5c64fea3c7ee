"""Events that shock a train: start, stop, reversal, pulse, blocked output, recorded torque."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import numpy.typing as npt
import polars as pl
from pydantic import Field

from cyclosweep.design.published import PublishedDrive
from cyclosweep.design.shaft import NonNegative, Positive
from cyclosweep.design.toml_files import TomlTable, read_as, read_toml
from cyclosweep.dynamics.spring import Brake, SlipElement
from cyclosweep.dynamics.torques import Torques
from cyclosweep.dynamics.train import Train
from cyclosweep.dynamics.transient import Transient
from cyclosweep.errors import InputError, instance_of

__all__ = ["KINDS", "Event", "transient"]

Kind = Literal["start", "stop", "reversal", "pulse", "blocked-output", "emergency-stop", "recorded"]
KINDS: tuple[Kind, ...] = (
    "start", "stop", "reversal", "pulse", "blocked-output", "emergency-stop", "recorded",
)  # fmt: skip

Reals = npt.NDArray[np.float64]

_SINE_LINES = 64
"""Straight lines that stand for half a sine: their torque is within 0.03 % of the peak."""

_BRAKE_DEFLECTION_RAD = 1e-3
"""Twist at the input over which the brake takes hold; stiffer ones change no peak by 0.1 %."""


class _Parts(TomlTable):
    """Inertias and springs around the drive, as an event file has them under ``[train]``."""

    load_inertia_kg_m2: Positive | None = None
    input_inertia_kg_m2: Positive | None = None
    eccentric_inertia_kg_m2: NonNegative | None = None
    input_shaft_stiffness_nm_per_rad: Positive | None = None
    flange_inertia_kg_m2: Positive | None = None
    coupling_stiffness_nm_per_rad: Positive | None = None
    damping_s: NonNegative = 0.0


class Event(TomlTable):
    """What happens to a train, frozen and checked.

    Torques at the input are those of the first node, at the output those of the last one (or of
    nothing where the output is locked). A positive input torque drives; a positive load torque
    resists.

    Attributes
    ----------
    kind : str
        ``start``: from rest the input torque rises. ``stop``: the train runs under load and the
        input torque vanishes. ``reversal``: the torque changes its sign, the load's with it unless
        ``load_reverses`` is false; then it vanishes. ``pulse``: a pulse acts on a train under
        load. ``blocked-output``: a running train's output is held from one moment to the next.
        ``emergency-stop``: the input torque vanishes and a brake takes hold at the input of a
        running train. ``recorded``: torques from a file.
    torque_nm : float, optional
        Torque at the input [N m]; a drive's nominal one by default.
    load_torque_nm : float, optional
        Torque of the load [N m]; by default what balances the input torque, and none for a start.
    load_reverses : bool
        For a reversal.
    rise_s : float
        Time in which the input torque changes [s]; zero is a step.
    speed_rpm : float, optional
        Speed of the input where the train runs [rpm]; a drive's rated one by default.
    pulse_torque_nm, pulse_s : float, optional
        Height [N m] and length [s] of a pulse.
    pulse_at : {"output", "input"}
        Where it acts; at the output a positive one adds to the load.
    pulse_shape : {"half-sine", "rectangle"}
        Its shape.
    brake_torque_nm : float, optional
        Torque of the brake at the input [N m]; twice the input torque by default.
    recording : str, optional
        CSV file with the columns ``time_s``, ``input_nm`` and perhaps ``output_nm``, beside the
        event file.
    duration_s : float
        How long to follow [s].
    samples : int
        Rows of the table.
    model : str
        ``published``, ``components``, or a ``model.json`` beside the event file.
    train : table
        Inertias and springs around the drive; see
        :class:`cyclosweep.design.drive_train.TrainParts`.
    """

    kind: Kind
    torque_nm: Positive | None = None
    load_torque_nm: Annotated[float, Field(allow_inf_nan=False)] | None = None
    load_reverses: bool = True
    rise_s: NonNegative = 0.0
    speed_rpm: NonNegative | None = None
    pulse_torque_nm: Annotated[float, Field(allow_inf_nan=False)] | None = None
    pulse_s: Positive | None = None
    pulse_at: Literal["output", "input"] = "output"
    pulse_shape: Literal["half-sine", "rectangle"] = "half-sine"
    brake_torque_nm: Positive | None = None
    recording: str | None = None
    duration_s: Positive = 0.5
    samples: Annotated[int, Field(ge=2, le=10_000_000)] = 2000
    model: str = "published"
    train: _Parts = _Parts()

    @classmethod
    def from_toml(cls, path: str | Path) -> Self:
        """Read an event file.

        Parameters
        ----------
        path : str or Path
            The file; a recording or model that it names lies beside it.

        Returns
        -------
        Event

        Raises
        ------
        InputError
            One line that names the file, the key, what was found and what was expected.
        """
        table = read_toml(path)
        beside = Path(path).parent
        for key in ("recording", "model"):
            name = table.get(key)
            if isinstance(name, str) and (key == "recording" or name.endswith(".json")):
                table[key] = str(beside / name)
        return read_as(cls, "an event", table, path)

    def of_drive(self, drive: PublishedDrive) -> Self:
        """Return this event with a drive's ratings where it states none.

        Parameters
        ----------
        drive : Drive
            The drive.
        """
        changes: dict[str, Any] = {}
        if self.torque_nm is None:
            changes["torque_nm"] = drive.nominal_torque_nm
        if self.speed_rpm is None:
            changes["speed_rpm"] = drive.input_speed_rpm
        return self.model_copy(update=changes)

    @property
    def parts(self) -> dict[str, float]:
        """What ``[train]`` states of the inertias and springs around the drive."""
        return self.train.model_dump(exclude_none=True)


def transient(train: Train, event: Event) -> Transient:
    """Follow a train through an event.

    Parameters
    ----------
    train : Train
        The train; its first node is the input, its last one the output.
    event : Event
        What happens. Torque and speed must be stated: :meth:`Event.of_drive`.

    Returns
    -------
    Transient
        Peaks of the springs' torques [N m], their times [s], and a table over the time.

    Raises
    ------
    InputError
        For what is no train or no event, or when the event lacks a number or does not fit the
        train.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> train = cs.Train([0.0035], [21.0], [0.48869219], grounded=True)
    >>> round(transient(train, Event(kind="reversal", torque_nm=7.2575)).shock_factor, 3)
    4.107
    """
    instance_of("train", train, Train)
    instance_of("event", event, Event)
    if event.kind == "recorded":
        return _run(train, event, _recorded(train, event), {}, 0.0)
    torque = _given(event, "torque_nm")
    load = event.load_torque_nm
    if load is None:
        load = 0.0 if event.kind == "start" else torque * float(train.node_ratios[-1])
    before = _torques(train, torque, load)
    if event.kind == "start":
        after = _torques(train, _step(0.0, torque, event.rise_s), load)
        return _run(train, event, after, _torques(train, 0.0, 0.0), 0.0)
    if event.kind == "reversal":
        loads = _step(load, -load if event.load_reverses else 0.0, event.rise_s)
        after = _torques(train, _step(torque, -torque, event.rise_s), loads)
        return _run(train, event, after, before, 0.0)
    if event.kind == "pulse":
        pulse = _pulse(event)
        at_input = event.pulse_at == "input"
        if not at_input and train.grounded:
            raise InputError(
                "event: pulse_at: found 'output' of a locked output, expected 'input' or a "
                "load_inertia_kg_m2"
            )
        inputs: _History = (pulse[0], torque + pulse[1]) if at_input else torque
        outputs: _History = load if at_input else (pulse[0], load + pulse[1])
        return _run(train, event, _torques(train, inputs, outputs), before, 0.0)
    speed = _given(event, "speed_rpm") * math.pi / 30
    if event.kind == "blocked-output":
        held = train.locked()
        inputs_only = _torques(held, torque, 0.0)
        return _run(held, event, inputs_only, inputs_only, speed)
    if train.grounded:
        raise InputError(
            f"event: kind {event.kind!r} needs an output that turns, expected a load_inertia_kg_m2"
        )
    after = _torques(train, _step(torque, 0.0, event.rise_s), load)
    brake = None
    if event.kind == "emergency-stop":
        limit = event.brake_torque_nm or 2 * torque
        brake = Brake(0, SlipElement(limit / _BRAKE_DEFLECTION_RAD, limit))
    return _run(train, event, after, before, speed, brake)


def _run(
    train: Train,
    event: Event,
    torques: Torques,
    preload: Torques,
    speed: float,
    brake: Brake | None = None,
) -> Transient:
    return train.transient(
        torques,
        event.duration_s,
        event.samples,
        preload_nm=preload,
        speeds_rad_per_s=speed,
        brake=brake,
    )


def _given(event: Event, key: str) -> float:
    value = getattr(event, key)
    if value is None:
        raise InputError(f"event: {key}: missing, expected a number")
    return float(value)


_History = float | tuple[Reals, Reals]


def _torques(train: Train, at_input: _History, load: _History) -> dict[str | int, Any]:
    """Torques on the first and, where it turns, the last node; a load resists."""
    torques: dict[str | int, Any] = {0: at_input}
    last = len(train.names) - 1
    if not train.grounded and last > 0:
        resists = (load[0], -load[1]) if isinstance(load, tuple) else -load
        torques[last] = resists
    return torques


def _step(start: float, end: float, rise_s: float) -> tuple[Reals, Reals]:
    return np.array([0.0, 0.0, rise_s]), np.array([start, start if rise_s else end, end])


def _pulse(event: Event) -> tuple[Reals, Reals]:
    height, length = _given(event, "pulse_torque_nm"), _given(event, "pulse_s")
    if event.pulse_shape == "rectangle":
        return np.array([0.0, length, length]), np.array([height, height, 0.0])
    share = np.linspace(0.0, 1.0, _SINE_LINES + 1)
    return share * length, height * np.sin(math.pi * share)


def _recorded(train: Train, event: Event) -> dict[str | int, Any]:
    if event.recording is None:
        raise InputError("event: recording: missing, expected a CSV file with time_s and input_nm")
    path = event.recording
    try:
        table = pl.read_csv(path, comment_prefix="#")
    except (OSError, pl.exceptions.PolarsError) as error:
        raise InputError(f"{path}: {' '.join(str(error).split())[:120]}") from None
    if not table.height:
        raise InputError(f"{path}: no rows, expected at least one")
    torques: dict[str | int, Any] = {}
    places = {"input_nm": 0, "output_nm": len(train.names) - 1}
    for column in ("time_s", *places):
        if column not in table.columns:
            if column == "output_nm":
                continue
            raise InputError(f"{path}: column {column}: missing, found {', '.join(table.columns)}")
        values = table[column]
        if not values.dtype.is_numeric() or not values.is_finite().all() or values.null_count():
            raise InputError(f"{path}: column {column}: expected a number in every row")
    if "output_nm" in table.columns and train.grounded:
        raise InputError(f"{path}: column output_nm: the output is locked, expected input_nm alone")
    times = table["time_s"].cast(pl.Float64).to_numpy()
    if len(falls := np.flatnonzero(np.diff(times) < 0)):
        before, after = times[falls[0]], times[falls[0] + 1]
        raise InputError(
            f"{path}: column time_s, data row {falls[0] + 2}: found {after:g} after {before:g}, "
            "expected times that do not fall"
        )
    for column, node in places.items():
        if column in table.columns:
            torques[node] = (times, table[column].cast(pl.Float64).to_numpy())
    return torques
