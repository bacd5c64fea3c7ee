"""The answer of a case: sizes of its causes, and what can be forecast of the unseen programme."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.drive import Specimen
from cyclosweep_challenge.second_generator.laws.law import Cause
from cyclosweep_challenge.second_generator.laws.strangers import STRANGERS
from cyclosweep_challenge.second_generator.reach import Made
from cyclosweep_challenge.second_generator.recipes import Recipe
from cyclosweep_challenge.second_generator.sensor import Sensor
from cyclosweep_challenge.second_generator.visibility import Size, tangents, without

Array = NDArray[np.float64]

SECOND = 0.01
"""Part of the dominant visibility above which a second effect ought to be named [-]."""


def truth_of(
    recipe: Recipe,
    specimen: Specimen,
    causes: list[Cause],
    sensor: Sensor,
    made: Made,
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
        "readings": int(len(made.seen) if recipe.play_readings else made.seen.sum()),
        "readings_in_play": int((~made.seen).sum()) if recipe.play_readings else 0,
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


def add_oracle(entries: list[dict[str, Any]], made: Made, sensor: Sensor, read_deg: Array) -> None:
    """Add to every cause the statistic of a test that knows its signature.

    It is standard normal without the cause and has the mean ``d`` with it, calibration and the
    other causes' sizes being free.

    Parameters
    ----------
    entries : list of dict
        Causes of the answer, in the order of the signatures.
    made : Made
        Causes on the recording's programme.
    sensor : Sensor
        True noise.
    read_deg : array, shape (N,)
        Readings with the flanks in contact [deg].
    """
    starts = made.starts()
    clean = made.answer.angle_deg[made.seen]
    for k, entry in enumerate(entries):
        signature = made.signatures[:, [k]]
        error = (read_deg - clean)[:, None] + signature
        others = np.delete(made.signatures, k, axis=1)
        white = sensor.whitened(np.hstack([signature, error, made.free[k], others]), starts)
        way = without(white[:, :1], white[:, 2:])[:, 0]
        entry["oracle_z"] = float(way @ white[:, 1] / np.linalg.norm(way))


def forecast(
    causes: list[Cause], sensor: Sensor, made: Made, unseen: Made, read: Array
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
        "held_out_removed_by_truth": max(0.0, 1.0 - own / calibrated) if causes else 0.0,
    }
