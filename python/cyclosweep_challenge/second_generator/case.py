"""Making a case: causes at the wanted visibility, a recording, an unseen programme, the truth."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path as File
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.bench import Answer, Bench, in_balance
from cyclosweep_challenge.second_generator.drive import Specimen, draw_specimen
from cyclosweep_challenge.second_generator.laws.catalogue import EITHER_SIGN
from cyclosweep_challenge.second_generator.laws.law import Cause
from cyclosweep_challenge.second_generator.laws.strangers import STRANGERS
from cyclosweep_challenge.second_generator.path import make_path
from cyclosweep_challenge.second_generator.recipes import Recipe, draw_recipe
from cyclosweep_challenge.second_generator.sensor import Sensor
from cyclosweep_challenge.second_generator.visibility import Size, size_of, tangents, without

Array = NDArray[np.float64]

TOLERANCE = 0.01
"""Relative error of the visibility that is reached."""
ROUNDS = 12
ATTEMPTS = 30
LARGEST_SHARE = 0.3
"""Share of the largest torque that friction or drag may take at most [-]."""
LARGEST_TWIST = 0.5
"""Rms of a cause over the twist at the largest torque, at most [-]."""
FIRST_SHARE, FIRST_TWIST = 0.01, 0.01
"""First guess of a size: share of the torque, or part of the twist at the rated torque [-]."""
SECOND = 0.01
"""Part of the dominant visibility above which a second effect ought to be named [-]."""
REFERENCE_TWIST_DEG = 19.8
"""Elastic twist of ``reference-87`` at its rated torque [deg]."""
SEPARATE, SEPARATE_D = 0.25, 8.0
"""Least part of a cause's visibility that the other causes leave, and least value of it [-]."""


class CannotShowError(ValueError):
    """The cause cannot have the wanted visibility on this specimen and programme."""


@dataclass(frozen=True)
class Case:
    """A recording, an unseen programme on the same specimen, and the truth.

    Attributes
    ----------
    recording, program : polars.DataFrame
        Canonical columns; the programme has no angle.
    clean_deg, held_out_clean_deg, held_out_read_deg : array
        True angle of the recording, true and read angle of the programme [deg].
    specimen : Specimen
        The drive.
    resolution_deg : float
        Division of the dial [deg].
    truth : dict
        The answer.
    """

    recording: pl.DataFrame
    program: pl.DataFrame
    clean_deg: Array
    held_out_clean_deg: Array
    held_out_read_deg: Array
    specimen: Specimen
    resolution_deg: float
    truth: dict[str, Any]

    def write(self, folder: str | File, *, program: bool = True) -> File:
        """Write recording, its TOML, the programme and a drive file; no answer among them."""
        target = File(folder)
        target.mkdir(parents=True, exist_ok=True)
        self.recording.write_csv(target / "recording.csv")
        head = f'side = "{self.specimen.side}"\ndrive = "{self.specimen.drive}"\n'
        text = head + f"angle_resolution_deg = {self.resolution_deg:g}\n"
        (target / "recording.toml").write_text(text)
        if program:
            self.program.write_csv(target / "program.csv")
            (target / "program.toml").write_text(head)
        if self.specimen.drive_file:
            (target / self.specimen.drive).write_text(self.specimen.drive_file)
        return target


@dataclass(frozen=True)
class _Made:
    """Causes on one programme: answer with all of them and each one's signature."""

    bench: Bench
    answer: Answer
    seen: NDArray[np.bool_]
    signatures: Array
    free: tuple[Array, ...]

    def starts(self) -> NDArray[np.bool_]:
        run = self.bench.path.run[self.seen]
        return np.asarray(np.diff(run, prepend=run[0] - 1) != 0)


