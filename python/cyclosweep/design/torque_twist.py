"""Torque over twist by the component model, through the free play and up to an overload."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.nominal_line import NominalLine, Side
from cyclosweep.design.numbers import finite_number, whole_number
from cyclosweep.errors import InputError

__all__ = ["Rig", "TorqueTwist", "torque_twist_curve"]

LINE_TO_TN = 2.5
"""Load [T_N] up to which the published loading curve is called linear (Fig. 2 of the paper)."""

LINE_FROM_TN = 0.25
"""Load [T_N] from which a line is fitted: below it the contacts close one after another."""

_COLUMNS = (
    "output_torque_nm",
    "frictionless_torque_nm",
    "friction_torque_nm",
    "active_output_pins",
    "effective_output_pins",
    "output_pin_force_max_n",
    "active_ring_pins",
    "ring_pin_force_max_n",
)
_COUNTS = ("active_output_pins", "active_ring_pins")


@dataclass(frozen=True)
class TorqueTwist:
    """Torque over the turn of one shaft of a drive while the other one is locked.

    Attributes
    ----------
    side : {"input", "output"}
        The shaft that is turned. At ``input`` the crank travels while it loads, and the mesh with
        it; at ``output`` the crank is locked.
    crank_deg : float
        Angle of the crank in the middle [deg].
    nominal_torque_nm : float
        Torque that counts as a load of one [N m]: T_N at the input, the rated one at the output.
    free_play_deg : tuple of float
        Turn at which contacts begin to carry [deg]: below zero, above zero.
    reached : bool
        Whether the load asked for was reached in both directions.
    table : polars.DataFrame
        From the largest negative to the largest positive load: ``angle_deg``, ``torque_nm`` and
        ``load_tn`` at the shaft turned and without friction, ``output_torque_nm``,
        ``input_torque_nm``; ``loading_torque_nm`` and ``unloading_torque_nm`` with Coulomb
        friction at all contacts, null at the output, where nothing slides but by the deflection
        itself; ``active_output_pins``, ``effective_output_pins``, ``output_pin_force_max_n``,
        ``active_ring_pins``, ``ring_pin_force_max_n``; ``converged``: where it is false every
        result is null.
    """

    side: Side
    crank_deg: float
    nominal_torque_nm: float
    free_play_deg: tuple[float, float]
    reached: bool
    table: pl.DataFrame

    def line(self, from_tn: float = LINE_FROM_TN, to_tn: float = LINE_TO_TN) -> NominalLine:
        """Straight line through both branches, as the published model has it.

        Parameters
        ----------
        from_tn, to_tn : float
            Loads between which it is fitted, by least squares of the angle [T_N].

        Returns
        -------
        NominalLine
            Half the free play between both branches' lines, and their mean slope.

        Raises
        ------
        InputError
            When either branch has fewer than two points between the loads.
        """
        ends, slopes = [], []
        for sense in (-1.0, 1.0):
            load = sense * pl.col("load_tn")
            branch = self.table.filter(load >= from_tn, load <= to_tn)
            if branch.height < 2:
                raise InputError(
                    f"line: found {branch.height} points from {from_tn:g} to {to_tn:g} T_N, "
                    "expected at least two in each direction"
                )
            torque = branch["torque_nm"].to_numpy()
            slope, end = np.polyfit(torque, branch["angle_deg"].to_numpy(), 1)
            slopes.append(float(slope))
            ends.append(sense * float(end))
        return NominalLine(sum(ends) / 2, sum(slopes) / 2)

    def friction_share(self) -> float:
        """Torque that friction takes over the frictionless torque, over the whole curve [1].

        Zero at the output, where the component model knows no sliding.
        """
        carrying = self.table.drop_nulls("loading_torque_nm")
        torque = carrying["torque_nm"].to_numpy()
        friction = float(np.abs(carrying["loading_torque_nm"].to_numpy() - torque).sum())
        transmitted = float(np.abs(torque).sum())
        return friction / transmitted if transmitted > 0 else 0.0

    def branches(self) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Torque and angle without the free play, rising, zero at zero torque.

        Returns
        -------
        torque_nm, angle_deg : ndarray, shape (n,)
            Torque at the shaft turned [N m] and the turn beyond the end of the free play [deg].
            Where the torque falls as the crank goes on, it stands for a jump to the turn at which
            it is next reached.
        """
        torque, angle = [np.zeros(1)], [np.zeros(1)]
        for sense, play in zip((-1.0, 1.0), self.free_play_deg, strict=True):
            carrying = self.table.filter(
                pl.col("converged"), sense * (pl.col("angle_deg") - play) > 0
            )
            load = sense * carrying["torque_nm"].to_numpy()
            beyond = sense * (carrying["angle_deg"].to_numpy() - play)
            order = np.argsort(beyond)
            load, beyond = load[order], beyond[order]
            highest = np.maximum.accumulate(np.r_[0.0, load])[:-1]
            rising = load > highest
            torque.append(sense * load[rising])
            angle.append(sense * beyond[rising])
        both = np.concatenate(torque), np.concatenate(angle)
        order = np.argsort(both[0])
        return both[0][order], both[1][order]


