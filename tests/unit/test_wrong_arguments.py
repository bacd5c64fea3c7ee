"""Every public function takes an argument of the wrong kind for one line of the package's own."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs

DRIVE = cs.Drive.reference_87()
PARTS = DRIVE.replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
SPACE = cs.Space.grid(DRIVE, output_pin_count=[8])
LOAD = cs.Recording.from_arrays([0.0, 5.0, -2.0], [28.0, 41.7, -30.0])
MODEL = cs.Model(2.7, 28.0)
TRAIN = DRIVE.train(load_inertia_kg_m2=5.0)
FRAME = pl.DataFrame({"eccentricity_mm": [0.6]})

WRONG: list[Any] = [
    None, 5, -1, "x", "", [], {}, object(), float("nan"), float("inf"), np.array([1, 2]),
    np.zeros((2, 2)), Path("x"), 3.5, True, b"x", {"a": 1}, ["a"], 10**400, "a\nb",
]  # fmt: skip
LONGEST = 600
"""Characters of a message; the names to choose from take most of them."""

CALLS: dict[str, Callable[[Any, Path], object]] = {
    "Drive.built_in": lambda w, _: cs.Drive.built_in(w),
    "Drive.from_toml": lambda w, _: cs.Drive.from_toml(w),
    "Drive.load": lambda w, _: cs.Drive.load(w),
    "Drive.from_json": lambda w, _: cs.Drive.from_json(w),
    "Drive()": lambda w, _: cs.Drive(**{**DRIVE.model_dump(), "ratio": w}),
    "Drive(shaft)": lambda w, _: cs.Drive(**{**DRIVE.model_dump(), "shaft": w}),
    "Cylinder()": lambda w, _: cs.Cylinder(diameter_mm=w, length_mm=1.0),
    "replace(ratio)": lambda w, _: DRIVE.replace(ratio=w),
    "replace(shaft)": lambda w, _: DRIVE.replace(shaft=w),
    "replace(shaft_1)": lambda w, _: DRIVE.replace(shaft_1_length_mm=w),
    "replace(provenance)": lambda w, _: DRIVE.replace(provenance=w),
    "replace(name)": lambda w, _: DRIVE.replace(name=w),
    "replace(errors)": lambda w, _: DRIVE.replace(ring_gap_errors_mm=w),
    "evaluate": lambda w, _: DRIVE.evaluate(w),
    "pin_loads": lambda w, _: DRIVE.pin_loads(w),
    "nominal_line": lambda w, _: DRIVE.nominal_line(w),
    "active_pins": lambda w, _: DRIVE.active_pins(w),
    "hole_windows": lambda w, _: DRIVE.hole_windows(w),
    "loaded(torque)": lambda w, _: PARTS.loaded(w),
    "loaded(crank)": lambda w, _: PARTS.loaded(5.0, w),
    "loaded(engine)": lambda w, _: PARTS.loaded(engine=w),
    "torque_twist(side)": lambda w, _: PARTS.torque_twist(w, points=5),
    "torque_twist(crank)": lambda w, _: PARTS.torque_twist(crank_deg=w, points=5),
    "torque_twist(load)": lambda w, _: PARTS.torque_twist(to_load_tn=w, points=5),
    "torque_twist(points)": lambda w, _: PARTS.torque_twist(points=w),
    "train(model)": lambda w, _: DRIVE.train(w),
    "train(part)": lambda w, _: DRIVE.train(load_inertia_kg_m2=w),
    "Space.grid(drive)": lambda w, _: cs.Space.grid(w, output_pin_count=[8]),
    "Space.grid(axis)": lambda w, _: cs.Space.grid(DRIVE, eccentricity_mm=w),
    "Space.sobol(count)": lambda w, _: cs.Space.sobol(DRIVE, w, eccentricity_mm=(0.3, 0.4)),
    "Space.sobol(axis)": lambda w, _: cs.Space.sobol(DRIVE, 4, eccentricity_mm=w),
    "Space.random(seed)": lambda w, _: cs.Space.random(DRIVE, 4, seed=w, free_play_deg=(1, 2)),
    "Space.table(drive)": lambda w, _: cs.Space.table(w, FRAME),
    "linspace(start)": lambda w, _: cs.linspace(w, 1.0, 2),
    "linspace(steps)": lambda w, _: cs.linspace(0.0, 1.0, w),
    "scan": lambda w, _: cs.scan(w),
    "sweep": lambda w, _: cs.sweep(w),
    "sweep(loads)": lambda w, _: cs.sweep(SPACE, loads_tn=w),
    "sweep(limits)": lambda w, _: cs.sweep(SPACE, limits=w),
    "sweep(limit)": lambda w, _: cs.sweep(SPACE, limits={"hole_web_mm": w}),
    "sweep(model)": lambda w, _: cs.sweep(SPACE, model=w),
    "sweep(solver)": lambda w, _: cs.sweep(SPACE, solver=w),
    "sink(space)": lambda w, folder: cs.sink(w, folder),
    "sink(rows)": lambda w, folder: cs.sink(SPACE, folder, rows_per_part=w),
    "sink(engine)": lambda w, folder: cs.sink(SPACE, folder, engine=w),
    "sink(objective)": lambda w, folder: cs.sink(SPACE, folder, objective=w),
    "sink(executor)": lambda w, folder: cs.sink(SPACE, folder, executor=w),
    "sink(progress)": lambda w, folder: cs.sink(SPACE, folder, progress=w),
    "shard(index)": lambda w, folder: cs.shard(SPACE, folder, index=w, of=2),
    "scan_dataset": lambda w, _: cs.scan_dataset(w),
    "Objective": lambda w, _: cs.Study.of(SPACE, objective=cs.Objective(w)),
    "Study.of": lambda w, _: cs.Study.of(w),
    "Study.from_toml": lambda w, _: cs.Study.from_toml(w),
    "Evaluator(drive)": lambda w, _: cs.Evaluator(w, ["eccentricity_mm"], "hole_web_mm"),
    "Evaluator(inputs)": lambda w, _: cs.Evaluator(DRIVE, w, "hole_web_mm"),
    "Evaluator(outputs)": lambda w, _: cs.Evaluator(DRIVE, ["eccentricity_mm"], w),
    "Evaluator()": lambda w, _: cs.Evaluator(DRIVE, ["eccentricity_mm"], "hole_web_mm")(w),
    "Recording.read": lambda w, _: cs.Recording.read(w),
    "Recording.read(meta)": lambda w, _: cs.Recording.read(__file__, w),
    "from_arrays(torque)": lambda w, _: cs.Recording.from_arrays(w),
    "from_arrays(angle)": lambda w, _: cs.Recording.from_arrays([0.0, 1.0], w),
    "from_arrays(run)": lambda w, _: cs.Recording.from_arrays([0.0, 1.0], run=w),
    "from_arrays(side)": lambda w, _: cs.Recording.from_arrays([0.0, 1.0], side=w),
    "from_arrays(history)": lambda w, _: cs.Recording.from_arrays([0.0, 1.0], history=w),
    "from_arrays(other)": lambda w, _: cs.Recording.from_arrays([0.0, 1.0], sied=w),
    "from_arrays(step)": lambda w, _: cs.Recording.from_arrays([0.0], angle_resolution_deg=w),
    "simulate(model)": lambda w, _: cs.simulate(w, LOAD),
    "simulate(programme)": lambda w, _: cs.simulate(MODEL, w),
    "simulate(predict)": lambda w, _: cs.simulate(MODEL, LOAD, predict=w),
    "Model(compliance)": lambda w, _: cs.Model(w, 28.0),
    "Model(side)": lambda w, _: cs.Model(2.7, 28.0, side=w),
    "Model(effects)": lambda w, _: cs.Model(2.7, 28.0, effects=w),
    "Model.from_json": lambda w, _: cs.Model.from_json(w),
    "Model.of_drive": lambda w, _: cs.Model.of_drive(w),
    "diagnose(recording)": lambda w, _: cs.diagnose(w, DRIVE),
    "diagnose(tolerance)": lambda w, _: cs.diagnose(LOAD, DRIVE, tolerance_deg=w),
    "diagnose(seed)": lambda w, _: cs.diagnose(LOAD, DRIVE, seed=w),
    "diagnose(without)": lambda w, _: cs.diagnose(LOAD, DRIVE, without=w),
    "Diagnosis.from_json": lambda w, _: cs.Diagnosis.from_json(w),
    "diagnose_folder": lambda w, folder: cs.diagnose_folder(w, folder),
    "diagnose_folder(workers)": lambda w, folder: cs.diagnose_folder([], folder, workers=w),
    "compare": lambda w, _: cs.compare(w),
    "compare([])": lambda w, _: cs.compare([w]),
    "open_study": lambda w, _: cs.open_study(w),
    "best_variants(table)": lambda w, _: cs.best_variants(w, "twist_1tn_deg"),
    "best_variants(objective)": lambda w, _: cs.best_variants(SPACE, w),
    "best_variants(rows)": lambda w, _: cs.best_variants(SPACE, "twist_1tn_deg", rows=w),
    "pareto_front(table)": lambda w, _: cs.pareto_front(w, "twist_1tn_deg"),
    "pareto_front(objectives)": lambda w, _: cs.pareto_front(SPACE, w),
    "nearest_variants(target)": lambda w, _: cs.nearest_variants(SPACE, w),
    "nearest_variants(value)": lambda w, _: cs.nearest_variants(SPACE, {"twist_1tn_deg": w}),
    "feasible_ranges": lambda w, _: cs.feasible_ranges(w),
    "input_influence": lambda w, _: cs.input_influence(w, ["twist_1tn_deg"]),
    "sobol_indices": lambda w, _: cs.sobol_indices(w, ["twist_1tn_deg"]),
    "driving_inputs": lambda w, _: cs.driving_inputs(w),
    "tolerance_percentiles": lambda w, _: cs.tolerance_percentiles(w, {}, "twist_1tn_deg", count=8),
    "robust_choice": lambda w, _: cs.robust_choice(DRIVE, {"shaft_1_diameter_mm": 0.5}, w, count=8),
    "normal": lambda w, _: cs.normal(w, 1.0),
    "triangular": lambda w, _: cs.triangular(0.0, w, 1.0),
    "log_uniform": lambda w, _: cs.log_uniform(w, 1.0),
    "Space.table(frame)": lambda w, _: cs.Space.table(DRIVE, w),
    "validate(broken)": lambda w, _: cs.validate(broken=w if w is not None else "x"),
    "Train(inertias)": lambda w, _: cs.Train(w, [1.0]),
    "Train(stiffnesses)": lambda w, _: cs.Train([1.0, 2.0], w),
    "Train(gaps)": lambda w, _: cs.Train([1.0, 2.0], [1.0], w),
    "Train(names)": lambda w, _: cs.Train([1.0, 2.0], [1.0], names=w),
    "modes": lambda w, _: TRAIN.modes(w),
    "modes(torque)": lambda w, _: cs.modes(DRIVE, torque_nm=w),
    "transient(train)": lambda w, _: cs.transient(w, cs.Event(kind="reversal")),
    "transient(event)": lambda w, _: cs.transient(TRAIN, w),
    "hole_locus": lambda w, _: DRIVE.hole_locus(w),
    "hole_locus(hole)": lambda w, _: DRIVE.hole_locus(0.0, w),
    "evaluate_table": lambda w, _: cs.evaluate_table(DRIVE, w),
    "evaluate_table(cells)": lambda w, _: cs.evaluate_table(DRIVE, {"eccentricity_mm": [w]}),
    "pareto": lambda w, _: cs.pareto(SPACE, minimise=w),
    "pareto(limits)": lambda w, _: cs.pareto(SPACE, minimise="ratio", limits=w),
    "influence(results)": lambda w, _: cs.input_influence(SPACE, w),
    "percentiles": lambda w, _: cs.tolerance_percentiles(
        DRIVE, {"shaft_1_diameter_mm": 0.5}, "twist_1tn_deg", w, count=8
    ),
    "robust_choice(share)": lambda w, _: cs.robust_choice(
        DRIVE, {"shaft_1_diameter_mm": 0.5}, "twist_1tn_deg", count=8, least_share_ok=w
    ),
    "Column": lambda w, _: cs.Column(w),
    "Model(play)": lambda w, _: cs.simulate(cs.Model(2.7, w), LOAD),
    "from_arrays(modulo)": lambda w, _: cs.Recording.from_arrays([0.0], angle_modulo_deg=w),
    "from_arrays(drive)": lambda w, _: cs.Recording.from_arrays([0.0], drive=w),
    "from_arrays(kept)": lambda w, _: cs.Recording.from_arrays([0.0], holdout_runs=w),
    "transient(torques)": lambda w, _: TRAIN.transient(w, 0.001, 5),
    "transient(torque)": lambda w, _: TRAIN.transient({0: w}, 0.001, 5),
    "transient(duration)": lambda w, _: TRAIN.transient({0: 1.0}, w, 5),
    "transient(samples)": lambda w, _: TRAIN.transient({0: 1.0}, 0.001, w),
}  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_a_wrong_argument_is_taken_or_refused_in_one_line(name: str, tmp_path: Path) -> None:
    for k, wrong in enumerate(WRONG):
        folder = tmp_path / str(k)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a NaN that is let in may make NumPy warn
            try:
                CALLS[name](wrong, folder)
            except (cs.InputError, cs.DesignError, cs.SweepError) as error:
                line = str(error)
                assert "\n" not in line, f"{wrong!r}: {line}"
                assert len(line) <= LONGEST, f"{wrong!r}: {line}"
                assert "validation error" not in line
                assert "pydantic" not in line


@pytest.mark.parametrize("name", CALLS)
def test_what_is_nothing_at_all_is_never_taken(name: str) -> None:
    with (
        tempfile.TemporaryDirectory() as folder,
        pytest.raises((cs.InputError, cs.DesignError, cs.SweepError)),
    ):
        CALLS[name](object(), Path(folder) / "out")