def _make(bench: Bench, causes: list[Cause]) -> _Made:
    """Measure with all causes and with each of them taken out, on the same side of the play."""
    answer = bench.measure(causes)
    seen = answer.side != 0.0
    if seen.sum() < max(8, 0.5 * len(seen)):
        raise CannotShowError("most readings would fall into the play")
    columns, free = [], []
    for cause in causes:
        rest = [other for other in causes if other is not cause]
        bare = bench.measure(rest, answer.side if in_balance(cause) else None)
        columns.append((answer.angle_deg - bare.angle_deg)[seen])
        load = bench.path.load if in_balance(cause) else answer.twist
        free.append(tangents(answer.side[seen], load[seen]))
    signatures = np.column_stack(columns) if columns else np.zeros((int(seen.sum()), 0))
    return _Made(bench, answer, seen, signatures, tuple(free))


def _sizes(made: _Made, sensor: Sensor) -> list[Size]:
    """Size of every cause."""
    starts, count = made.starts(), made.signatures.shape[1]
    return [
        size_of(
            made.signatures[:, k],
            made.free[k],
            made.signatures[:, [j for j in range(count) if j != k]],
            sensor,
            starts,
        )
        for k in range(count)
    ]


def _reach(
    recipe: Recipe, bench: Bench, causes: list[Cause]
) -> tuple[list[Cause], Sensor, _Made, list[Size]]:
    """Change sizes, or the noise under a friction of given share, until d is as wanted."""
    sensor, wanted = recipe.sensor, recipe.d
    for _ in range(ROUNDS):
        made = _make(bench, causes)
        sizes = _sizes(made, sensor)
        if recipe.share:
            factor = sizes[0].d / wanted[0]
            sensor = replace(sensor, sigma_deg=sensor.sigma_deg * factor)
            sizes = _sizes(made, sensor)
        errors = [abs(s.d / w - 1.0) for s, w in zip(sizes, wanted, strict=True)]
        if max(errors, default=0.0) <= TOLERANCE:
            _check(bench, causes, sizes)
            return causes, sensor, made, sizes
        steps = [
            np.clip(w / max(s.d, 1e-9), 0.02, 50.0) for s, w in zip(sizes, wanted, strict=True)
        ]
        if recipe.share:
            steps[0] = 1.0
        causes = [replace(c, size=c.size * float(f)) for c, f in zip(causes, steps, strict=True)]
        if any(in_balance(c) and c.size > 2.0 * LARGEST_SHARE for c in causes):
            raise CannotShowError(
                "friction would have to take more of the torque than any drive shows"
            )
    raise CannotShowError("no size gives the wanted visibility")


def _check(bench: Bench, causes: list[Cause], sizes: list[Size]) -> None:
    """Refuse sizes that no bench shows."""
    twist = bench.specimen.twist_deg * bench.top
    for cause, size in zip(causes, sizes, strict=True):
        if in_balance(cause) and cause.size > LARGEST_SHARE:
            raise CannotShowError(
                "friction would have to take more of the torque than any drive shows"
            )
        if size.d_apart < max(SEPARATE * size.d, min(SEPARATE_D, 0.9 * size.d)):
            raise CannotShowError("another cause looks the same on this programme")
        if size.rms_deg > LARGEST_TWIST * twist:
            raise CannotShowError("a cause would have to be larger than any bench shows")


def _frame(made: _Made, columns: frozenset[str], angle_deg: Array | None) -> pl.DataFrame:
    """Canonical table of what was recorded."""
    path, seen = made.bench.path, made.seen
    table: dict[str, Any] = {}
    if "clock" in columns:
        table["time_s"] = path.time_s[seen].round(3)
    table["torque_nm"] = (path.load[seen] * made.bench.specimen.rated_nm).round(6)
    if angle_deg is not None:
        table["angle_deg"] = angle_deg.round(7)
    table["run"] = path.run[seen]
    if "crank" in columns:
        table["crank_deg"] = path.crank_deg[seen].round(3)
    if "temperature" in columns:
        table["temperature_c"] = path.temperature_c[seen].round(3)
    return pl.DataFrame(table)


