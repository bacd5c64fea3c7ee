"""Settle a model along a load history: twist for a torque, or torque for a twist."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.errors import InputError, instance_of, one_of
from cyclosweep.recording import Recording
from cyclosweep.recording.unbroken_runs import runs_can_go_on
from cyclosweep.simulation.drag_compliance import lagging_with_friction, under_drag_of
from cyclosweep.simulation.effect_value import twist_with_and_without
from cyclosweep.simulation.effects.history import Flags, Floats, History, runs_and_restarts
from cyclosweep.simulation.effects.orders import needed_columns
from cyclosweep.simulation.effects.slip import Friction
from cyclosweep.simulation.effects.slip_start import lies_behind_play
from cyclosweep.simulation.effects.twist_law import ElasticLaw
from cyclosweep.simulation.elastic_law import elastic_law
from cyclosweep.simulation.mesh_position import MESH_ROUNDS, on_the_mesh, travelling
from cyclosweep.simulation.model import SCHEMA, EffectValue, Model, check_line, linear_twist

__all__ = [
    "SCHEMA",
    "EffectValue",
    "ElasticLaw",
    "Model",
    "elastic_law",
    "history_of",
    "linear_twist",
    "predict_history",
    "settle",
    "simulate",
]

SIMULATED_ROUNDS = 12
"""Most rounds in which twist, flank and effects settle on each other."""
TORQUE_ROUNDS = 300
"""The same for the torque at a given twist. A compliance that pulsates by nine tenths of itself
leaves nine tenths of the error in each round."""
STALLED_AFTER = 10
"""Rounds without an improvement after which the torque moves to and fro, as friction may let it."""


def history_of(recording: Recording, model: Model) -> History:
    """Load history of a recording or programme, with the state of a linear drive.

    Parameters
    ----------
    recording : Recording
        Torque and whatever else was recorded, n samples.
    model : Model
        Line by which the state starts, and the reading of torque without load.

    Returns
    -------
    History
        n samples.
    """
    torque = np.ascontiguousarray(recording.torque_nm - model.torque_zero_nm, dtype=np.float64)
    found = model.one_history and runs_can_go_on(recording)
    run, restart = runs_and_restarts(
        recording.run, one_history=found or recording.history == "continuous"
    )
    side = flanks_of(torque, restart)
    twist = model.elastic_twist(torque)
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


def flanks_of(elastic: Floats, restart: Flags) -> Floats:
    """Flank in contact: the sign of the torque, and at zero torque the last one.

    Parameters
    ----------
    elastic : ndarray, shape (n,)
        Torque that twists the drive [N m].
    restart : ndarray of bool, shape (n,)
        True where play, slip and creep start afresh.

    Returns
    -------
    ndarray, shape (n,)
        +1 or -1.
    """
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
        A repaired model, or a drive: then the published model without calibration. What a repaired
        model is known to miss, ``model_error``, is added to the twist; a torque leaves it out.
    programme : Recording
        Load history; for ``predict="torque"`` with an angle.
    predict : {"angle", "torque"}
        Column to predict, in deg or N m. Where even ramps of the torque turn between two
        readings, a twist turns there, too; a torque turns at the readings, and is then no exact
        inverse.

    Returns
    -------
    Recording
        The same history with the predicted column.

    Raises
    ------
    InputError
        The programme lacks a column that an effect of the model needs, or the model's compliance is
        not above zero.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> load = Recording.from_arrays([0.0, 7.2575, 14.515])
    >>> simulate(cs.Drive.reference_87(), load).angle_deg.round(1)
    array([28. , 47.8, 67.6])
    """
    instance_of("model", model, Model, Drive)
    instance_of("programme", programme, Recording)
    one_of("predict", predict, ("angle", "torque"))
    if isinstance(model, Drive):
        model = Model.of_drive(model, programme.side)
    _check(model, programme)
    if not len(programme):
        return programme.with_angle(np.zeros(0))
    if predict == "torque":
        return replace(programme, torque_nm=_torque(model, programme))
    return programme.with_angle(predict_history(model, programme).angle_deg)


