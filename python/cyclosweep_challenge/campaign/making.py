"""Makes one recording with its answer, by either generator, and writes both."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.campaign.item import Foreign, Item
from cyclosweep_challenge.second_generator.case import ATTEMPTS, PATIENCE, REFERENCE_TWIST_DEG
from cyclosweep_challenge.second_generator.case import Case as ForeignCase
from cyclosweep_challenge.second_generator.case import make_case as make_foreign
from cyclosweep_challenge.second_generator.reach import CannotShowError
from cyclosweep_challenge.second_generator.recipes import draw_recipe
from cyclosweep_challenge.trial.case import Case
from cyclosweep_challenge.trial.plan import FRICTIONS, Entry, make_entry
from cyclosweep_challenge.trial.seal import commit_answer

Array = NDArray[np.float64]

OTHER_CAUSE = 24
"""Step to another cause of the second generator that keeps rich programmes rich."""


def make_item(item: Item) -> Case | ForeignCase:
    """Make the recording of an item; it follows from the item alone."""
    if isinstance(item.kind, Foreign):
        return _foreign(item, item.kind)
    case = make_entry(Entry(item.number, item.kind, item.turn, item.seed, item.samples))
    first = max(case.truth["causes"], key=lambda cause: float(cause["d"]), default=None)
    case.truth["generator"] = "first"
    case.truth["friction_family"] = "library" if first and first["name"] in FRICTIONS else ""
    case.truth["held_out_calibrated_rms_deg"] = _calibrated_rms(case)
    return case


def _foreign(item: Item, kind: Foreign) -> ForeignCase:
    """Draw cases of the second generator until one can be shown, other causes after a while."""
    last = CannotShowError("no attempt")
    for attempt in range(ATTEMPTS):
        key = (item.seed, item.number, attempt)
        rng = np.random.default_rng([*key, 1])
        number = kind.number(item.turn) + OTHER_CAUSE * (attempt // PATIENCE)
        recipe = draw_recipe(kind.tier, number, rng, item.samples, REFERENCE_TWIST_DEG)
        if kind.autocorrelation >= 0.0:
            sensor = replace(recipe.sensor, autocorrelation=kind.autocorrelation)
            recipe = replace(recipe, sensor=sensor)
        if kind.torque_noise:
            noise = kind.torque_noise * recipe.sensor.sigma_deg
            recipe = replace(recipe, sensor=replace(recipe.sensor, torque_noise_deg=noise))
        if kind.d:
            recipe = replace(recipe, d=tuple(kind.d for _ in recipe.d))
        try:
            case = make_foreign(recipe, (*key, 2))
        except CannotShowError as error:
            last = error
            continue
        case.truth["key"] = item.key
        return case
    raise CannotShowError(f"{item.part}/{item.key}: {last}")


def _line(torque_nm: Array, side: Array) -> Array:
    """Columns of the published model with datum, free play and compliance free, shape (N, 3)."""
    return np.column_stack([np.ones_like(torque_nm), side, torque_nm])


def _calibrated_rms(case: Case) -> float:
    """Rms error on the second programme of the published model fitted to the recording [deg]."""
    datum = case.truth["calibration"]["datum_deg"]
    read = case.recording["angle_deg"].to_numpy()
    torque, later = (frame["torque_nm"].to_numpy() for frame in (case.recording, case.program))
    fit = np.linalg.lstsq(_line(torque, np.sign(read - datum)), read, rcond=None)[0]
    clean = case.held_out_clean_deg
    left = clean - _line(later, np.sign(clean - datum)) @ fit
    return float(np.sqrt(np.mean(left**2)))


def answer_of(
    case: Case | ForeignCase, files: Sequence[Path], *, predicted: bool
) -> dict[str, Any]:
    """Answer to a case, with the hashes of its files and the angles that a model has to predict.

    Parameters
    ----------
    case : Case
        Of either generator.
    files : sequence of pathlib.Path
        What was written of it.
    predicted : bool
        Whether a model predicts the second programme.
    """
    answer = json.loads(json.dumps(case.truth))
    answer["files"] = {f.name: hashlib.sha256(f.read_bytes()).hexdigest() for f in files}
    if predicted:
        answer["held_out_clean_deg"] = case.held_out_clean_deg.round(6).tolist()
        answer["held_out_read_deg"] = case.held_out_read_deg.round(6).tolist()
    return dict(answer)


def write_item(item: Item, recordings: Path, target: Path, predicted: bool) -> tuple[str, str]:
    """Make one recording, write it and commit to its answer; return key and hash.

    Parameters
    ----------
    item : Item
        The recording.
    recordings : pathlib.Path
        Folder of the part's recordings.
    target : pathlib.Path
        File of the answer.
    predicted : bool
        Whether the second programme is written as well.
    """
    case = make_item(item)
    folder = case.write(recordings / item.key, program=predicted)
    answer = answer_of(case, sorted(folder.iterdir()), predicted=predicted)
    return item.key, commit_answer(answer, target)
