"""A transient of a train: its table, its events, its peaks."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.dynamics.chain import Chain
from cyclosweep.dynamics.spring import Brake
from cyclosweep.errors import InputError

__all__ = ["Transient", "follow"]

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Transient:
    """What a train did.

    Attributes
    ----------
    train : Chain
        The train.
    table : polars.DataFrame
        Samples: ``time_s``, ``angle_<node>_rad``, ``speed_<node>_rad_per_s``,
        ``torque_<spring>_nm`` (friction included), ``kinetic_energy_j``, ``elastic_energy_j`` and
        ``friction_loss_j`` so far. Every shaft in its own terms.
    events : polars.DataFrame
        ``time_s``, ``spring``, ``event`` (contact, separation, knee, slide, stick), ``twist_rad``
        and ``speed_rad_per_s`` of the twist on the spring's own shaft.
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
    table: pl.DataFrame
    events: pl.DataFrame
    peak_torques_nm: dict[str, float]
    peak_times_s: dict[str, float]
    static_torques_nm: dict[str, float]
    friction_losses_j: dict[str, float]

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
        end = self.table["time_s"][-1]
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
    """
    nodes, springs = train.node_ratios, train.spring_ratios
    core = train.core(brake)
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
        _table(train, names, ratios, at, found),
        _events(names, ratios, found),
        dict(zip(names, (found["peaks"] * ratios).tolist(), strict=True)),
        dict(zip(names, found["peak_times"].tolist(), strict=True)),
        {
            **dict(zip(names, static[larger, range(len(springs))].tolist(), strict=False)),
            **({} if brake is None else {"brake": 0.0}),
        },
        dict(zip(names, found["lost_in"].tolist(), strict=True)),
    )


def _table(
    train: Chain, names: list[str], ratios: Reals, at: Reals, found: dict[str, Reals]
) -> pl.DataFrame:
    nodes = train.node_ratios
    angles = found["angles"].reshape(len(at), -1) / nodes
    speeds = found["speeds"].reshape(len(at), -1) / nodes
    torques = found["torques"].reshape(len(at), -1) * ratios
    columns: dict[str, Reals] = {"time_s": at}
    for k, name in enumerate(train.names):
        columns[f"angle_{name}_rad"] = angles[:, k]
    for k, name in enumerate(train.names):
        columns[f"speed_{name}_rad_per_s"] = speeds[:, k]
    for k, name in enumerate(names):
        columns[f"torque_{name}_nm"] = torques[:, k]
    columns["kinetic_energy_j"] = found["kinetic"]
    columns["elastic_energy_j"] = found["potential"]
    columns["friction_loss_j"] = found["lost"]
    return pl.DataFrame({name: np.ascontiguousarray(column) for name, column in columns.items()})


def _events(names: list[str], ratios: Reals, found: dict[str, Reals]) -> pl.DataFrame:
    springs = np.asarray(found["event_springs"], dtype=np.int64)
    own = ratios[springs]
    return pl.DataFrame(
        {
            "time_s": found["event_times"],
            "spring": [names[k] for k in springs],
            "event": list(found["event_kinds"]),
            "twist_rad": found["event_twists"] / own,
            "speed_rad_per_s": found["event_speeds"] / own,
        },
        schema={
            "time_s": pl.Float64,
            "spring": pl.String,
            "event": pl.String,
            "twist_rad": pl.Float64,
            "speed_rad_per_s": pl.Float64,
        },
    )
