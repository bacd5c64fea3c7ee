"""The real drive: measured loops as they are, as a null, with terms removed or effects injected."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cyclosweep_challenge.measured.bench import Bench, Row
from cyclosweep_challenge.measured.loops import (
    FIRST,
    SECOND,
    Loops,
    as_template,
    left_over,
    repeated_null,
    repeats,
    signature,
    with_angle,
)
from cyclosweep_challenge.measured.variants import (
    Variant,
    both_ramps,
    injected_variants,
    null_variants,
    plain_variant,
    shape_rng,
    short_name,
    warm_and_cold,
)
from cyclosweep_challenge.runner.work import Options
from cyclosweep_challenge.scoring.outcome import ALARMS

Array = NDArray[np.float64]

LOADED_NM = 1.0
"""Below this the crossing of the play, where timing looks like angle, is left out [N m]."""
UNSHOWN = frozenset({"thermal_drift", "transmission_error", "phase_dependent_compliance"})
"""Effects that these files cannot show: no temperature, and one mesh position each."""
SIZES_DEG = (0.05, 0.1, 0.2, 0.4)
"""Sizes of injected effects after re-calibration, as rms [deg]."""


def run_measured(
    source: str | Path,
    out: str | Path,
    drive_file: str | Path,
    *,
    sizes_deg: Sequence[float] = SIZES_DEG,
    seed: int = 1,
    options: Options | None = None,
    most_files: int | None = None,
    console: Console | None = None,
) -> list[Row]:
    """Diagnose measured loops, real nulls, loops with one term missing and injected effects.

    Parameters
    ----------
    source : str or pathlib.Path
        Folder with the measured ``*torqueramp*.csv`` or ``.csv.gz`` files.
    out : str or pathlib.Path
        Folder of the run; what is there already is not done again.
    drive_file : str or pathlib.Path
        Drive file of the measured drive.
    sizes_deg : sequence of float
        Sizes of injected effects after re-calibration, as rms [deg].
    seed : int
        Seed of the injected shapes.
    options : Options, optional
        Workers, limits, flags and who diagnoses.
    most_files : int, optional
        Use the first so many files only; the pair of warm and cold belongs to all of them.
    console : rich.console.Console, optional
        Where progress goes; standard error if absent.

    Returns
    -------
    list of Row
        Also in ``measured.json`` of the folder; empty, with nothing written, where the data
        are absent.

    Raises
    ------
    OutOfTimeError
        If the time given in the options is over; a later call goes on.
    """
    files = sorted(p for p in Path(source).glob("*torqueramp*.csv*") if p.is_file())
    if not files:
        return []
    folder = Path(out)
    bench = Bench(
        folder,
        Path(drive_file),
        options or Options(diagnose_flags=("--quick",)),
        console or Console(stderr=True),
    )
    chosen = files[:most_files]
    plain = {f: plain_variant(f, n) for n, f in enumerate(chosen)}
    both = {f: both_ramps(f, n) for n, f in enumerate(chosen)}
    nulls = [v for n, f in enumerate(chosen) for v in null_variants(f, n)]
    laid = [
        v
        for n, f in enumerate(chosen)
        if repeats(repeated_null(plain[f].loops))
        for v in injected_variants(f, n, sizes_deg, seed)
    ]
    mixed = warm_and_cold(files if most_files is None else chosen)
    bench.diagnose([*plain.values(), *both.values(), *nulls, *laid, *mixed])
    rows = [bench.row(v, None) for v in both.values()]
    rows += _predicted(bench, plain)
    rows += [bench.row(v, _silent(bench, v)) for v in nulls]
    rows += _removed(bench, plain)
    rows += _found_again(bench, both, laid, seed)
    rows += [bench.row(v, doubts(bench.diagnosis(v))) for v in mixed]
    content = [asdict(row) for row in rows]
    (folder / "measured.json").write_text(json.dumps(_plain_numbers(content), indent=1))
    return rows


def _plain_numbers(value: Any) -> Any:
    """Return the same data with not-a-number as null."""
    if isinstance(value, dict):
        return {key: _plain_numbers(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain_numbers(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _silent(bench: Bench, variant: Variant) -> bool:
    """Whether a diagnosis was made and raised no alarm."""
    verdict = str(bench.diagnosis(variant).get("verdict", "FAILURE"))
    return verdict not in ALARMS and verdict != "FAILURE"


def doubts(diagnosis: dict[str, Any]) -> bool:
    """Whether a diagnosis of confounded causes says so and names nothing it cannot know.

    That no difference was found would be wrong here, too.
    """
    named = {str(e.get("name")) for e in diagnosis.get("effects") or []}
    return diagnosis.get("verdict") in {"AMBIGUOUS", "UNKNOWN_PHYSICS"} and not named & UNSHOWN


def loaded_rms(error: Array, loops: Loops, ramp: int, *, free_datum: bool) -> float:
    """Error on the loaded readings of a ramp, with the datum free or not [deg]."""
    here = (loops.run == ramp) & loops.counts & np.isfinite(error)
    here &= np.abs(loops.torque_nm) >= LOADED_NM
    if not here.any():
        return math.nan
    part = error[here] - (error[here].mean() if free_datum else 0.0)
    return float(np.sqrt(np.mean(part**2)))


def _predicted(bench: Bench, plain: dict[Path, Variant]) -> list[Row]:
    """Errors on a ramp that was not used, and on another locking position, before and after."""
    asked: list[tuple[str, dict[str, Any] | None, Variant]] = []
    wanted = []
    for file, variant in plain.items():
        others = [f for f in plain if f == file or _other_position(file, f)]
        for other in others:
            later = plain[other]
            name = f"{variant.key}-on-{later.key}"
            asked.append((f"{name}-before", bench.calibrated(variant), later))
            asked.append((f"{name}-after", bench.model(variant), later))
            wanted.append((variant, later))
    angles = bench.predict(asked)
    rows = []
    for k, (variant, later) in enumerate(wanted):
        same, loops = variant.key == later.key, later.loops
        floor = np.full(loops.angle_deg.size, np.nan)
        floor[loops.run == SECOND] = as_template(variant.loops.only(FIRST), loops.only(SECOND))

        def error(angle: Array, loops: Loops = loops, same: bool = same) -> float:
            return loaded_rms(angle - loops.angle_deg, loops, SECOND, free_datum=not same)

        numbers = {
            "before_deg": error(angles[2 * k]),
            "after_deg": error(angles[2 * k + 1]),
            "floor_deg": error(floor),
        }
        row = bench.row(variant, None, **numbers)
        words = "unseen ramp" if same else f"another position: {later.file}"
        rows.append(Row(**{**vars(row), "kind": "predicted", "detail": words}))
    return rows


def _other_position(one: Path, other: Path) -> bool:
    """Whether two files differ in nothing but the locking position, their last digit."""
    a, b = short_name(one), short_name(other)
    return a != b and a[:-1] == b[:-1] and a[-1].isdigit() and b[-1].isdigit()


def _removed(bench: Bench, plain: dict[Path, Variant]) -> list[Row]:
    """Every accepted term taken out of model or library, and whether it comes back.

    A recording that lacks but one term is the measured one with what the accepted model says
    taken away and what it says with that term alone put back: the rest is as measured.
    """
    asked: list[tuple[str, dict[str, Any] | None, Variant]] = []
    terms: list[tuple[Variant, str]] = []
    for variant in plain.values():
        names = bench.named(variant)
        if bench.model(variant) is None or not names:
            continue
        asked.append((f"{variant.key}-all", bench.model(variant), variant))
        for name in ("", *names):
            terms.append((variant, name))
            asked.append((f"{variant.key}-only-{name}", bench.model(variant, (name,)), variant))
    found = {name: angle for (name, _, _), angle in zip(asked, bench.predict(asked), strict=True)}
    single, barred = [], []
    for variant, name in terms:
        change = found[f"{variant.key}-only-{name}"] - found[f"{variant.key}-all"]
        if not np.isfinite(change).all():
            continue
        loops = with_angle(variant.loops, variant.loops.angle_deg + change)
        single.append(
            Variant(
                f"{variant.key}-lacks-{name or 'nothing'}",
                variant.file,
                "one term missing" if name else "no term missing",
                name,
                loops,
                holdout=variant.holdout,
            )
        )
        if name:
            barred.append(
                Variant(
                    f"{variant.key}-without-{name}",
                    variant.file,
                    "term taken out of the library",
                    name,
                    variant.loops,
                    holdout=variant.holdout,
                    without=name,
                )
            )
    bench.diagnose([*single, *barred])
    rows = [bench.row(v, v.detail in bench.named(v) if v.detail else None) for v in single]
    known = {v.file: v for v in plain.values()}
    held = bench.predict([(f"{v.key}-held", bench.model(v), known[v.file]) for v in barred])
    for variant, angle in zip(barred, held, strict=True):
        loops = variant.loops
        error = loaded_rms(angle - loops.angle_deg, loops, SECOND, free_datum=False)
        full = bench.row(known[variant.file], None).rmse_deg
        rows.append(bench.row(variant, None, held_out_deg=error, rmse_with_it_deg=full))
    return rows


def _found_again(
    bench: Bench, both: dict[Path, Variant], laid: Sequence[Variant], seed: int
) -> list[Row]:
    """Rows for injected effects: whether named, and the share that the repaired model contains."""
    reference = {v.file: (n, v) for n, v in enumerate(both.values())}
    asked: list[tuple[str, dict[str, Any] | None, Variant]] = [
        (f"{v.key}-again", bench.model(v), v) for v in [*both.values(), *laid]
    ]
    angle = {name: a for (name, _, _), a in zip(asked, bench.predict(asked), strict=True)}
    rows = []
    for v in laid:
        number, plain = reference[v.file]
        # The conditioning ramp is not fitted, so that what a model says of it does not count.
        fitted, use = v.loops.only(FIRST, SECOND), np.isin(v.loops.run, (FIRST, SECOND))
        laid_on = signature(v.detail, v.loops, shape_rng(seed, number, v.detail))
        shape = left_over(fitted, laid_on[use])
        change = angle[f"{v.key}-again"] - angle[f"{plain.key}-again"]
        there = np.isfinite(change)
        share = math.nan
        if there.all():
            taken = left_over(fitted, change[use])
            share = float(taken @ shape / (shape @ shape) / v.size_deg)
        shown = v.detail in bench.named(plain)
        good = None if shown else v.detail in bench.named(v)
        rows.append(bench.row(v, good, share_taken_up=share))
    return rows