def _check(model: Model, programme: Recording) -> None:
    """Refuse a line that falls, and a programme of another shaft or without a needed column.

    Parameters
    ----------
    model : Model
        Calibrated model.
    programme : Recording
        Load programme.

    Raises
    ------
    InputError
        What the programme lacks, or the compliance.
    """
    check_line(model)
    if programme.side != model.side:
        raise InputError(
            f"{programme.name}: side: found {programme.side!r}, expected {model.side!r} "
            "as in the model"
        )
    for value in model.effects:
        for column in needed_columns(value.effect, value.shape):
            if getattr(programme, column) is None:
                raise InputError(
                    f"{programme.name}: column {column}: missing, "
                    f"expected because the model has {value.name}"
                )


def predict_history(model: Model, programme: Recording) -> History:
    """Settle path, flank and effects along a torque history.

    Parameters
    ----------
    model : Model
        Line and effects.
    programme : Recording
        Torque and the other columns that the effects need, n samples.

    Returns
    -------
    History
        n samples with the predicted path.
    """
    settled = settle(model, history_of(programme, model))
    if model.model_error is None:
        return settled
    missed = model.model_error.twist(settled)
    return settled.with_state(angle_deg=settled.angle_deg + missed)


def settle(
    model: Model, history: History, rounds: int = SIMULATED_ROUNDS, known_side: Floats | None = None
) -> History:
    """Settle path, flank and effects along a load history that is already zeroed.

    Parameters
    ----------
    model : Model
        Line and effects.
    history : History
        Load history of n samples in some state, from which the rounds start.
    rounds : int
        Most rounds in which twist, flank and effects settle on each other.
    known_side : ndarray, shape (n,), optional
        Flank in contact of every sample, +1 or -1, where a recording shows it; without it the
        model finds the flank, which is a forecast.

    Returns
    -------
    History
        The same load with the settled path.
    """
    sliding = [value for value in model.effects if value.effect.slips]
    others = [v for v in model.effects if not sliding or not v.elastic]
    moving = travelling(others)
    lagging = lagging_with_friction(others)
    law = elastic_law(model, history.largest_torque_nm, held_by_friction=True)
    history = history.with_state(measured_deg=None, elastic_law=law)
    if moving:
        rounds += MESH_ROUNDS
        history = on_the_mesh(moving, history, history.angle_deg)
    least = (np.inf, history)
    for _ in range(rounds):
        history = under_drag_of(model, history)
        added, beyond_deg = twist_with_and_without([*moving, *lagging], others, history)
        before = history.angle_deg
        if sliding:
            history = history.with_state(beyond_deg=beyond_deg)
            history = _slide(model, history, sliding, added, known_side)
        else:
            base = model.datum_deg + history.side * model.free_play_deg
            angle = base + model.elastic_twist(history.applied_nm) + added
            if moving:
                history = on_the_mesh(moving, history, angle - linear_twist(moving, history))
            else:
                history = history.with_state(angle_deg=angle)
        if not any(not v.effect.slips for v in others):
            break
        moved = float(np.max(np.abs(history.angle_deg - before)))
        if moved < 1e-6:
            break
        # A long lag and friction that turns with it swing about each other after some rounds.
        if sliding and lagging and moved > least[0]:
            return least[1]
        least = (moved, history)
    return history


