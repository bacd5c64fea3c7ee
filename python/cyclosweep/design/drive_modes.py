"""Natural frequencies of a drive's train, and which of its dimensions moves them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.design.parts import TRAIN_INPUTS
from cyclosweep.dynamics.modes import Modes
from cyclosweep.errors import DesignError, InputError

if TYPE_CHECKING:
    from cyclosweep.design.drive import Drive
    from cyclosweep.design.drive_train import CalibratedModel

__all__ = ["dimension_sensitivities", "modes"]

Springs = Literal["published", "components"]

STEP = 1e-4
"""Relative change of a dimension: rounding of the frequency (1e-13) and the curvature of its law
(1e-8) then both stay far below the digits that are shown."""
LEAST = 1e-7
"""Percent per percent below which a dimension is taken not to move a frequency."""
COUNTS = frozenset(["ratio", "disc_count", "output_pin_count", "criterion"])
"""Inputs without a small relative change."""
HELD = frozenset(["input_power_kw", "input_speed_rpm", "output_torque_nm"])
"""Numbers that say how the drive is loaded, not how it is built."""


def modes(
    drive: Drive,
    model: Springs | CalibratedModel = "published",
    *,
    torque_nm: float | None = None,
    locked: bool = False,
    with_efficiency: bool = True,
    **parts: float | None,
) -> Modes:
    """Natural frequencies of a drive's train around a load that keeps the play closed.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : {"published", "components"} or Model
        Where the springs come from: :meth:`cyclosweep.Drive.train`.
    torque_nm : float, optional
        Torque at the input around which the train oscillates [N m]; the nominal one by default.
        Zero means just beyond the play, and a negative one acts on the other flank.
    locked : bool
        Whether the last inertia is held.
    with_efficiency : bool
        Whether the published compliance carries the torque transfer efficiency of Eq. (13).
    **parts
        Inertias and springs that the drive's file does not hold: :meth:`cyclosweep.Drive.train`.

    Returns
    -------
    Modes
        Natural frequencies [Hz], lowest first, and shapes, the largest angle of each being one [1].

    Raises
    ------
    InputError
        For an unknown part, a number out of range, a torque that is no finite number, or a drive
        without inertia at its input.
    DesignError
        When the drive cannot be built.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> free = cs.modes(cs.Drive.reference_87(), load_inertia_kg_m2=5.0)
    >>> [round(float(hertz), 1) for hertz in free.frequencies_hz]
    [0.0, 32.7]
    """
    train = drive.train(model, with_efficiency=with_efficiency, **parts)
    torque = drive.nominal_torque_nm if torque_nm is None else torque_nm
    return train.modes(torque, locked=locked)


def dimension_sensitivities(
    drive: Drive,
    model: Springs = "published",
    *,
    torque_nm: float | None = None,
    locked: bool = False,
    with_efficiency: bool = True,
    **parts: float | None,
) -> pl.DataFrame:
    """What each natural frequency does when a dimension of the drive grows, all others kept.

    Parameters
    ----------
    drive : Drive
        The drive.
    model : {"published", "components"}
        Where the springs come from; a calibrated model has no dimensions.
    torque_nm, locked, with_efficiency, **parts
        As for :func:`modes`; the torque is kept too.

    Returns
    -------
    polars.DataFrame
        ``mode``, ``frequency_hz``, ``dimension`` (a key of the drive file), ``value`` in the key's
        unit, ``percent_per_percent`` [1] and ``hz_per_unit`` [Hz over the key's unit], for every
        mode above zero the dimension that moves it most first. Dimensions that move nothing are
        left out.

    Raises
    ------
    InputError
        As for :func:`modes`, and for a calibrated model.
    DesignError
        When the drive cannot be built.

    Notes
    -----
    Difference quotients over a ten-thousandth of the dimension to both sides, or to the one side
    on which the drive can be built. Counts, the ratio and dimensions of zero are left out: they
    have no small relative change; sweep them.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> found = cs.dimension_sensitivities(cs.Drive.reference_87(), load_inertia_kg_m2=5.0)
    >>> found.filter(dimension="youngs_modulus_gpa")["percent_per_percent"].round(6).to_list()
    [0.5]
    """
    if not isinstance(model, str):
        raise InputError(f"model: found {model!r}, expected 'published' or 'components'")
    torque = drive.nominal_torque_nm if torque_nm is None else torque_nm

    def frequencies(of: Drive) -> npt.NDArray[np.float64]:
        found = modes(
            of,
            model,
            torque_nm=torque,
            locked=locked,
            with_efficiency=with_efficiency,
            **parts,
        )
        return found.frequencies_hz

    nominal = frequencies(drive)
    rows = []
    for name, value in _continuous(drive, model):
        ends = []
        for factor in (1 - STEP, 1 + STEP):
            try:
                ends.append((factor, frequencies(drive.replace(**{name: value * factor}))))
            except (DesignError, InputError):
                ends.append((1.0, nominal))
        (low, below), (high, above) = ends
        if high == low:
            continue
        for mode, hertz in enumerate(nominal):
            if hertz == 0:
                continue
            elasticity = float((above[mode] - below[mode]) / (high - low) / hertz)
            if abs(elasticity) >= LEAST:
                per_unit = elasticity * float(hertz) / value
                rows.append((mode + 1, float(hertz), name, value, elasticity, per_unit))
    schema = {
        "mode": pl.Int64,
        "frequency_hz": pl.Float64,
        "dimension": pl.String,
        "value": pl.Float64,
        "percent_per_percent": pl.Float64,
        "hz_per_unit": pl.Float64,
    }
    table = pl.DataFrame(rows, schema=schema, orient="row")
    largest = pl.col("percent_per_percent").abs()
    return table.sort("mode", largest, descending=[False, True], maintain_order=True)


def _continuous(drive: Drive, model: Springs) -> Iterator[tuple[str, float]]:
    """Dimensions of a drive that have a small relative change, with their values."""
    parts = drive.part_values()
    if model == "published":
        parts = {name: parts[name] for name in TRAIN_INPUTS}
    for name, value in {**drive.values(), **parts}.items():
        if name not in COUNTS | HELD and math.isfinite(value) and value != 0:
            yield name, value
