"""Lines of the measured torque ramps of a 3D-printed 13:1 cycloidal drive."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import cyclosweep as cs
from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.diagnosis.series import small_loops_of
from cyclosweep.diagnosis.series_steps import CERTAIN_IN_COMMON
from cyclosweep.recording import Recording
from cyclosweep.recording.metadata import Metadata
from cyclosweep_challenge.measured.loops import FIRST, SECOND, Loops, as_template
from cyclosweep_challenge.measured.run import LOADED_NM, loaded_rms
from cyclosweep_challenge.scoreboard.checks import (
    CONSISTENT,
    FRICTION,
    POSITION,
    figure_at_most,
    names_one_of,
    no_stiffness_to_three_digits,
    says_the_drive_changed,
    verdict_not,
)
from cyclosweep_challenge.scoreboard.line import Check, Line, Summary
from cyclosweep_challenge.scoreboard.outcome import Outcome
from cyclosweep_challenge.scoreboard.preload_series import (
    POSITIONS,
    PRELOADS,
    preload_summaries,
)
from cyclosweep_challenge.scoreboard.shared_order import order_of_others

GROUP = "Printed 13:1 drive"
FOLDER = "cycloidal-13-to-1"
EXAMPLE = Path(__file__).parents[3] / "examples" / "measured-13-to-1"
"""Where the metadata and the drive of these files stand."""
RAMPS = (
    "2024-07-11__15-47-12__torqueramp__base_runin1",
    "2024-07-11__15-51-51__torqueramp__base_runin5",
    "2024-07-12__13-05-47__torqueramp__conic_runin1",
    "2024-07-16__14-12-42__torqueramp__base910_unr_cold5",
)
"""Files of a drive that repeats from ramp to ramp."""
WARM = "2024-07-16__11-55-30__torqueramp__base910_unr_runin1"
"""File of a drive that is warm from running in and changes from ramp to ramp."""
EXCHANGED = "-exchanged"
"""End of the name of a line whose ramps are in each other's place."""
LARGEST_RATIO = 1.6
"""Largest error of a forecast over that of the other ramp as template [-]."""
MEDIAN_RATIO = 1.1
"""The same for the median of all files [-]."""
REPEATS = 0.6
"""Correlation of the remainders of two ramps from which a staircase repeats [-]."""
MOTOR_ORDER = 42.0
"""Order of the staircase in a turn of the motor. The makers speak of motor poles; 42 is the order
at which, and at whose multiples, the spectra of all files together stand out."""
SAME_ORDER = 0.03
"""Share of it by which an order may differ."""
CELL_DEG = 0.1
"""Width of the cells of angle in which the remainders of two ramps are compared [deg]."""
FEWEST_CELLS = 12
"""Cells that both ramps pass below which no correlation is stated."""
SOURCE = "Volbeda, MSc thesis 2024 (measured); the other ramp of the same file"


def loops_of(recording: Recording) -> Loops:
    """Return the ramps of a recording as the challenge's measured loops."""
    assert recording.time_s is not None
    assert recording.angle_deg is not None
    return Loops(
        recording.time_s,
        recording.torque_nm,
        recording.angle_deg,
        np.asarray(recording.run, dtype=np.int64),
        recording.unscored,
    )


def forecast(found: Diagnosis, fitted: int = FIRST, ahead: int = SECOND) -> Mapping[str, float]:
    """Forecast one ramp by the model of the other and compare with that other ramp itself.

    Parameters
    ----------
    found : Diagnosis
        Diagnosis of the three ramps, of which one was kept back.
    fitted, ahead : int
        Numbers of the ramp that was fitted and of the one that was kept back.

    Returns
    -------
    mapping
        ``forecast_deg``, ``floor_deg`` and their ratio ``over_floor``, on loaded readings;
        ``repeats``, the correlation of what its named effects leave on the two ramps, and
        ``repeating_deg``, how large what repeats is.
    """
    loops = loops_of(found.recording)
    template = np.full(loops.angle_deg.size, np.nan)
    template[loops.run == ahead] = as_template(loops.only(fitted), loops.only(ahead))
    floor = loaded_rms(template - loops.angle_deg, loops, ahead, free_datum=False)
    if found.model is None:
        return {"floor_deg": floor}
    error = loaded_rms(_error(found.model, found, loops), loops, ahead, free_datum=False)
    # A table of what the effects miss is no name: what repeats beside the names is asked.
    named = replace(found.model, model_error=None)
    correlation, size = _repeating(loops, _error(named, found, loops))
    return {
        "forecast_deg": error,
        "floor_deg": floor,
        "over_floor": error / floor if floor > 0.0 else math.nan,
        "repeats": correlation,
        "repeating_deg": size,
    }


