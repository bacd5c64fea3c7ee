"""A transient of a train: its table, its events, its peaks."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.dynamics.chain import Chain
from cyclosweep.dynamics.spring import Brake, SlipElement
from cyclosweep.errors import InputError

__all__ = ["Transient", "follow"]

Reals = npt.NDArray[np.float64]

MOST_PERIODS = 1_000_000
"""Periods of the fastest oscillation that a transient may last: with an impact or two in each about
ten seconds and 1 GB. Nothing else bounds the events, which are all kept."""


@dataclass(frozen=True, eq=False)
class Transient:
    """What a train did.

    Attributes
    ----------
    train : Chain
        The train.
    peak_torques_nm : dict of str to float
        Largest torque of each spring on its own shaft, with its sign [N m]; found by bounds, not
        from the samples.
    peak_times_s : dict of str to float
        When [s].
    static_torques_nm : dict of str to float
        Larger one, by magnitude, of what each spring carries under the torques before the event
        and at its end when nothing oscillates [N m].
    friction_losses_j : dict of str to float
        Energy that friction has taken in each spring [J].
    """

    train: Chain
    peak_torques_nm: dict[str, float]
    peak_times_s: dict[str, float]
    static_torques_nm: dict[str, float]
    friction_losses_j: dict[str, float]
    _times_s: Reals = field(repr=False)
    _spring_ratios: Reals = field(repr=False)
    _core_columns: dict[str, Any] = field(repr=False)

    @cached_property
    def table(self) -> pl.DataFrame:
        """The samples, every shaft in its own terms.

        Returns
        -------
        polars.DataFrame
            ``time_s``, ``angle_<node>_rad``, ``speed_<node>_rad_per_s``, ``torque_<spring>_nm``
            (friction included), ``kinetic_energy_j``, ``elastic_energy_j`` and
            ``friction_loss_j`` so far.
        """
        found, names, rows = self._core_columns, self.train.names, len(self._times_s)
        nodes = self.train.node_ratios
        angles = found["angles"].reshape(rows, -1) / nodes
        speeds = found["speeds"].reshape(rows, -1) / nodes
        torques = found["torques"].reshape(rows, -1) * self._spring_ratios
        columns = {
            "time_s": self._times_s,
            **_by_name("angle_{}_rad", names, angles),
            **_by_name("speed_{}_rad_per_s", names, speeds),
            **_by_name("torque_{}_nm", self.peak_torques_nm, torques),
            "kinetic_energy_j": found["kinetic"],
            "elastic_energy_j": found["potential"],
            "friction_loss_j": found["lost"],
        }
        return pl.DataFrame({name: np.ascontiguousarray(c) for name, c in columns.items()})

    @cached_property
    def events(self) -> pl.DataFrame:
        """What ended the branches of the springs' laws, in order.

        Returns
        -------
        polars.DataFrame
            ``time_s``, ``spring``, ``event`` (contact, separation, knee, slide, stick),
            ``twist_rad`` and ``speed_rad_per_s`` of the twist on the spring's own shaft.
        """
        found, names = self._core_columns, list(self.peak_torques_nm)
        springs = np.asarray(found["event_springs"], dtype=np.int64)
        own = self._spring_ratios[springs]
        columns = {
            "time_s": found["event_times"],
            "spring": [names[k] for k in springs],
            "event": found["event_kinds"],
            "twist_rad": found["event_twists"] / own,
            "speed_rad_per_s": found["event_speeds"] / own,
        }
        texts = {"spring": pl.String, "event": pl.String}
        return pl.DataFrame(columns, schema_overrides=texts)

    @property
    def shock_factors(self) -> dict[str, float | None]:
        """Peak torque over static torque of each spring [1]; None where nothing is static."""
        return {
            name: abs(peak / static) if (static := self.static_torques_nm[name]) else None
            for name, peak in self.peak_torques_nm.items()
        }

    @property
    def shock_factor(self) -> float | None:
        """Largest shock factor of all springs [1]; None where no torque is static."""
        return max((f for f in self.shock_factors.values() if f is not None), default=None)

    @cached_property
    def impacts(self) -> pl.DataFrame:
        """Events in which play closes, with the speed at which it does."""
        return self.events.filter(pl.col("event") == "contact")

    def summary(self) -> pl.DataFrame:
        """Peaks of every spring.

        Returns
        -------
        polars.DataFrame
            ``spring``, ``peak_nm``, ``at_s``, ``static_nm``, ``shock_factor``, ``impacts``,
            ``friction_loss_j``.
        """
        factors = self.shock_factors
        counts = dict(self.impacts["spring"].value_counts().iter_rows())
        names = list(self.peak_torques_nm)
        return pl.DataFrame(
            {
                "spring": names,
                "peak_nm": [self.peak_torques_nm[name] for name in names],
                "at_s": [self.peak_times_s[name] for name in names],
                "static_nm": [self.static_torques_nm[name] for name in names],
                "shock_factor": [factors[name] for name in names],
                "impacts": [counts.get(name, 0) for name in names],
                "friction_loss_j": [self.friction_losses_j[name] for name in names],
            },
            schema_overrides={"shock_factor": pl.Float64},
        )

    def __repr__(self) -> str:
        peaks = ", ".join(f"{name} {peak:.4g}" for name, peak in self.peak_torques_nm.items())
        factor = "none" if self.shock_factor is None else f"{self.shock_factor:.4g}"
        end = self._times_s[-1]
        return (
            f"Transient({end:g} s, {len(self.impacts)} impacts, peak torques [N m]: {peaks}, "
            f"shock factor {factor})"
        )


def follow(
    train: Chain,
    times: Reals,
    torques: Reals,
    samples: int,
    before: Reals,
    speeds: Reals,
    brake: Brake | None,
) -> Transient:
    """Run the core's integrator and put its answer on the train's own shafts.

    Parameters
    ----------
    train : Chain
        The train.
    times : ndarray, shape (knots,)
        Times of the knots [s].
    torques : ndarray, shape (knots, nodes)
        Torques on the nodes' own shafts [N m].
    samples : int
        Rows of the table.
    before : ndarray, shape (nodes,)
        Torques whose equilibrium is the start [N m].
    speeds : ndarray, shape (nodes,)
        Speeds at the start on the nodes' own shafts [rad/s].
    brake : Brake or None
        Friction of one node against the ground.

    Returns
    -------
    Transient

    Raises
    ------
    InputError
        When it lasts too many periods, or events follow without time passing.
    """
    nodes, springs = train.node_ratios, train.spring_ratios
    core = train.core(brake)
    _refuse_endless(train, core, brake, float(times[-1]))
    preload = train.carried(before / nodes)
    extra = [] if brake is None else [0.0]
    start = core.static_twists([*preload, *extra])
    twists = [twist for twist, _ in start[: len(springs)]]
    angles = np.zeros(len(nodes) + 1)
    held = len(nodes) if train.grounded else len(nodes) - 1
    for node in range(held - 1, -1, -1):
        angles[node] = angles[node + 1] + twists[node]
    anchors = [anchors for _, anchors in start]
    if brake is not None:
        anchors[-1] = [float(angles[brake.node])]
    at = np.linspace(times[0], times[-1], samples)
    try:
        found = core.transient(
            [float(angle) for angle in angles[: len(nodes)]],
            [float(speed) for speed in speeds * nodes],
            anchors,
            np.ascontiguousarray(times),
            np.ascontiguousarray(torques / nodes),
            at,
        )
    except ValueError as error:
        raise InputError(f"transient: {error}") from None
    static = np.array([preload, train.carried(torques[-1] / nodes)]) * springs
    larger = np.abs(static).argmax(axis=0)
    names = [*train.spring_names, *([] if brake is None else ["brake"])]
    ratios = np.r_[springs, [] if brake is None else nodes[brake.node]]
    return Transient(
        train,
        dict(zip(names, (found["peaks"] * ratios).tolist(), strict=True)),
        dict(zip(names, found["peak_times"].tolist(), strict=True)),
        {
            **dict(zip(names, static[larger, range(len(springs))].tolist(), strict=False)),
            **({} if brake is None else {"brake": 0.0}),
        },
        dict(zip(names, found["lost_in"].tolist(), strict=True)),
        at,
        ratios,
        found,
    )


def _refuse_endless(
    train: Chain, core: _core.Train, brake: Brake | None, duration_s: float
) -> None:
    """Refuse a duration of more periods than can be followed, each spring at its steepest."""
    stiffnesses = [
        (max(spring.slopes_nm_per_rad) + _held(spring.friction)) / ratio**2
        for spring, ratio in zip(train.springs, train.spring_ratios, strict=True)
    ]
    if brake is not None:
        stiffnesses.append(_held([brake.element]) / train.node_ratios[brake.node] ** 2)
    squares = core.modes(stiffnesses)[0]
    fastest_hz = math.sqrt(max(squares, default=0.0)) / math.tau
    if not duration_s * fastest_hz <= MOST_PERIODS:
        raise InputError(
            f"duration_s: found {duration_s:g} s, {duration_s * fastest_hz:.3g} periods of the "
            f"train's fastest oscillation ({fastest_hz:.4g} Hz), expected at most "
            f"{MOST_PERIODS:g} periods: {MOST_PERIODS / fastest_hz:.3g} s, or larger inertias"
        )


def _held(friction: Iterable[SlipElement]) -> float:
    """Stiffness of friction that does not slide [N m/rad]."""
    return sum(element.stiffness_nm_per_rad for element in friction)


def _by_name(pattern: str, names: Iterable[str], columns: Reals) -> dict[str, Reals]:
    """Columns of a matrix under their names."""
    return dict(zip(map(pattern.format, names), columns.T, strict=True))
