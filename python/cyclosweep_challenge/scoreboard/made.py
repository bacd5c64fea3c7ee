"""Recordings made for the scoreboard: causes at stated sizes on the scoreboard's rig and others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep.simulation.model import EffectValue, Model
from cyclosweep.simulation.simulate import simulate
from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import make_programme
from cyclosweep_challenge.rig.specimen import Specimen
from cyclosweep_challenge.scoreboard.made_effects import SHAPES
from cyclosweep_challenge.scoreboard.made_rig import (
    COMPLIANCE_DEG_PER_NM,
    LEAST_NM,
    PLAY_DEG,
    TOP_NM,
    Balance,
    Course,
    Friction,
    Law,
    balance,
    rich_course,
)
from cyclosweep_challenge.trial.concealment import conceal

Array = NDArray[np.float64]

ROUNDS = 6
"""Rounds in which the friction is scaled to its wanted size; each leaves a few per cent of the
error of the one before."""
DRIVE = "reference-87"


@dataclass(frozen=True)
class Recipe:
    """What is at work in a recording of the scoreboard's rig.

    Attributes
    ----------
    seed : int
        Determines programme, specimen and noise.
    noise_deg : float
        Standard deviation of a reading [deg].
    friction : {"friction_hysteresis", "load_dependent_friction", ""}
        Kind of friction; empty for none.
    law : str
        How friction builds up after a reversal.
    presliding_deg : float
        Angle over which it builds up [deg].
    friction_rms_deg : float
        Size of the friction's twist after a calibration, as rms [deg]; or
    friction_part : float
        Friction at the largest torque over that torque [-].
    added : mapping
        Size of every other effect after a calibration, as rms [deg].
    added_d : mapping
        The same as signal-to-noise: rms times the square root of the readings over the noise [-].
    stiffness_loss : float
        Growth of the compliance from the first run to the last [-]; not zero where the drive
        changes while it is tested.
    """

    seed: int
    noise_deg: float = 0.05
    friction: str = ""
    law: Law = "dahl"
    presliding_deg: float = 2.0
    friction_rms_deg: float = 0.0
    friction_part: float = 0.0
    added: Mapping[str, float] = field(default_factory=dict)
    added_d: Mapping[str, float] = field(default_factory=dict)
    stiffness_loss: float = 0.0


def left_over(course: Course, angle_deg: Array) -> Array:
    """Part of an angle that a free stiffness, play and datum do not explain [deg]."""
    columns = np.column_stack(
        [np.ones_like(course.torque_nm), np.sign(course.torque_nm), course.torque_nm]
    )
    return np.asarray(angle_deg - columns @ np.linalg.lstsq(columns, angle_deg)[0])


def _rms(course: Course, angle_deg: Array) -> float:
    """Size of an angle after a calibration, as rms [deg]."""
    return float(np.sqrt(np.mean(left_over(course, angle_deg) ** 2)))


def make(recipe: Recipe) -> Recording:
    """Make a recording of the scoreboard's rig.

    Parameters
    ----------
    recipe : Recipe
        What is at work.

    Returns
    -------
    Recording
        Readings on the loaded flanks, with clock, run, position and temperature.
    """
    rng = np.random.default_rng(recipe.seed)
    course = rich_course(rng)
    compliance = COMPLIANCE_DEG_PER_NM * float(rng.uniform(0.9, 1.1))
    play = PLAY_DEG * float(rng.uniform(0.95, 1.05))
    datum = float(rng.normal())
    run = course.run - course.run[0]
    slope = compliance * (1.0 + recipe.stiffness_loss * run / run[-1])
    at = _with_friction(recipe, course, slope, play)
    keep = at.on_flank & (np.abs(course.torque_nm) > LEAST_NM)
    seen = course.take(keep)
    angle = at.angle_deg + datum
    wanted = dict(recipe.added)
    for name, d in recipe.added_d.items():
        wanted[name] = d * recipe.noise_deg / float(np.sqrt(keep.sum()))
    for name, rms in wanted.items():
        shape = SHAPES[name](course, at, rng)
        angle = angle + shape * rms / _rms(seen, shape[keep])
    read = angle[keep] + recipe.noise_deg * rng.standard_normal(int(keep.sum()))
    return Recording.from_arrays(
        seen.torque_nm,
        read,
        time_s=seen.time_s,
        run=seen.run,
        crank_deg=seen.crank_deg,
        temperature_c=seen.temperature_c,
        name="made",
        drive=DRIVE,
    )


def _with_friction(recipe: Recipe, course: Course, slope: Array, play_deg: float) -> Balance:
    """Solve the drive with friction of the wanted size."""
    plain = Friction(recipe.law, recipe.presliding_deg)
    if not recipe.friction:
        return balance(course, plain, compliance=slope, play_deg=play_deg)
    loaded = recipe.friction == "load_dependent_friction"

    def solved(part: float) -> Balance:
        limited = (
            replace(plain, share=part) if loaded else replace(plain, constant_nm=part * TOP_NM)
        )
        return balance(course, limited, compliance=slope, play_deg=play_deg)

    if recipe.friction_part:
        return solved(recipe.friction_part)
    part = recipe.friction_rms_deg / (float(slope.mean()) * TOP_NM)
    at = solved(part)
    for _ in range(ROUNDS):
        keep = at.on_flank & (np.abs(course.torque_nm) > LEAST_NM)
        free = slope * course.torque_nm + np.sign(course.torque_nm) * play_deg
        part *= recipe.friction_rms_deg / _rms(course.take(keep), (at.angle_deg - free)[keep])
        at = solved(part)
    return at


def correlated(seed: int, effect: str, d: float, autocorrelation: float) -> Recording:
    """Make a recording of the challenge's rig under noise of one autocorrelation.

    Parameters
    ----------
    seed : int
        Determines everything.
    effect : str
        Effect at work; empty for none.
    d : float
        Its signal-to-noise ratio under this noise [-].
    autocorrelation : float
        Correlation of neighbouring readings of a run [-].
    """
    streams = np.random.default_rng(seed).spawn(4)
    specimen = Specimen.draw(streams[0])
    programme = make_programme("rich", streams[1], 3000)
    law = Noise("ar", 0.2, autocorrelation)
    lost = np.zeros(len(programme), dtype=bool)
    effects = [effect] if effect else []
    count = len(effects)
    found = conceal(specimen, programme, law, effects, [d] * count, [1.0] * count, lost, {})
    seen = programme.take(found.seen)
    clean = found.response.angle_deg[found.seen]
    read = clean + law.errors(seen, specimen.compliance_deg_per_nm, streams[2])
    return Recording.from_arrays(
        found.response.shown_torque_nm[found.seen],
        read,
        time_s=seen.time_s,
        run=seen.run,
        crank_deg=seen.crank_deg,
        temperature_c=seen.temperature_c,
        name="correlated",
        drive=DRIVE,
    )


LONG_RUNS = 8
"""Loops of the long recording."""
LONG_FRICTION_NM = 0.15 / COMPLIANCE_DEG_PER_NM
"""Friction torque that makes a loop of 0.15 deg on each side [N m]."""


@lru_cache(maxsize=1)
def _long(rows: int, noise_deg: float) -> tuple[Array, Array, Array, NDArray[np.int64]]:
    """Clock, torque, angle and run of a long recording by the library's own simulation."""
    each = rows // LONG_RUNS
    corners = (0.0, 1.0, 3.0, 4.0, 4.5, 4.8, 5.0)
    levels = (0.02, 1.0, -1.0, 0.02, 0.6, 0.3, 0.5)
    sizes = (1.0, 0.8, 1.0, 0.5, 0.9, 0.6, 1.0, 0.7)
    phase = np.linspace(0.0, 5.0, each, endpoint=False)
    torque = np.concatenate(
        [size * TOP_NM * np.interp(phase, corners, levels) for size in sizes[:LONG_RUNS]]
    )
    time = np.arange(torque.size) * (4000.0 / torque.size)
    run: NDArray[np.int64] = np.repeat(np.arange(1, LONG_RUNS + 1, dtype=np.int64), each)
    shape = {"slip_deg": 2.0, "scatter": 0.6}
    friction = EffectValue("friction_hysteresis", shape, (LONG_FRICTION_NM,))
    model = Model(COMPLIANCE_DEG_PER_NM * 1.03, PLAY_DEG, 0.4, effects=(friction,))
    programme = Recording.from_arrays(torque, time_s=time, run=run, drive=DRIVE)
    angle = simulate(model, programme).angle_deg
    assert angle is not None
    noise = noise_deg * np.random.default_rng(186).standard_normal(torque.size)
    return np.asarray(time), np.asarray(torque), np.asarray(angle + noise), run


def long_recording(rows: int, every: int = 1, noise_deg: float = 0.05) -> Recording:
    """Make a long recording by the library's own simulation, or every so many-th row of it.

    Parameters
    ----------
    rows : int
        Rows of the whole.
    every : int
        Keep every so many-th of them.
    noise_deg : float
        Standard deviation of a reading [deg].
    """
    time, torque, angle, run = _long(rows, noise_deg)
    keep = np.arange(torque.size) % every == 0
    keep &= np.abs(torque) > LEAST_NM
    return Recording.from_arrays(
        torque[keep], angle[keep], time_s=time[keep], run=run[keep], name="long", drive=DRIVE
    )
