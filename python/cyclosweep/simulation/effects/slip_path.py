"""Path of friction on slip elements: solved under the torque, or followed along an angle."""

from dataclasses import dataclass

import numpy as np

import cyclosweep._core as _core
from cyclosweep.errors import InputError
from cyclosweep.simulation.effects.conditioning import Conditioning
from cyclosweep.simulation.effects.corners import NO_CORNERS, Corners
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.parameters import Shape
from cyclosweep.simulation.effects.slip_elements import Elements, elements_of
from cyclosweep.simulation.effects.slip_start import crossed_play, lies_behind_play, start_of

BY_READING = "by_reading"
"""Name in the shape of a friction or a drag: 1 where the torque turns at the readings, as in
simulations that go straight from one to the next, and not at corners between them."""


def between_and_by_reading(shape: Shape) -> tuple[Shape, Shape]:
    """Shape that turns between the readings, and the same that turns at them."""
    between = {name: value for name, value in shape.items() if name != BY_READING}
    return between, {**between, BY_READING: 1.0}


def otherwise_read(shape: Shape) -> Shape:
    """Shape that turns at the readings, or no longer does."""
    between, by_reading = between_and_by_reading(shape)
    return between if BY_READING in shape else by_reading


def check_flag(shape: Shape, name: str) -> bool:
    """Value of a flag of a shape; refuse one that is neither 0 nor 1.

    Parameters
    ----------
    shape : mapping
        Shape parameters by name.
    name : str
        Of the flag; a shape without it has it at 0.

    Returns
    -------
    bool

    Raises
    ------
    InputError
        The flag is neither 0 nor 1.
    """
    value = shape.get(name, 0.0)
    if value not in (0.0, 1.0):
        raise InputError(f"{name}: found {value:g}, expected 0 or 1")
    return bool(value)


@dataclass(frozen=True, eq=False)
class SlipPath:
    """Angle and friction along a load history.

    Attributes
    ----------
    angle_deg, friction_nm : ndarray, shape (n,)
        Angle of the part that friction holds [deg], and friction torque [N m], at the samples.
    corner_deg, corner_nm : ndarray, shape (m,), or None
        Angle by which friction slides [deg], and elastic torque [N m], at the corners of the load
        between the samples; None without corners.
    """

    angle_deg: Floats
    friction_nm: Floats
    corner_deg: Floats | None = None
    corner_nm: Floats | None = None


def _corners(history: History, shape: Shape) -> Corners:
    """Corners at which friction of a shape turns."""
    return NO_CORNERS if shape.get(BY_READING, 0.0) else history.corners


def _onto_flank(before: Conditioning, history: History) -> Floats:
    """Angle from the flank of first readings to that of the loads before, shape (h, 2) [deg]."""
    side = history.side[history.restart | (np.arange(len(history)) == 0)]
    return np.asarray((before.flank - side[:, None]) * history.free_play_deg)


def _start_before(before: Conditioning, start: Floats, history: History, shape: Shape) -> Floats:
    """Angle at which elements are anchored, where a load before the first reading comes first.

    Parameters
    ----------
    before : Conditioning
    start : ndarray, shape (n,)
        See `start_of` [deg].
    history : History
    shape : mapping
        Shape of the friction.

    Returns
    -------
    ndarray, shape (n + 2 h,)
        In deg.
    """
    at_first = start[before.first][:, None]
    if not lies_behind_play(shape):
        at_first = at_first + (1.0 - float(shape.get("slack", 0.0))) * _onto_flank(before, history)
    return before.insert(start, at_first)


