"""Values that nothing can have are refused in one line: what was found, and what was expected."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.simulation.effect_value import EffectValue

NAN, INF = float("nan"), float("inf")
DRIVE = cs.Drive.reference_87()
TRAIN = DRIVE.train(load_inertia_kg_m2=5.0)
SPACE = cs.Space.grid(DRIVE, output_pin_count=[6, 8, 9])
LOAD = cs.Recording.from_arrays([0.0, 5.0, -2.0])
TORQUE = np.array([0.0, 5.0, 0.0, -5.0])


def refusal(call: Callable[[], object]) -> str:
    """Message of the refusal."""
    with pytest.raises(cs.InputError) as caught:
        call()
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("torque", [NAN, INF, -INF])
def test_no_mode_is_around_a_torque_that_is_no_number(torque: float) -> None:
    expected = f"torque_nm: found {torque:g}, expected a finite number"
    assert refusal(lambda: cs.modes(DRIVE, torque_nm=torque)) == expected
    assert refusal(lambda: cs.dimension_sensitivities(DRIVE, torque_nm=torque)) == expected
    assert refusal(lambda: TRAIN.modes(torque)) == expected
    assert refusal(lambda: TRAIN.stiffnesses_at(torque)) == expected


def test_modes_are_around_no_load_and_around_a_load_in_the_other_direction() -> None:
    nominal = cs.modes(DRIVE).frequencies_hz
    for torque in (0.0, -5.0):
        assert cs.modes(DRIVE, torque_nm=torque).frequencies_hz == pytest.approx(nominal)


@pytest.mark.parametrize("wrong", [NAN, INF, -INF])
@pytest.mark.parametrize(
    "name", ["compliance_deg_per_nm", "free_play_deg", "datum_deg", "torque_zero_nm"]
)
def test_a_model_has_finite_numbers(name: str, wrong: float) -> None:
    given = {"compliance_deg_per_nm": 2.7, "free_play_deg": 28.0, name: wrong}
    found = refusal(lambda: cs.Model(**given))  # type: ignore[arg-type]
    assert found == f"{name}: found {wrong}, expected a finite number"


def test_a_model_twists_with_its_torque(tmp_path: Path) -> None:
    for compliance in (0.0, -2.7):
        expected = f"compliance_deg_per_nm: found {compliance:g}, expected a number above zero"
        assert refusal(lambda c=compliance: cs.Model(c, 28.0)) == expected  # type: ignore[misc]
        effect = EffectValue("contact_stiffening", {"turn_nm": 3.0}, (1.0,))
        falls = cs.Model(compliance, 28.0, effects=(effect,))
        assert refusal(lambda m=falls: cs.simulate(m, LOAD)) == expected  # type: ignore[misc]
        assert refusal(lambda m=falls: DRIVE.train(m)) == expected  # type: ignore[misc]
        (tmp_path / "model.json").write_text(falls.to_json())
        assert expected in refusal(lambda: cs.Model.from_json(tmp_path / "model.json"))
    found = refusal(lambda: cs.Model(2.7, -1.0))
    assert found == "free_play_deg: found -1, expected a number not below zero"
    assert cs.simulate(cs.Model(2.7, 0.0), LOAD).angle_deg is not None


@pytest.mark.parametrize(
    ("known", "expected"),
    [
        ({"angle_resolution_deg": -1}, "found -1, expected a step not below zero"),
        ({"angle_modulo_deg": -360}, "found -360, expected degrees above zero"),
        ({"angle_modulo_deg": 0.0}, "found 0, expected degrees above zero"),
        ({"angle_modulo_deg": NAN}, "found nan, expected a finite number"),
        ({"drive": 5}, "found 5, expected str or Path"),
        ({"reset_between_runs": "no"}, "found 'no', expected bool"),
        ({"holdout_runs": 5}, "found 5, expected a list of numbers of runs"),
        ({"conditioning_runs": ("a",)}, "found ('a',), expected a list of numbers of runs"),
        ({"conditioning_runs": (1.5,)}, "found (1.5,), expected a list of numbers of runs"),
    ],
)
def test_a_recording_is_known_by_what_can_be(known: dict[str, Any], expected: str) -> None:
    ((name, _),) = known.items()
    made = cs.Recording.from_arrays
    assert refusal(lambda: made(TORQUE, TORQUE * 2.7, **known)) == f"{name}: {expected}"


def test_numbers_of_runs_are_a_tuple_and_absent_ones_are_said() -> None:
    run = [0, 0, 1, 1]
    recording = cs.Recording.from_arrays(
        TORQUE, TORQUE * 2.7, run=run, conditioning_runs=np.array([0]), holdout_runs=[5]
    )
    assert recording.conditioning_runs == (0,)
    assert recording.holdout_runs == (5,)
    said = [fault.reason for fault in recording.faults if fault.kind == "run_absent"]
    assert said == ["holdout_runs names run 5, which has no samples."]


@pytest.mark.parametrize("key", ["angle_resolution_deg = -1", "columns.angle_deg.modulo = -360"])
def test_a_sidecar_states_no_less(tmp_path: Path, key: str) -> None:
    (tmp_path / "loop.csv").write_text("torque_nm,angle_deg\n0,0\n5,13\n")
    (tmp_path / "loop.toml").write_text(
        f'{key}\ncolumns.angle_deg.column = "angle_deg"\n' if "modulo" in key else f"{key}\n"
    )
    assert "loop.toml" in refusal(lambda: cs.Recording.read(tmp_path / "loop.csv"))


WIDER: dict[str, Any] = {"shaft_1_diameter_mm": 0.5}
EVENT = cs.Event(kind="reversal")
NAMES = "expected a list of names"
COMPARE = "expected a comparison such as a_mm > b_mm"


def percentiles(results: Any = "twist_1tn_deg", ranks: Any = (5, 95)) -> object:
    """Percentiles of a few pieces."""
    return cs.tolerance_percentiles(DRIVE, WIDER, results, ranks, count=8)


def robust(least_share_ok: Any) -> object:
    """Order of one drive."""
    few: dict[str, Any] = {"count": 8, "least_share_ok": least_share_ok}
    return cs.robust_choice(DRIVE, WIDER, "twist_1tn_deg", **few)


def front(minimise: Any = "twist_1tn_deg", **options: Any) -> object:
    """Pareto front of three variants."""
    return cs.pareto(SPACE, minimise=minimise, **options)


def evaluated(cells: list[object]) -> object:
    """Designs of a table."""
    return cs.evaluate_table(DRIVE, {"eccentricity_mm": cells})


ANY: Any = cs
"""The library to a type checker that is not to refuse wrong arguments itself."""

REFUSED: dict[str, tuple[Callable[[], object], str]] = {
    "no results": (lambda: cs.input_influence(SPACE, []), f"results: found [], {NAMES}"),
    "one result": (lambda: ANY.input_influence(SPACE, 3), f"results: found 3, {NAMES}"),
    "inputs as text": (
        lambda: cs.input_influence(SPACE, "twist_1tn_deg", inputs="ratio"),
        f"inputs: found 'ratio', {NAMES}",
    ),
    "a number is small": (lambda: front(3), f"minimise: found 3, {NAMES}"),
    "sobol of nothing": (lambda: cs.sensitivity(SPACE, []), f"results: found [], {NAMES}"),
    "percentiles of none": (lambda: percentiles([]), "results: none, expected at least"),
    "one percentile": (
        lambda: percentiles(ranks=50), "percentiles: found 50, expected a list of numbers",
    ),
    "no percentile": (
        lambda: percentiles(ranks=[]), "percentiles: found none, expected at least one",
    ),
    "no train": (lambda: ANY.transient(None, EVENT), "train: found None, expected Train"),
    "no event": (lambda: ANY.transient(TRAIN, None), "event: found None, expected Event"),
    "a drive": (lambda: ANY.transient(DRIVE, EVENT), "train: found <Drive reference-87: "),
    "share of a": (lambda: robust("a"), "least_share_ok: found 'a', expected a finite number"),
    "share of nan": (lambda: robust(NAN), "least_share_ok: found nan, expected a finite number"),
    "share of 5": (lambda: robust(5), "least_share_ok: found 5, expected 0 to 1"),
    "share of -5": (lambda: robust(-5), "least_share_ok: found -5, expected 0 to 1"),
    "other indices": (
        lambda: cs.driving_inputs(pl.DataFrame({"a": [1]})),
        "indices: no column result, expected a table as sobol_indices returns it",
    ),
    "locus at a": (
        lambda: DRIVE.hole_locus("a"), "theta_deg: found 'a', expected a finite number",
    ),
    "locus at nan": (
        lambda: DRIVE.hole_locus([0.0, NAN]), "theta_deg: found nan, expected a finite number",
    ),
    "hole 8 of 8": (
        lambda: DRIVE.hole_locus(0.0, 8), "hole: found 8, expected a whole number from 0 to 7",
    ),
    "a text before a number": (
        lambda: evaluated(["a", 0.6]), "row 0, eccentricity_mm: found 'a', expected a number",
    ),
    "a text after a number": (
        lambda: evaluated([0.6, "a"]), "row 1, eccentricity_mm: found 'a', expected a number",
    ),
    "shift": (
        lambda: front(limits="hole_web_mm >> 2"),
        f"limits: found '>>' in 'hole_web_mm >> 2', {COMPARE}",
    ),
    "arrow": (
        lambda: front(limits="hole_web_mm @> 2"),
        "limits: found 'hole_web_mm @> 2', which is no expression: it has another sign than",
    ),
    "poisson": (
        lambda: DRIVE.replace(poisson_ratio=NAN),
        "reference-87: poisson_ratio: found nan, expected a finite number",
    ),
    "limit": (
        lambda: cs.sweep(SPACE, limits={"hole_web_mm": (NAN, None)}),
        "limits.hole_web_mm: found nan, expected a number or None",
    ),
    "whole": (
        lambda: ANY.diagnose(cs.simulate(DRIVE, LOAD), DRIVE, full="no"),
        "full: found 'no', expected bool",
    ),
    "column": (
        lambda: ANY.Column(3),
        "column: found 3, expected an expression as text or of polars, or a function",
    ),
    "objective": (
        lambda: cs.Objective(" "),
        "objective: found ' ', expected a column or an expression of columns",
    ),
    "sense": (lambda: ANY.Objective("ratio", "no"), "maximise: found 'no', expected bool"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_one_line_says_what_was_found_and_what_was_expected(name: str) -> None:
    call, expected = REFUSED[name]
    assert refusal(call).startswith(expected)


def test_labels_of_a_table_may_mix_texts_and_numbers() -> None:
    table = {"label": [1, "b", None], "eccentricity_mm": [0.6, ".7", 0.8]}
    found = cs.evaluate_table(DRIVE, table)
    assert found["label"].to_list() == ["1", "b", None]
    assert found["eccentricity_mm"].to_list() == [0.6, 0.7, 0.8]
    assert front(["twist_1tn_deg"], maximise=[]) is not None
