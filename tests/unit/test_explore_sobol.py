"""Sobol indices: analytic answers, doubling, infeasible draws, functions of the user."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl
import pytest

import cyclosweep as cs

pytest.importorskip("SALib")

Reals = npt.NDArray[np.float64]
EXAMPLES = Path(__file__).parents[2] / "examples"


def ishigami(points: Reals) -> Reals:
    """Function of Ishigami and Homma (1990), with 7 and 0.1."""
    a, b, c = points.T
    return np.asarray(np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a))


def ishigami_indices() -> tuple[list[float], list[float]]:
    """Its indices from the integrals that can be done by hand."""
    first = 0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2
    second = 49 / 8
    joint = 0.01 * math.pi**8 * (1 / 18 - 1 / 50)
    whole = first + second + joint
    return (
        [first / whole, second / whole, 0.0],
        [(first + joint) / whole, second / whole, joint / whole],
    )


WEIGHTS = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0])


def sobol_g(points: Reals) -> Reals:
    """The g function of Saltelli and Sobol (1995)."""
    return np.asarray(((np.abs(4 * points - 2) + WEIGHTS) / (1 + WEIGHTS)).prod(axis=1))


def sobol_g_indices() -> tuple[list[float], list[float]]:
    """Its indices: the variance is a product over the inputs."""
    parts = 1 / (3 * (1 + WEIGHTS) ** 2)
    whole = np.prod(1 + parts) - 1
    total = parts * np.prod(1 + parts) / (1 + parts) / whole
    return list(parts / whole), list(total)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", ["ishigami", "sobol_g"])
def test_indices_of_functions_with_analytic_answers(name: str, seed: int) -> None:
    if name == "ishigami":
        function, (first, total) = ishigami, ishigami_indices()
        inputs = dict.fromkeys("abc", (-math.pi, math.pi))
    else:
        function, (first, total) = sobol_g, sobol_g_indices()
        inputs = {f"x{k}": (0.0, 1.0) for k in range(len(WEIGHTS))}
    found = cs.sobol_indices(function, inputs=inputs, half_width=0.03, seed=seed)
    assert found["input"].to_list() == list(inputs)
    for wanted, column in ((first, "first_order"), (total, "total")):
        half_width = found[f"{column}_half_width"].to_numpy()
        assert half_width.max() <= 0.03
        assert np.all(np.abs(found[column].to_numpy() - wanted) <= np.maximum(half_width, 1e-4))
    assert found["share_used"].unique().to_list() == [1.0]


def test_inputs_with_distributions_have_the_indices_of_their_variances() -> None:
    def plain_sum(points: Reals) -> dict[str, Reals]:
        return {"sum": points.sum(axis=1), "first": points[:, 0], "none": 0 * points[:, 0] + 3}

    inputs: dict[str, Any] = {
        "a": cs.normal(5, 0.2), "b": cs.triangular(0, 0.3, 1), "c": cs.normal(0, 0.3, -0.3, 0.3),
    }  # fmt: skip
    found = cs.sobol_indices(plain_sum, inputs=inputs, half_width=0.01, most_draws=2**16)
    # Variance of a normal distribution that is cut off at one standard deviation [scipy].
    cut = 0.3**2 * 0.29112509
    variances = np.array([0.04, (0 + 0.09 + 1 - 0.3) / 18, cut])
    of_sum = found.filter(pl.col("result") == "sum")
    assert np.allclose(of_sum["total"], variances / variances.sum(), atol=0.01)
    assert np.allclose(of_sum["first_order"], variances / variances.sum(), atol=0.01)
    driving = cs.driving_inputs(found)
    assert driving["driven_by"].to_list() == ["b", "a", None]
    assert driving["a"][1] == pytest.approx(1, abs=0.02)


def test_indices_of_the_87_to_1_study_are_stable_under_doubling() -> None:
    study = cs.Study.from_toml(EXAMPLES / "sobol-8.toml")
    results = ["twist_1tn_deg", "output_stiffness_nm_per_arcmin", "hole_web_mm"]
    small, large = (
        cs.sobol_indices(study, results, first_draws=draws, most_draws=draws, seed=1)
        for draws in (4096, 8192)
    )
    assert small["draws"].unique().to_list() == [4096]
    assert large["draws"].unique().to_list() == [8192]
    for column in ("first_order", "total"):
        change = (small[column] - large[column]).abs().to_numpy()
        widths = [table[f"{column}_half_width"].to_numpy() for table in (small, large)]
        width = np.hypot(*widths)
        assert np.all(change <= np.maximum(width, 0.002))
    assert (large["total_half_width"] < small["total_half_width"] + 1e-9).mean() > 0.6  # type: ignore[operator]
    assert cs.driving_inputs(small)["driven_by"].equals(cs.driving_inputs(large)["driven_by"])


def test_the_sample_doubles_until_the_half_width_is_reached() -> None:
    inputs = dict.fromkeys("abc", (-math.pi, math.pi))
    seen: list[int] = []

    def counting(points: Reals) -> Reals:
        seen.append(len(points))
        return ishigami(points)

    found = cs.sobol_indices(counting, inputs=inputs, half_width=0.05, first_draws=64)
    draws = found["draws"][0]
    assert draws > 64
    # No draw is evaluated twice.
    assert sum(seen) == 5 * draws
    once = cs.sobol_indices(ishigami, inputs=inputs, first_draws=draws, most_draws=draws)
    assert once.equals(found)
    short = cs.sobol_indices(ishigami, inputs=inputs, half_width=1e-4, most_draws=1000)
    assert short["draws"][0] == 512
    assert short["total_half_width"].max() > 1e-4  # type: ignore[operator]


def test_draws_with_an_infeasible_variant_are_left_out_and_counted() -> None:
    drive = cs.Drive.reference_87()
    wide = cs.Space.sobol(drive, 8, eccentricity_mm=(0.3, 1.2), shaft_1_length_mm=(60.0, 110.0))
    found = cs.sobol_indices(wide, "twist_1tn_deg", most_draws=1024)
    share = found["share_used"][0]
    assert 0.1 < share < 0.9
    assert found["total"].is_not_null().all()
    none = cs.Space.sobol(drive, 8, eccentricity_mm=(2.0, 3.0))
    empty = cs.sobol_indices(none, "twist_1tn_deg", most_draws=64)
    assert empty["total"].to_list() == [None]
    assert empty["share_used"].to_list() == [0.0]


def test_limits_layout_and_lists_of_a_study_do_not_count() -> None:
    drive = cs.Drive.reference_87()
    axes: dict[str, Any] = {
        "output_pin_count": [6, 8, 10],
        "shaft_1_length_mm": [60.0, 80.0, 100.0],
    }
    plain = cs.Study.of(cs.Space.grid(drive, **axes))
    limited = cs.Study.of(cs.Space.sobol(drive, 64, seed=5, **axes),
                          limits={"twist_1tn_deg": (None, 0.0)})  # fmt: skip
    results = ["twist_1tn_deg", "active_pins_max", "statics_applicable"]
    first = cs.sobol_indices(plain, results, most_draws=512)
    assert first.equals(cs.sobol_indices(limited, results, most_draws=512))
    assert first.equals(cs.sobol_indices(dataclasses.replace(plain), results, most_draws=512))
    assert first.filter(pl.col("result") == "active_pins_max")["total"][0] > 0.9


@pytest.mark.parametrize(
    ("model", "arguments", "message"),
    [
        (ishigami, {}, "inputs: none"),
        (3, {}, "model: found 3"),
        (ishigami, {"inputs": {"a": (1.0, 0.0)}}, "low < high"),
        (lambda x: x, {"inputs": {"a": (0.0, 1.0)}}, r"shape \(\d+, 1\)"),
        (ishigami, {"inputs": {"a": (0.0, 1.0)}, "half_width": 0}, "half_width: found 0"),
        (ishigami, {"inputs": {"a": (0.0, 1.0)}, "confidence": 95}, "confidence: found 95"),
        ("space", {"results": "twist_1tn_dg"}, "did you mean twist_1tn_deg"),
        ("space", {"inputs": {"a": (0, 1)}}, "inputs: only for a function"),
        ("table", {}, "found the rows of a table"),
        (lambda x: {"y": x[:, 0]}, {"inputs": {"a": (0.0, 1.0)}, "results": "z"}, "no result z"),
    ],
)
def test_bad_input_is_one_line(model: Any, arguments: dict[str, Any], message: str) -> None:
    drive = cs.Drive.reference_87()
    if model == "space":
        model = cs.Space.sobol(drive, 8, eccentricity_mm=(0.4, 0.5))
    if model == "table":
        model = cs.Space.table(drive, pl.DataFrame({"eccentricity_mm": [0.4]}))
    with pytest.raises(cs.InputError, match=message) as caught:
        cs.sobol_indices(model, **arguments)
    assert "\n" not in str(caught.value)
