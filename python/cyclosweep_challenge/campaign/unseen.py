"""What a repaired model removes of the mismatch on a load programme that it has not seen."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl

LEAST_OWN = 0.5
"""Share that the generator's own law has to remove for a ratio to it: less where chance decides."""


@dataclass(frozen=True)
class Unseen:
    """Shares of the mean square mismatch that are removed on the second programme.

    The mismatch is the error of the calibrated published model against the noise-free angle.

    Attributes
    ----------
    removed, removed_everywhere : float
        By the repaired model, without and with readings that it puts on the wrong side of the
        free play; zero where there is no repaired model [-].
    own : float
        By the generator's own law with its parameters fitted to the recording [-].
    error_ratio : float
        Rms error of the repaired model over that of the calibrated one, wrong sides left out [-].
    wrong_side : float
        Share of readings on the wrong side [-].
    """

    removed: float = math.nan
    removed_everywhere: float = math.nan
    own: float = math.nan
    error_ratio: float = math.nan
    wrong_side: float = math.nan

    @property
    def relative(self) -> float:
        """What is removed over what the generator's own law removes, if that is much [-]."""
        return self.removed / self.own if self.own >= LEAST_OWN else math.nan

    @property
    def relative_everywhere(self) -> float:
        """The same with readings on the wrong side [-]."""
        return self.removed_everywhere / self.own if self.own >= LEAST_OWN else math.nan


def unseen_of(answer: Mapping[str, Any], prediction: Path) -> Unseen:
    """Compare a prediction of the second programme with its noise-free angle.

    Parameters
    ----------
    answer : mapping
        The opened answer.
    prediction : pathlib.Path
        CSV of the repaired model's angle; it may be absent.
    """
    if "held_out_clean_deg" not in answer:
        return Unseen()
    mismatch = float(answer["held_out_calibrated_rms_deg"]) ** 2
    if mismatch <= 0.0:
        return Unseen()
    own = 1.0 - float(answer["held_out_fitting_rms_deg"]) ** 2 / mismatch
    clean = np.array(answer["held_out_clean_deg"])
    predicted = (
        pl.read_csv(prediction)["angle_deg"].cast(pl.Float64).to_numpy()
        if prediction.exists()
        else np.zeros(0)
    )
    there = np.isfinite(predicted)
    if predicted.size != clean.size or not there.any():
        return Unseen(0.0, 0.0, own, 1.0, 0.0)
    datum = float(answer["calibration"]["datum_deg"])
    wrong = there & (np.sign(predicted - datum) != np.sign(clean - datum))
    right = there & ~wrong
    error = (predicted - clean) ** 2
    kept = float(np.mean(error[right])) if right.any() else math.inf
    return Unseen(
        1.0 - kept / mismatch,
        1.0 - float(np.mean(error[there])) / mismatch,
        own,
        math.sqrt(kept / mismatch),
        float(np.mean(wrong[there])),
    )