def _error(model: cs.Model, found: Diagnosis, loops: Loops) -> NDArray[np.float64]:
    """Simulated less measured angle of all readings [deg]."""
    predicted = cs.simulate(model, found.recording).angle_deg
    assert predicted is not None
    return predicted - loops.angle_deg


def _repeating(loops: Loops, error: NDArray[np.float64]) -> tuple[float, float]:
    """Correlation of the errors of both ramps at equal angle and direction, and their common rms.

    The mean of each direction and side is no staircase and is taken out.
    """
    rising = np.gradient(loops.torque_nm) >= 0.0
    cell = np.floor(loops.angle_deg / CELL_DEG).astype(np.int64)
    kind = 2 * rising.astype(np.int64) + (loops.torque_nm > 0.0).astype(np.int64)
    loaded = loops.counts & (np.abs(loops.torque_nm) >= LOADED_NM) & np.isfinite(error)
    means: list[dict[tuple[int, int], float]] = []
    for ramp in (FIRST, SECOND):
        here = loaded & (loops.run == ramp)
        sums: dict[tuple[int, int], list[float]] = {}
        for key, value in zip(
            zip(kind[here].tolist(), cell[here].tolist(), strict=True),
            error[here].tolist(),
            strict=True,
        ):
            sums.setdefault(key, []).append(value)
        means.append({key: float(np.mean(values)) for key, values in sums.items()})
    common = sorted(set(means[0]) & set(means[1]))
    if len(common) < FEWEST_CELLS:
        return math.nan, math.nan
    both = np.array([[part[key] for key in common] for part in means])
    kinds = np.array([key[0] for key in common])
    for each in np.unique(kinds):
        both[:, kinds == each] -= both[:, kinds == each].mean(axis=1, keepdims=True)
    product = float(np.mean(both[0] * both[1]))
    spread = float(np.sqrt(np.mean(both[0] ** 2) * np.mean(both[1] ** 2)))
    return product / spread if spread > 0.0 else math.nan, math.sqrt(max(product, 0.0))


def _staircase_named(outcome: Outcome) -> bool:
    """Whether what repeats from ramp to ramp, here or by the diagnosis, is named by position.

    By an effect that goes with the position, by the right order of its steps, or, as a series of
    recordings is diagnosed, by that of the other files, if the clearest order of this one agrees
    with it. One in twelve random orders would agree.
    """
    left = outcome.words.partition("|")[0]
    repeats = outcome.figures.get("repeats", 0.0) >= REPEATS or "staircase" in left
    stated = re.search(r"order ([\d.]+) of a turn of the input", left)
    if stated is not None and _is_of_motor(float(stated[1])):
        return True
    if _is_of_motor(outcome.figures.get("others_order", 0.0)):
        certain = outcome.figures["others_chance"] <= CERTAIN_IN_COMMON
        away = abs(outcome.figures.get("own_order", 0.0) - outcome.figures["others_order"])
        if certain and away <= outcome.figures["own_apart"]:
            return True
    return not repeats or bool(set(POSITION) & set(outcome.named))


def _is_of_motor(order: float) -> bool:
    """Whether an order is that of the motor."""
    return abs(order / MOTOR_ORDER - 1.0) <= SAME_ORDER


def _line(name: str, file: str, asks: str, answer: str, checks: tuple[Check, ...]) -> Line:
    """Line of one file."""
    read = partial(_read, file=file)
    return Line(name, GROUP, asks, answer, SOURCE, read, checks, partial(_figures, name=name), file)


def _read(recordings: Path, file: str) -> Recording:
    """Read a file as the example does."""
    return Recording.read(recordings / file, EXAMPLE / "recording.toml")


def _figures(
    found: Diagnosis, recordings: Path, name: str, fitted: int = FIRST, ahead: int = SECOND
) -> Mapping[str, float]:
    """Forecast, order of the steps, and what is read of the loop.

    Parameters
    ----------
    found : Diagnosis
        Diagnosis of the three ramps, of which one was kept back.
    recordings : pathlib.Path
        Shared folder of recordings.
    name : str
        Name of the line.
    fitted, ahead : int
        Numbers of the ramp that was fitted and of the one that was kept back.
    """
    read = found.answer.play_and_stiffness
    friction = read.friction_nm if read else None
    return {
        **forecast(found, fitted, ahead),
        **order_of_others(recordings, {line.name: line.recording for line in _all_lines()}, name),
        "loop_friction_nm": math.nan if friction is None else friction.estimate,
        "lost_motion_deg": _lost_motion(recordings, name),
    }