class Rig(NamedTuple):
    """What is turned in a test rig, and how far.

    Attributes
    ----------
    side : {"input", "output"}
        Shaft that is turned.
    crank_deg : float
        Angle of the crank in the middle [deg].
    nominal_torque_nm : float
        Torque of that shaft that counts as one [N m].
    to_load_tn : float
        Largest load over it [1].
    points : int
        Equal steps in each direction.
    """

    side: Side
    crank_deg: float
    nominal_torque_nm: float
    to_load_tn: float
    points: int


def torque_twist_curve(study: _core.Study, parts: _core.PartStudy, rig: Rig) -> TorqueTwist:
    """Turn one shaft of a drive in both directions until it carries a load.

    Parameters
    ----------
    study : cyclosweep._core.Study
        A drive's study.
    parts : cyclosweep._core.PartStudy
        Its component model.
    rig : Rig
        What is turned, and how far.

    Returns
    -------
    TorqueTwist

    Raises
    ------
    InputError
        For another side, an angle or a load that is no such number, or fewer than two points.
    """
    side, crank_deg, nominal, to_load_tn, points = rig
    crank_deg = finite_number("crank_deg", crank_deg)
    to_load_tn = finite_number("to_load_tn", to_load_tn)
    if to_load_tn <= 0:
        raise InputError(f"to_load_tn: found {to_load_tn:g}, expected a number above zero")
    points = whole_number("points", points, least=2, most=1_000_000)
    plays, reached, tables = [], True, []
    for sense in (-1.0, 1.0):
        rows, converged, play, far_enough = _core.torque_twist(
            parts, study, side, math.radians(crank_deg), sense, to_load_tn * nominal, points
        )
        plays.append(math.degrees(play))
        reached &= far_enough
        keep = slice(None) if sense > 0 else slice(None, 0, -1)
        tables.append(_table(rows[:, keep], converged[keep], side, nominal))
    return TorqueTwist(
        side=side,
        crank_deg=crank_deg,
        nominal_torque_nm=nominal,
        free_play_deg=(plays[0], plays[1]),
        reached=reached,
        table=pl.concat(tables),
    )


def _table(
    rows: npt.NDArray[np.float64], converged: npt.NDArray[np.bool_], side: Side, nominal: float
) -> pl.DataFrame:
    """Rows of one direction, in the order of their angles."""
    columns = dict(zip(("turn", *_COLUMNS), rows, strict=True))
    friction = pl.col("friction_torque_nm") if side == "input" else pl.lit(None, pl.Float64)
    # Friction is against the motion: away from the middle when loading.
    outwards = friction * pl.col("angle_deg").sign()
    table = pl.DataFrame({name: columns[name] for name in _COLUMNS}).with_columns(
        pl.col(_COUNTS).cast(pl.Int64), angle_deg=np.degrees(columns["turn"]), converged=converged
    )
    own = "frictionless_torque_nm" if side == "input" else "output_torque_nm"
    table = table.select(
        "angle_deg",
        torque_nm=own,
        load_tn=pl.col(own) / nominal,
        output_torque_nm="output_torque_nm",
        input_torque_nm="frictionless_torque_nm",
        loading_torque_nm=pl.col("frictionless_torque_nm") + outwards,
        unloading_torque_nm=pl.col("frictionless_torque_nm") - outwards,
        active_output_pins="active_output_pins",
        effective_output_pins="effective_output_pins",
        output_pin_force_max_n="output_pin_force_max_n",
        active_ring_pins="active_ring_pins",
        ring_pin_force_max_n="ring_pin_force_max_n",
        converged="converged",
    )
    results = [name for name in table.columns if name not in ("angle_deg", "converged")]
    return table.with_columns(pl.when("converged").then(pl.col(results)))
