"""Making a case: a recording, an unseen programme on the same specimen, and the truth."""

from __future__ import annotations

import hashlib
import pathlib
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.bench import Answer, Bench
from cyclosweep_challenge.second_generator.drive import Specimen, draw_specimen
from cyclosweep_challenge.second_generator.laws.catalogue import EITHER_SIGN
from cyclosweep_challenge.second_generator.laws.law import Cause, Law
from cyclosweep_challenge.second_generator.laws.strangers import STRANGERS
from cyclosweep_challenge.second_generator.path import SMALLEST, Path, make_path
from cyclosweep_challenge.second_generator.reach import (
    CannotShowError,
    Made,
    first_rows,
    measured,
    reach,
)
from cyclosweep_challenge.second_generator.recipes import Recipe, draw_recipe
from cyclosweep_challenge.second_generator.sensor import Sensor
from cyclosweep_challenge.second_generator.truth import add_oracle, forecast, truth_of

Array = NDArray[np.float64]

ATTEMPTS, PATIENCE = 60, 10
"""Draws for a case at most, and draws after which another cause has its turn."""
FIRST_SHARE, FIRST_TWIST = 0.01, 0.01
"""First guess of a size: share of the torque, or part of the twist at the rated torque [-]."""
POSITIONS = 9
"""Mesh positions of a rich programme: more than the terms of a sum of few orders."""
REFERENCE_TWIST_DEG = 19.8
"""Elastic twist of ``reference-87`` at its rated torque [deg]."""


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

    def write(self, folder: str | pathlib.Path, *, program: bool = True) -> pathlib.Path:
        """Write recording, its TOML, the programme and a drive file; no answer among them."""
        target = pathlib.Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        self.recording.write_csv(target / "recording.csv")
        side = f'side = "{self.specimen.side}"\n'
        text = side + f'drive = "{self.specimen.drive}"\n'
        text += f"angle_resolution_deg = {self.resolution_deg:g}\n"
        if "pole_ripple" in self.truth["aliens"]:
            text += 'torque_from = "motor-current"\n'
        (target / "recording.toml").write_text(text)
        if program:
            self.program.write_csv(target / "program.csv")
            # The model that predicts knows its drive; the programme needs no drive file beside it.
            (target / "program.toml").write_text(side)
        if self.specimen.drive_file:
            (target / self.specimen.drive).write_text(self.specimen.drive_file)
        return target


def _frame(
    made: Made,
    seen: NDArray[np.bool_],
    columns: frozenset[str],
    angle_deg: Array | None,
    torque_error: Array | float = 0.0,
) -> pl.DataFrame:
    """Canonical table of the rows that are seen; the error of the torque is in rated torques."""
    path = made.bench.path
    table: dict[str, Any] = {}
    if "clock" in columns:
        table["time_s"] = path.time_s[seen].round(3)
    table["torque_nm"] = ((path.load[seen] + torque_error) * made.bench.specimen.rated_nm).round(6)
    if angle_deg is not None:
        table["angle_deg"] = angle_deg.round(7)
    table["run"] = path.run[seen]
    if "crank" in columns:
        table["crank_deg"] = path.crank_deg[seen].round(3)
    if "temperature" in columns:
        table["temperature_c"] = path.temperature_c[seen].round(3)
    return pl.DataFrame(table)