def _lost_motion(recordings: Path, name: str) -> float:
    """Lost motion of the small ramps of a file, by the makers' test of the play [deg]."""
    file = next(line.file for line in _all_lines() if line.name == name)
    meta = EXAMPLE / "preload-series.toml"
    found = small_loops_of(recordings / file, Metadata.read(meta), meta)
    return float(found["lost_motion_deg"])


@cache
def _all_lines() -> tuple[Line, ...]:
    """Lines of all files."""
    return tuple(printed_drive_lines())


STEADY = (
    *CONSISTENT,
    verdict_not("NOTHING_MISSING", "DATA_FAULT"),
    names_one_of(*FRICTION),
    figure_at_most("over_floor", LARGEST_RATIO, "forecast of the other ramp over the floor"),
    Check("a staircase that repeats is named by its position", _staircase_named),
)
STEADY_ANSWER = (
    "Friction is named; the other ramp is forecast about as well as by this ramp itself; a "
    "staircase that repeats is named by the position of mesh and motor, by this file or by the "
    "order that the steps of all other files share, if its own clearest order agrees."
)


def printed_drive_lines() -> list[Line]:
    """Lines of all files of the printed drive."""
    lines = [
        _line(
            file.rpartition("__")[2],
            f"{FOLDER}/{file}.csv.gz",
            "Ramp 101 is fitted, ramp 102 forecast; torque from motor current.",
            STEADY_ANSWER,
            STEADY,
        )
        for file in RAMPS
    ]
    lines.append(
        _line(
            WARM.rpartition("__")[2],
            f"{FOLDER}/{WARM}.csv.gz",
            "The same of a drive warm from running in, which changes from ramp to ramp.",
            "The drive changed from ramp to ramp; no stiffness to three digits.",
            (
                *CONSISTENT,
                verdict_not("NOTHING_MISSING", "IDENTIFIED"),
                says_the_drive_changed(),
                no_stiffness_to_three_digits(),
                figure_at_most(
                    "over_floor", LARGEST_RATIO, "forecast of the other ramp over the floor"
                ),
            ),
        )
    )
    for step, clocks in PRELOADS.items():
        for position, clock in zip(POSITIONS, clocks, strict=True):
            stem = f"conic_{step}pre{position}"
            lines.append(
                _line(
                    stem,
                    f"{FOLDER}/preload-series/2024-07-12__{clock}__torqueramp__{stem}.csv.gz",
                    f"The conical drive at preload step {step}, position {position}.",
                    STEADY_ANSWER,
                    STEADY,
                )
            )
    return lines


def exchanged_lines() -> list[Line]:
    """Lines of the same files with the ramps in each other's place: 102 is fitted, 101 forecast."""
    return [_exchanged(line) for line in printed_drive_lines()]


def _exchanged(line: Line) -> Line:
    """Line with the ramps in each other's place."""

    def read(recordings: Path) -> Recording:
        return replace(line.recording(recordings), holdout_runs=(FIRST,))

    return replace(
        line,
        name=line.name + EXCHANGED,
        group=f"{GROUP}, ramps exchanged",
        asks=f"{line.asks} Here ramp {SECOND} is fitted, ramp {FIRST} forecast.",
        recording=read,
        figures=partial(_figures, name=line.name, fitted=SECOND, ahead=FIRST),
    )


def _forecasts(outcomes: Mapping[str, Outcome]) -> tuple[bool, str]:
    """Judge the forecasts of all files together."""
    ratios = [o.figures.get("over_floor", math.inf) for o in outcomes.values()]
    median, worst = float(np.median(ratios)), max(ratios)
    return (
        median <= MEDIAN_RATIO and worst <= LARGEST_RATIO,
        f"median {median:.2f}, worst {worst:.2f}",
    )


def all_forecasts(lines: list[Line]) -> Summary:
    """Check over the forecasts of all files, as they are recorded or with the ramps exchanged."""
    return Summary(
        "all-forecasts",
        lines[0].group,
        f"Forecast over the floor, all {len(lines)} files: median at most {MEDIAN_RATIO:g}, "
        f"none above {LARGEST_RATIO:g}.",
        SOURCE,
        tuple(line.name for line in lines),
        _forecasts,
    )


def printed_drive_summaries() -> list[Summary]:
    """Checks over several files of the printed drive."""
    return [all_forecasts(printed_drive_lines()), *preload_summaries(GROUP)]
