"""Example cases for the page: residuals before and after the repair."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.trial.tiers import TIERS

Array = NDArray[np.float64]

SHOWN = 700
"""Points drawn of a recording."""


@dataclass(frozen=True)
class Exhibit:
    """One example case.

    Attributes
    ----------
    outcome : Outcome
        Answer and diagnosis.
    statement : str
        Statement of the diagnosis.
    torque_nm : array
        Torque of the points shown [N m].
    before_deg : array
        What the calibrated published model leaves over [deg].
    after_deg : array or None
        What the repaired model leaves over [deg]; None without one.
    """

    outcome: Outcome
    statement: str
    torque_nm: Array
    before_deg: Array
    after_deg: Array | None


def choose(outcomes: list[Outcome], per_tier: int = 2) -> list[Outcome]:
    """Choose the first cases of every tier that conceals something, whether found or not."""
    chosen: list[Outcome] = []
    for tier in TIERS:
        there = [o for o in outcomes if o.tier == tier and o.causes]
        chosen += there[:per_tier]
    return chosen


def exhibit(outcome: Outcome, statement: str, recording: Path, predicted: Path) -> Exhibit:
    """Collect what is shown of one case.

    Parameters
    ----------
    outcome : Outcome
        Answer and diagnosis.
    statement : str
        Statement of the diagnosis.
    recording : pathlib.Path
        The recording's CSV.
    predicted : pathlib.Path
        The repaired model's angle for the same programme; need not exist.
    """
    table = pl.read_csv(recording)
    torque = table["torque_nm"].cast(pl.Float64).to_numpy()
    angle = table["angle_deg"].cast(pl.Float64).to_numpy()
    columns = np.column_stack([np.ones_like(torque), np.sign(torque), torque])
    before = angle - columns @ np.linalg.lstsq(columns, angle)[0]
    after: Array | None = None
    if predicted.exists():
        answer = pl.read_csv(predicted)["angle_deg"].cast(pl.Float64).to_numpy()
        after = angle - answer if answer.size == angle.size else None
    pick = np.linspace(0, torque.size - 1, min(SHOWN, torque.size)).astype(int)
    return Exhibit(
        outcome, statement, torque[pick], before[pick], None if after is None else after[pick]
    )