def set_up(
    recipe: Recipe, seed: tuple[int, ...]
) -> tuple[list[np.random.Generator], Bench, Bench, list[Cause], Sensor]:
    """Sources of chance, both programmes on their bench, causes at a first size, the sensor."""
    streams = np.random.default_rng(seed).spawn(6)
    specimen = draw_specimen(streams[0], other=recipe.other_drive)
    top = float(streams[1].uniform(2.0, 4.5))
    positions = np.asarray(
        np.round(np.sort(streams[1].uniform(0.0, 360.0, POSITIONS)), 1), dtype=float
    )
    if recipe.programme != "rich":
        positions = positions[:1]
    smallest = 0.0 if recipe.play_readings else SMALLEST
    path = make_path(recipe.programme, streams[1], recipe.rows, top, positions, smallest=smallest)
    later_rows = min(recipe.rows, 1500)
    later = make_path(recipe.programme, streams[2], later_rows, top, positions, again=True)
    bench, second = Bench(specimen, path, top), Bench(specimen, later, top)
    causes = [_draw_cause(law, recipe, bench, streams[3]) for law in recipe.laws]
    scale = specimen.twist_deg / REFERENCE_TWIST_DEG if recipe.other_drive else 1.0
    return streams, bench, second, causes, recipe.sensor.scaled(scale)


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
    streams, bench, second, causes, sensor = set_up(recipe, seed)
    specimen, path = bench.specimen, bench.path
    causes, sensor, made, sizes = reach(replace(recipe, sensor=sensor), bench, causes)
    unseen = measured(second, causes)
    kept = made.seen | recipe.play_readings
    clean = made.answer.angle_deg[kept]
    read = sensor.read(clean + sensor.errors(first_rows(path.run[kept]), streams[4]))
    torque_deg = sensor.torque_errors(len(clean), streams[4])
    later_clean = unseen.answer.angle_deg[unseen.seen]
    later_read = sensor.read(later_clean + sensor.errors(unseen.starts(), streams[5]))
    truth = truth_of(recipe, specimen, causes, sensor, made, sizes)
    # At the torque that is read, the true angle is another one.
    against_torque = read - torque_deg
    add_oracle(truth["causes"], made, sensor, against_torque[made.seen[kept]])
    truth |= forecast(causes, sensor, made, unseen, against_torque[made.seen[kept]])
    truth["seed"] = list(seed)
    truth["noise_rms_deg"] = float(np.sqrt(np.mean((against_torque - clean) ** 2)))
    truth["held_out_noise_rms_deg"] = float(np.sqrt(np.mean((later_read - later_clean) ** 2)))
    return Case(
        recording=_frame(made, kept, recipe.columns, read, torque_deg / specimen.twist_deg),
        program=_frame(unseen, unseen.seen, recipe.columns, None),
        clean_deg=clean,
        held_out_clean_deg=later_clean,
        held_out_read_deg=later_read,
        specimen=specimen,
        resolution_deg=sensor.resolution_deg,
        truth=truth,
    )


def _draw_cause(law: Law, recipe: Recipe, bench: Bench, rng: np.random.Generator) -> Cause:
    """Draw a law's shape, sign and first size."""
    shape = law.draw(rng, bench.top, float(bench.path.time_s[-1]))
    sign = float(rng.choice([-1.0, 1.0])) if law.effect in EITHER_SIGN | set(STRANGERS) else 1.0
    size = FIRST_SHARE if law.adds is None else sign * FIRST_TWIST * bench.specimen.twist_deg
    if recipe.share and law is recipe.laws[0]:
        size = recipe.share
    return Cause(law, size, shape)


def show_one(
    law: Law, d: float, seed: tuple[int, ...], rows: int = 3000
) -> tuple[Specimen, Path, Answer, Array, Array]:
    """Show one law alone on the reference drive under a rich programme.

    Parameters
    ----------
    law : Law
        Law to show.
    d : float
        Wanted visibility [-].
    seed : tuple of int
        Determines specimen, programme and shape.
    rows : int
        Readings wanted.

    Returns
    -------
    Specimen
        The drive.
    Path
        The programme, readings with the flanks in contact alone.
    Answer
        Noise-free angle with the law at work.
    signature : array, shape (N,)
        What the law adds [deg].
    free : array, shape (N, 3)
        Tangents of the baseline.

    Raises
    ------
    CannotShowError
        If the law cannot have the wanted visibility here.
    """
    columns = frozenset({"clock", "crank", "temperature"})
    sensor = Sensor(0.2)
    recipe = Recipe("single", (law,), (d,), 0.0, "rich", rows, columns, sensor, False)
    _, bench, _, causes, _ = set_up(recipe, seed)
    _, _, made, _ = reach(recipe, bench, causes)
    keep, path = made.seen, bench.path
    seen = Path(*(getattr(path, name)[keep] for name in path.__dataclass_fields__))
    answer = Answer(*(getattr(made.answer, n)[keep] for n in made.answer.__dataclass_fields__))
    return bench.specimen, seen, answer, made.signatures[:, 0], made.free[0]


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
        turn = number + 5 * (attempt // PATIENCE)
        recipe = draw_recipe(tier, turn, rng, rows, REFERENCE_TWIST_DEG)
        try:
            return make_case(recipe, (*key, 2))
        except CannotShowError as error:
            last = error
    raise CannotShowError(f"{tier} {number} of seed {seed}: {last}")