def slip_state(
    history: History,
    shape: Shape,
    stretch: Floats | None = None,
    elements: Elements | None = None,
) -> Floats:
    """State of the elements along the model's path.

    The angles of a conditioning are those of the straight line.

    Parameters
    ----------
    history : History
        Load history of n samples with the model's path.
    shape : mapping
        Shape of a friction.
    stretch : ndarray, shape (n,), optional
        Factor on the presliding distances, see `stretch_of`; default: one.
    elements : Elements, optional
        Default: those of the shape's ``slip_deg``, ``scatter`` and ``skew``.

    Returns
    -------
    ndarray, shape (n,)
        Friction over its limit, between -1 and 1.
    """
    elements = elements_of(shape) if elements is None else elements
    corners = _corners(history, shape)
    angle = history.held_deg - crossed_play(history, shape)
    restart, start = history.restart, start_of(history, shape)
    stretch = np.ones(len(history)) if stretch is None else stretch
    if len(corners):
        at_corner = history.corner_deg
        if at_corner is None or len(at_corner) != len(corners):
            at_corner = corners.beyond(history.applied_nm, angle, history.compliance_deg_per_nm)
        angle = corners.insert(angle, at_corner)
        restart, start = corners.insert(restart, False), corners.insert(start, 0.0)
        stretch = corners.insert(stretch, corners.between(stretch))
    before = Conditioning.of(restart, shape)
    if before is not None:
        worked = history.datum_deg + history.compliance_deg_per_nm * before.torque_nm
        if not lies_behind_play(shape):
            worked = worked + before.flank * history.free_play_deg
        angle, start = before.insert(angle, worked), _start_before(before, start, history, shape)
        stretch, restart = before.held(stretch), before.restarts(restart)
    state = _core.slip_state(
        np.ascontiguousarray(angle),
        restart,
        start,
        stretch,
        elements.slip_deg,
        elements.share,
        forgetting=float(shape.get("forgetting", 0.0)),
    )
    state = state if before is None else before.taken_out(state)
    return corners.taken_out(state) if len(corners) else state


def solve_slip(
    history: History,
    shape: Shape,
    offset: Floats,
    limits: tuple[float, float],
    free_play: float,
    law: tuple[Floats, Floats] | None = None,
    elements: Elements | None = None,
) -> SlipPath:
    """Angle and friction torque along the applied torque.

    Parameters
    ----------
    history : History
        Load history of n samples with the calibrated line.
    shape : mapping
        Shape of the friction.
    offset : ndarray, shape (n,)
        Everything that shifts the datum [deg].
    limits : tuple of float
        Friction limit without load [N m], and over the transmitted torque (at the shape's
        ``reference_nm``, where it has a ``load_power``).
    free_play : float
        Half width of the dead zone; zero where `offset` already holds the flank in contact [deg].
    law : pair of ndarray, optional
        Elastic torques [N m] and twists [deg] of an elastic law that is no line.
    elements : Elements, optional
        Default: those of the shape's ``slip_deg``, ``scatter`` and ``skew``.

    Returns
    -------
    SlipPath
    """
    elements = elements_of(shape) if elements is None else elements
    corners = _corners(history, shape)
    torque, restart, start = history.applied_nm, history.restart, start_of(history, shape)
    if len(corners):
        torque = corners.insert(torque, corners.torque_nm)
        offset = corners.insert(offset, corners.between(offset))
        restart, start = corners.insert(restart, False), corners.insert(start, 0.0)
    before = Conditioning.of(restart, shape)
    if before is not None:
        torque = before.insert(torque, before.torque_nm)
        start = _start_before(before, start, history, shape)
        at_first = offset[before.first][:, None]
        if free_play == 0.0 and not lies_behind_play(shape):
            # The offset holds the flank of the first reading.
            at_first = at_first + _onto_flank(before, history)
        offset, restart = before.insert(offset, at_first), before.restarts(restart)
    angle, friction = _core.solve_slip(
        torque,
        np.ascontiguousarray(offset),
        restart,
        np.ascontiguousarray(start),
        elements.slip_deg,
        elements.share,
        free_play=free_play,
        compliance=history.compliance_deg_per_nm,
        limit=limits[0],
        load_factor=limits[1],
        load_power=float(shape.get("load_power", 0.0)),
        growth=float(shape.get("growth", 0.0)),
        reference_torque=float(shape.get("reference_nm", 1.0)),
        forgetting=float(shape.get("forgetting", 0.0)),
        law_torque=None if law is None else law[0],
        law_twist=None if law is None else law[1],
    )
    if before is not None:
        angle, friction = before.taken_out(angle), before.taken_out(friction)
    if not len(corners):
        return SlipPath(angle, friction)
    there = corners.places
    return SlipPath(
        corners.taken_out(angle),
        corners.taken_out(friction),
        angle[there],
        corners.torque_nm - friction[there],
    )