def _slide(
    model: Model,
    history: History,
    sliding: Sequence[EffectValue],
    added: Floats,
    known_side: Floats | None,
) -> History:
    """Solve the path of the shaft under friction.

    Parameters
    ----------
    model : Model
        Calibrated model.
    history : History
        Load history, with the elastic law and the twist that lies beyond the friction.
    sliding : sequence of EffectValue
        Friction effects.
    added : ndarray, shape (n,)
        Twist that effects other than friction add, that beyond it included [deg].
    known_side : ndarray, shape (n,), or None
        Flank in contact, +1 or -1, where it is read off the recording.

    Returns
    -------
    History
        The same with torque, angle and flank along the path.
    """
    flank = 0.0 if known_side is None else known_side * model.free_play_deg
    play = model.free_play_deg if known_side is None else 0.0
    law = history.elastic_law
    points = None if law is None else (law.torque_nm, law.twist_deg)
    beyond = history.beyond_deg
    offset = model.datum_deg + added - beyond + flank
    friction = _friction(sliding)
    path = friction.solve(history, offset, play, points)
    elastic = history.applied_nm - path.friction_nm
    state: dict[str, object] = {"elastic_nm": elastic, "angle_deg": path.angle_deg + beyond}
    state |= {"corner_deg": path.corner_deg, "corner_nm": path.corner_nm}
    if known_side is not None:
        return history.with_state(**state)
    # Friction behind the play leaves the play the whole applied torque.
    behind = lies_behind_play(friction.shape)
    carried = history.applied_nm if behind else elastic
    small = 1e-9 * history.largest_torque_nm
    side = flanks_of(np.where(np.abs(carried) < small, 0.0, carried), history.restart)
    if behind:
        state["angle_deg"] = path.angle_deg + beyond + side * model.free_play_deg
    return history.with_state(side=side, **state)


def _friction(sliding: Sequence[EffectValue]) -> Friction:
    """Friction of all effects that slip."""
    return Friction.of((v.effect, v.shape, v.amplitudes[0]) for v in sliding)


def _torque(model: Model, programme: Recording) -> Floats:
    """Torque that holds the drive at the given angles [N m].

    Parameters
    ----------
    model : Model
        Calibrated model.
    programme : Recording
        Load programme with angles.

    Returns
    -------
    ndarray, shape (n,)
        In N m.
    """
    if programme.angle_deg is None:
        raise InputError(f"{programme.name}: angle_deg: missing, expected to predict a torque")
    angle = np.ascontiguousarray(programme.angle_deg, dtype=np.float64)
    sliding = [value for value in model.effects if value.effect.slips]
    held_back = _friction(sliding) if sliding else None
    history = history_of(programme, model).with_state(has_corners=False)
    farthest = float(np.abs(angle - model.datum_deg).max(initial=0.0))
    largest = farthest / model.compliance_deg_per_nm
    law = elastic_law(model, largest, held_by_friction=True)
    history = history.with_state(elastic_law=law)
    if held_back is None and any(value.in_series for value in model.effects):
        law = elastic_law(model, largest)
    others = [
        value
        for value in model.effects
        if not (value.effect.elastic if held_back is None else value.elastic)
    ]
    behind = held_back is not None and lies_behind_play(held_back.shape)
    turning = [*travelling(others), *lagging_with_friction(others)]
    elastic = np.zeros(len(angle))
    friction = np.zeros(len(angle))
    least, stalled = np.inf, 0
    for _ in range(TORQUE_ROUNDS):
        side = flanks_of(elastic, history.restart)
        applied = elastic + friction
        history = history.with_state(
            applied_nm=applied, elastic_nm=elastic, angle_deg=angle, side=side
        )
        history = under_drag_of(model, history)
        added, beyond_deg = twist_with_and_without(turning, others, history)
        twist = angle - model.datum_deg - added
        held = np.sign(twist) * np.maximum(np.abs(twist) - model.free_play_deg, 0.0)
        settled = held / model.compliance_deg_per_nm
        if law is not None:
            settled = np.interp(held, law.twist_deg, law.torque_nm)
        moved = float(np.max(np.abs(settled - elastic)))
        elastic = settled
        if held_back is not None:
            state = {"elastic_nm": elastic, "beyond_deg": beyond_deg}
            if behind:
                # It stands while the play is crossed, where the shaft carries nothing.
                crossed = side * model.free_play_deg + added
                state["angle_deg"] = model.datum_deg + held + crossed
            friction = held_back.torque_nm(history.with_state(**state))
            if behind:
                carries = np.sign(twist) * (elastic + friction) > 0.0
                friction = np.where(carries & (held != 0.0), friction, -elastic)
        stalled = 0 if moved < least else stalled + 1
        least = min(least, moved)
        if moved < 1e-9 * max(float(np.max(np.abs(elastic))), 1e-9) or stalled > STALLED_AFTER:
            break
    return elastic + friction + model.torque_zero_nm