def make_case(recipe: Recipe, seed: tuple[int, ...]) -> Case:
    """Make the case of a recipe.

    Parameters
    ----------
    recipe : Recipe
        What is wanted.
    seed : tuple of int
        Determines specimen, programmes, shapes of the laws, signs and noise.

    Raises
    ------
    CannotShowError
        If a cause cannot have the wanted visibility here.
    """
    streams = np.random.default_rng(seed).spawn(6)
    specimen = draw_specimen(streams[0], other=recipe.other_drive)
    top = float(streams[1].uniform(2.0, 4.5))
    positions = np.asarray(np.round(np.sort(streams[1].uniform(0.0, 360.0, 7)), 1), dtype=float)
    if recipe.programme != "rich":
        positions = positions[:1]
    path = make_path(recipe.programme, streams[1], recipe.rows, top, positions)
    later_rows = min(recipe.rows, 1500)
    later = make_path(recipe.programme, streams[2], later_rows, top, positions, again=True)
    bench, second = Bench(specimen, path, top), Bench(specimen, later, top)
    causes = [_draw_cause(law, recipe, bench, streams[3]) for law in recipe.laws]
    scale = specimen.twist_deg / REFERENCE_TWIST_DEG
    asked = replace(recipe.sensor, sigma_deg=recipe.sensor.sigma_deg * scale)
    causes, sensor, made, sizes = _reach(replace(recipe, sensor=asked), bench, causes)
    unseen = _make(second, causes)
    clean = made.answer.angle_deg[made.seen]
    read = sensor.read(clean + sensor.errors(made.starts(), streams[4]))
    later_clean = unseen.answer.angle_deg[unseen.seen]
    later_read = sensor.read(later_clean + sensor.errors(unseen.starts(), streams[5]))
    truth = _truth(recipe, specimen, causes, sensor, made, sizes)
    truth |= _forecast(causes, sensor, made, unseen, read)
    truth["seed"] = list(seed)
    truth["noise_rms_deg"] = float(np.sqrt(np.mean((read - clean) ** 2)))
    truth["held_out_noise_rms_deg"] = float(np.sqrt(np.mean((later_read - later_clean) ** 2)))
    return Case(
        recording=_frame(made, recipe.columns, read),
        program=_frame(unseen, recipe.columns, None),
        clean_deg=clean,
        held_out_clean_deg=later_clean,
        held_out_read_deg=later_read,
        specimen=specimen,
        resolution_deg=sensor.resolution_deg,
        truth=truth,
    )


def _draw_cause(law: Any, recipe: Recipe, bench: Bench, rng: np.random.Generator) -> Cause:
    """Draw a law's shape, sign and first size."""
    shape = law.draw(rng, bench.top, float(bench.path.time_s[-1]))
    sign = float(rng.choice([-1.0, 1.0])) if law.effect in EITHER_SIGN | set(STRANGERS) else 1.0
    size = FIRST_SHARE if law.adds is None else sign * FIRST_TWIST * bench.specimen.twist_deg
    if recipe.share and law is recipe.laws[0]:
        size = recipe.share
    return Cause(law, size, shape)


