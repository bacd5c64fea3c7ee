"""Table across the recordings of a series, and whether a condition moves what was found."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.errors import InputError
from cyclosweep.recording import Recording
from cyclosweep.recording.metadata import Metadata
from cyclosweep.report.lost_motion import lost_motion_deg
from cyclosweep.report.play_and_stiffness import mean_and_interval
from cyclosweep.result import PlayAndStiffness
from cyclosweep.result.series import FEWEST, MEASURES, Level, Trend

Row = dict[str, Any]

READ_BY = {True: "straight lines", False: "calibrated model"}
"""How play and compliance were read, by whether lines through the branches could be laid."""

LEAST_LEVELS = 3
"""Fewest values of a condition that make a trend."""
PERMUTATIONS = 9999
"""Random orders by which a trend is judged: the smallest probability is one in ten thousand."""


def conditions_of(name: str, meta: Metadata) -> dict[str, float | str]:
    """Return the conditions of a recording: those of its metadata and those in its name.

    Parameters
    ----------
    name : str
        Name of the recording's file without its endings.
    meta : Metadata
        With ``conditions`` and ``conditions_from_name``.

    Returns
    -------
    dict of str to float or str

    Raises
    ------
    InputError
        The name does not have the form that ``conditions_from_name`` says.
    """
    found: dict[str, float | str] = {}
    if meta.conditions_from_name is not None:
        match = re.search(meta.conditions_from_name, name)
        if match is None:
            raise InputError(
                f"{name}: the name does not have the form of conditions_from_name, "
                f"{meta.conditions_from_name}"
            )
        found |= {key: _number(text) for key, text in match.groupdict().items() if text}
    return found | meta.conditions


def _number(text: str) -> float | str:
    """Return the number that a text is, or the text."""
    try:
        return float(text)
    except ValueError:
        return text


def small_loops_of(path: Path, meta: Metadata, meta_path: Path | None) -> Row:
    """Lost motion of the runs of small loops, for the table.

    Parameters
    ----------
    path : Path
        The recording's file.
    meta : Metadata
        With ``lost_motion_runs``; nothing is read where there are none.
    meta_path : Path or None
        Its file, for messages.

    Returns
    -------
    dict
        ``lost_motion_deg`` with its 95 % interval by Student's t over the runs, and the torque of
        the loops' ends.

    Raises
    ------
    InputError
        The file has none of these runs, or none that is loaded in both directions.
    """
    if not meta.lost_motion_runs:
        return {}
    where = meta_path or path
    recording = Recording.read_as(path, meta.of_small_loops(), where)
    angles, torques = lost_motion_deg(recording)
    if not angles:
        raise InputError(
            f"{path}: lost_motion_runs: found runs loaded in one direction only, expected small "
            "loops through zero"
        )
    mean, interval = mean_and_interval(angles)
    low, high = interval or (None, None)
    return {
        "lost_motion_deg": mean,
        "lost_motion_deg_low": low,
        "lost_motion_deg_high": high,
        "lost_motion_torque_nm": float(np.mean(torques)),
    }


def row_of(found: Diagnosis) -> Row:
    """Row of one diagnosis in the table, without its conditions.

    Parameters
    ----------
    found : Diagnosis
        What was found.

    Returns
    -------
    dict
        Verdict, effects, sizes and calibrated values with 95 % intervals.
    """
    answer, recording = found.answer, found.recording
    row: Row = {
        "status": "ok",
        "verdict": answer.verdict,
        "effects": " + ".join(effect.name for effect in answer.effects),
    }
    if recording.temperature_c is not None:
        row["mean_temperature_c"] = float(np.mean(recording.temperature_c))
    read = answer.play_and_stiffness or PlayAndStiffness()
    for column, reading in (
        ("friction_nm", read.friction_nm),
        ("play_deg", read.free_play_deg),
        ("loop_compliance_deg_per_nm", read.compliance_deg_per_nm),
        ("stiffness_at_output_nm_per_arcmin", read.stiffness_at_output_nm_per_arcmin),
    ):
        row[column] = None if reading is None else reading.estimate
        ends = None if reading is None else reading.ci95
        row[f"{column}_low"], row[f"{column}_high"] = ends or (None, None)
    row["side"] = recording.side
    row["read_by"] = None if not read.definition else READ_BY[read.runs > 0]
    row["not_read"] = read.reason
    for name, value in answer.repaired.parameters.items():
        row[f"fitted_{name}"] = value.estimate
        row[f"fitted_{name}_std_error"] = value.std_error
    row["rmse_deg"] = answer.repaired.rmse_deg
    row["noise_deg"] = answer.noise.sigma_deg
    for effect in answer.effects:
        row[f"{effect.name}_deg"] = effect.size_deg.estimate
        row[f"{effect.name}_deg_low"], row[f"{effect.name}_deg_high"] = effect.size_deg.ci95
    row["summary"] = answer.summary
    row["remarks"] = "; ".join(doubt.text for doubt in answer.plausibility)
    return row


def trends(rows: Sequence[Row], conditions: Sequence[str], seed: int = 0) -> list[Trend]:
    """Test every measure for a monotone trend with every numeric condition.

    The statistic is Kendall's: pairs in rising order less pairs in falling order, counted among
    recordings that agree in all other conditions (Mann 1945; stratified as by Hirsch and Slack
    1982). Its probability is that among random orders within those groups.

    Parameters
    ----------
    rows : sequence of dict
        Rows of the table.
    conditions : sequence of str
        Columns that are conditions.
    seed : int
        Seed of the random orders.

    Returns
    -------
    list of Trend
        One for each condition with three values or more. Of fewer than six recordings it says the
        order alone: its probability is not tested.
    """
    found: list[Trend] = []
    for condition in conditions:
        others = [name for name in conditions if name != condition]
        for measure in MEASURES:
            known = [
                row
                for row in rows
                if _is_number(row.get(condition)) and _is_number(row.get(measure))
            ]
            if len({row[condition] for row in known}) < LEAST_LEVELS:
                continue
            groups: dict[tuple[Any, ...], list[Row]] = {}
            for row in known:
                groups.setdefault(tuple(row.get(name) for name in others), []).append(row)
            found.append(_trend(condition, measure, known, list(groups.values()), seed))
    return _holm(found)


def _trend(
    condition: str, measure: str, known: Sequence[Row], groups: Sequence[Sequence[Row]], seed: int
) -> Trend:
    """One trend, its probability not corrected yet.

    Parameters
    ----------
    condition, measure : str
        Columns.
    known : sequence of dict
        Rows that have both.
    groups : sequence of sequences of dict
        The same rows, those together that agree in all other conditions.
    seed : int
        Seed of the random orders.

    Returns
    -------
    Trend
    """
    rng = np.random.default_rng(seed)
    rising = falling = 0
    drawn = np.zeros(PERMUTATIONS, dtype=np.int64)
    for group in groups:
        x = np.array([row[condition] for row in group])
        y = np.array([row[measure] for row in group])
        order = np.sign(x[:, None] - x)[np.triu_indices(len(x), 1)]
        steps = order * np.sign(y[:, None] - y)[np.triu_indices(len(y), 1)]
        rising += int(np.count_nonzero(steps > 0))
        falling += int(np.count_nonzero(steps < 0))
        for k in range(PERMUTATIONS):
            z = rng.permutation(y)
            drawn[k] += int((order * np.sign(z[:, None] - z)[np.triu_indices(len(z), 1)]).sum())
    extreme = np.count_nonzero(np.abs(drawn) >= abs(rising - falling))
    levels = []
    for value in sorted({float(row[condition]) for row in known}):
        values = [float(row[measure]) for row in known if row[condition] == value]
        mean, interval = mean_and_interval(values)
        assert mean is not None  # a level has a recording
        levels.append(Level(value=value, recordings=len(values), mean=mean, ci95=interval))
    return Trend(
        condition=condition,
        measure=measure,
        pairs=rising + falling,
        rising=rising,
        p_value=float((extreme + 1) / (PERMUTATIONS + 1)),
        levels=tuple(levels),
        recordings=len(known),
        apart=_apart(known, condition, measure),
    )


def _apart(known: Sequence[Row], condition: str, measure: str) -> bool | None:
    """Whether the intervals of the recordings at both ends of a condition lie apart.

    Parameters
    ----------
    known : sequence of dict
        Rows that have both.
    condition, measure : str
        Columns.

    Returns
    -------
    bool or None
        None where one of them has no interval.
    """
    ends = (min(known, key=lambda row: row[condition]), max(known, key=lambda row: row[condition]))
    (low, high), (other_low, other_high) = (
        (row.get(f"{measure}_low"), row.get(f"{measure}_high")) for row in ends
    )
    if low is None or high is None or other_low is None or other_high is None:
        return None
    return bool(high < other_low or other_high < low)


def _holm(found: Sequence[Trend]) -> list[Trend]:
    """Correct the probabilities of all trends for their number (Holm 1979)."""
    tested = [k for k, trend in enumerate(found) if trend.recordings >= FEWEST]
    order = sorted(tested, key=lambda k: found[k].p_value)
    corrected, largest = list(found), 0.0
    for place, k in enumerate(order):
        largest = max(largest, min(1.0, found[k].p_value * (len(tested) - place)))
        corrected[k] = replace(found[k], p_value=largest)
    return corrected


def _is_number(value: object) -> bool:
    """Whether a cell holds a finite number."""
    return isinstance(value, (int, float)) and math.isfinite(value)


def columns_of(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Columns of all rows, in the order in which they first appear; remarks and reason last."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    last = [name for name in ("summary", "remarks", "reason") if name in names]
    return [name for name in names if name not in last] + last