def _truth(
    recipe: Recipe,
    specimen: Specimen,
    causes: list[Cause],
    sensor: Sensor,
    made: _Made,
    sizes: list[Size],
) -> dict[str, Any]:
    """The answer but for the unseen programme."""
    loudest = max((s.d for s in sizes), default=0.0)
    entries = [
        {
            "name": cause.law.effect,
            "kind": "alien" if cause.law.effect in STRANGERS else "effect",
            "law": cause.law.name,
            "amplitude": cause.size,
            "shape": dict(cause.shape),
            "d": size.d_apart,
            "d_alone": size.d,
            "absorbed": 1.0 - size.rms_deg / max(size.raw_rms_deg, 1e-300),
            "rms_deg": size.rms_deg,
            "peak_deg": size.peak_deg,
            "raw_rms_deg": size.raw_rms_deg,
            "raw_peak_deg": size.raw_peak_deg,
            "dominant": size.d == loudest,
            "above_hundredth": size.d >= SECOND * loudest,
            "unpredictable": cause.law.random,
        }
        for cause, size in zip(causes, sizes, strict=True)
    ]
    family = f"ar{sensor.autocorrelation:g}" if sensor.autocorrelation else "white"
    return {
        "generator": "second",
        "tier": recipe.tier,
        "stratum": recipe.stratum,
        "programme": recipe.programme,
        "friction_family": recipe.family,
        "readings": int(made.seen.sum()),
        "columns": sorted(recipe.columns),
        "noise": {"family": family, **vars(sensor)},
        "effects": [e["name"] for e in entries if e["kind"] == "effect"],
        "aliens": [e["name"] for e in entries if e["kind"] == "alien"],
        "aliases": [],
        "causes": entries,
        "calibration": {
            "compliance_deg_per_nm": specimen.compliance_deg_per_nm,
            "free_play_deg": specimen.play_deg,
            "datum_deg": specimen.datum_deg,
        },
    } | ({"removed": recipe.removed} if recipe.removed else {})


def _forecast(
    causes: list[Cause], sensor: Sensor, made: _Made, unseen: _Made, read: Array
) -> dict[str, Any]:
    """What the calibrated baseline and the fitted true model leave on the unseen programme.

    The true model's error is the expected one of a generalised least-squares fit of the baseline
    and of each cause's size, shapes known; causes whose course is chance are left in whole.
    """
    drive_load = made.bench.path.load[made.seen]
    baseline = tangents(made.answer.side[made.seen], drive_load)
    fit = np.linalg.lstsq(baseline, read, rcond=None)[0]
    later = tangents(unseen.answer.side[unseen.seen], unseen.bench.path.load[unseen.seen])
    left = unseen.answer.angle_deg[unseen.seen] - later @ fit
    calibrated = float(np.sqrt(np.mean(left**2)))
    known = np.hstack([tangents(made.answer.side, made.answer.twist)[made.seen], made.signatures])
    there = np.hstack(
        [tangents(unseen.answer.side, unseen.answer.twist)[unseen.seen], unseen.signatures]
    )
    scale = np.maximum(np.linalg.norm(known, axis=0), 1e-300)
    white = sensor.whitened(known / scale, made.starts())
    spread = np.linalg.pinv(white.T @ white, rcond=1e-10)
    course = there / scale
    fitting = float(np.einsum("ij,jk,ik->", course, spread, course) / len(course))
    chance = sum(
        (
            np.mean(without(unseen.signatures[:, [k]], later) ** 2)
            for k, cause in enumerate(causes)
            if cause.law.random
        ),
        start=0.0,
    )
    own = float(np.sqrt(fitting + chance))
    return {
        "held_out_fitting_rms_deg": own,
        "held_out_calibrated_rms_deg": calibrated,
        "held_out_removed_by_truth": 1.0 - own / calibrated if calibrated > 0.0 else 0.0,
    }


def make_numbered(tier: str, number: int, seed: int, rows: int = 3000) -> Case:
    """Make one case of a tier; it is a function of these four values alone.

    Parameters
    ----------
    tier : str
        Tier of ``recipes.TIERS``.
    number : int
        Number of the case within the set.
    seed : int
        Seed of the set.
    rows : int
        Readings wanted.

    Raises
    ------
    CannotShowError
        If no draw can show the causes at the wanted visibility.
    """
    label = int.from_bytes(hashlib.sha256(tier.encode()).digest()[:4], "big")
    last = CannotShowError("no attempt")
    for attempt in range(ATTEMPTS):
        key = (label, seed, number, attempt)
        rng = np.random.default_rng([*key, 1])
        recipe = draw_recipe(tier, number, rng, rows, REFERENCE_TWIST_DEG)
        try:
            return make_case(recipe, (*key, 2))
        except CannotShowError as error:
            last = error
    raise CannotShowError(f"{tier} {number} of seed {seed}: {last}")
