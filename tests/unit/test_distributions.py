"""Distributions on axes, tolerances about a drive, and problems of SALib."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from scipy import special, stats

import cyclosweep as cs
import cyclosweep._core as _core
from cyclosweep.sweep.distributions import distribution_from
from cyclosweep.sweep.tolerances import pieces

CASES: list[tuple[cs.Distribution, Any]] = [
    (cs.uniform(0.3, 0.8), stats.uniform(0.3, 0.5)),
    (cs.normal(0.5, 0.02), stats.norm(0.5, 0.02)),
    (cs.normal(0.5, 0.02, 0.47, 0.51), stats.truncnorm(-1.5, 0.5, 0.5, 0.02)),
    (cs.normal(0.5, 0.02, low=0.5), stats.truncnorm(0, math.inf, 0.5, 0.02)),
    (cs.triangular(0.3, 0.45, 0.8), stats.triang(0.3, 0.3, 0.5)),
    (cs.triangular(0.3, 0.3, 0.8), stats.triang(0, 0.3, 0.5)),
    (cs.triangular(0.3, 0.8, 0.8), stats.triang(1, 0.3, 0.5)),
    (cs.log_uniform(0.05, 5.0), stats.loguniform(0.05, 5.0)),
]


@pytest.mark.parametrize(("given", "expected"), CASES, ids=lambda case: str(case)[:60])
@pytest.mark.parametrize("method", [cs.Space.sobol, cs.Space.latin_hypercube, cs.Space.random])
def test_an_axis_is_distributed_as_asked(
    given: cs.Distribution, expected: Any, method: Any
) -> None:
    space = method(cs.Drive.reference_87(), 4096, seed=3, eccentricity_mm=given)
    values = space.core().axes(["eccentricity_mm"], 0, 4096)[0]
    assert stats.kstest(values, expected.cdf).pvalue > 1e-3
    assert math.isclose(values.mean(), expected.mean(), rel_tol=0.1)
    assert values.min() >= given.low
    assert values.max() <= given.high
    assert space[7].eccentricity_mm == values[7]


@pytest.mark.parametrize(("given", "expected"), CASES, ids=lambda case: str(case)[:60])
def test_a_draw_is_the_quantile_of_its_uniform_number(
    given: cs.Distribution, expected: Any
) -> None:
    axes = [("u", "interval", np.array([0.0, 1.0]))]
    shares = _core.sample(axes, "sobol", 2048, 9, 0, 2048)[0]
    values = _core.sample([("x", *given.core())], "sobol", 2048, 9, 0, 2048)[0]
    assert np.allclose(values, expected.ppf(shares), rtol=1e-9, atol=1e-12)


def test_normal_quantiles_have_sixteen_digits_far_into_the_tails() -> None:
    axes = [("u", "log-uniform", np.array([1e-15, 0.5]))]
    shares = _core.sample(axes, "sobol", 1000, 1, 0, 1000)[0]
    for share in shares:
        # All of the distribution's shares from `share` up to the next number.
        form = np.array([0.0, 1.0, -np.inf, np.inf, share, np.nextafter(share, 1)])
        value = _core.sample([("x", "normal", form)], "random", 1, 0, 0, 1)[0, 0]
        assert math.isclose(value, special.ndtri(share), rel_tol=5e-15, abs_tol=1e-15)


def test_distributions_of_a_study_file(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text("""
[sample]
method = "sobol"
count = 64
[axes]
eccentricity_mm = { distribution = "normal", mean = 0.5, sd = 0.01, from = 0.48 }
output_pin_diameter_mm = { distribution = "triangular", from = 15, mode = 16, to = 18 }
output_pin_length_mm = { distribution = "log-uniform", from = 30, to = 50 }
bush_wall_mm = { distribution = "uniform", from = 1, to = 3 }
output_pin_count = { from = 6, to = 8 }
""")
    study = cs.Study.from_toml(tmp_path / "study.toml")
    expected = cs.Space.sobol(
        cs.Drive.reference_87(), 64, eccentricity_mm=cs.normal(0.5, 0.01, 0.48),
        output_pin_diameter_mm=cs.triangular(15, 16, 18),
        output_pin_length_mm=cs.log_uniform(30, 50), bush_wall_mm=cs.uniform(1, 3),
        output_pin_count=(6, 8),
    )  # fmt: skip
    assert study.hash == cs.Study.of(expected).hash
    other = (study.space.axes[0].definition(), cs.Space.sobol(
        cs.Drive.reference_87(), 64, eccentricity_mm=cs.normal(0.5, 0.02, 0.48)
    ).axes[0].definition())  # fmt: skip
    assert other[0] != other[1]
    words = [str(axis) for axis in expected.axes]
    assert words[:3] == [
        "normal, 0.5 +- 0.01, 0.48 to inf", "15 to 18, triangular", "30 to 50, log-uniform",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"distribution": "gauss"}, "axes.x.distribution: found 'gauss', expected one of uniform"),
        ({"distribution": "norml", "sd": 1}, "did you mean normal"),
        ({"distribution": "normal"}, "axes.x.sd: missing"),
        ({"distribution": "normal", "sd": -1}, "standard deviation of -1"),
        ({"distribution": "normal", "sd": 1, "from": 8, "to": 9}, "almost nothing"),
        ({"distribution": "normal", "sd": 1, "sigma": 1}, "axes.x.sigma: not of a normal"),
        ({"distribution": "uniform", "from": 2, "to": 1}, "found 2 to 1, expected low < high"),
        ({"distribution": "uniform", "from": 2, "to": "a"}, "'a'"),
        ({"distribution": "triangular", "from": 0, "mode": 3, "to": 1}, "found a mode of 3"),
        ({"distribution": "log-uniform", "from": 0, "to": 1}, "expected ends above zero"),
    ],
)
def test_a_distribution_that_cannot_be_is_one_line(table: dict[str, Any], message: str) -> None:
    with pytest.raises(cs.InputError, match=message) as caught:
        distribution_from("axes.x", table)
    assert "\n" not in str(caught.value)


def test_a_count_or_a_grid_has_no_distribution(tmp_path: Path) -> None:
    drive = cs.Drive.reference_87()
    with pytest.raises(cs.InputError, match="output_pin_count: found a distribution"):
        cs.Space.sobol(drive, 8, output_pin_count=cs.normal(8, 1))
    with pytest.raises(cs.InputError, match="eccentricity_mm"):
        cs.Space.grid(drive, eccentricity_mm=cs.normal(8, 1))  # type: ignore[arg-type]
    path = tmp_path / "study.toml"
    path.write_text('[axes]\neccentricity_mm = { distribution = "normal", sd = 1 }\n')
    with pytest.raises(cs.InputError, match="found a distribution, not for a grid"):
        cs.Study.from_toml(path)


def test_pieces_deviate_as_their_tolerances_say() -> None:
    drive = cs.Drive.reference_87()
    given = {
        "eccentricity_mm": cs.normal(sd=0.004),
        "bush_wall_mm": 0.01,
        "output_pin_length_mm": (-0.1, 0.3),
        "youngs_modulus_gpa": cs.log_uniform(0.95, 1.05),
    }
    table = pieces(drive, given, 4096, seed=1)
    assert abs(table["eccentricity_mm"].mean() - drive.eccentricity_mm) < 1e-5  # type: ignore[operator]
    assert math.isclose(table["eccentricity_mm"].std(), 0.004, rel_tol=0.01)  # type: ignore[arg-type]
    deviation = table["output_pin_length_mm"] - drive.output_pin_length_mm
    assert (deviation.min(), deviation.max()) == pytest.approx((-0.1, 0.3), abs=1e-3)
    factor = table["youngs_modulus_gpa"] / drive.youngs_modulus_gpa
    assert (factor.min(), factor.max()) == pytest.approx((0.95, 1.05), abs=1e-3)
    assert cs.sweep(cs.Space.around(drive, given, 4096, seed=1)).select(table.columns).equals(table)


def test_pieces_of_a_batch_share_what_their_batch_deviates() -> None:
    tolerances = cs.Tolerances(
        {"eccentricity_mm": cs.normal(sd=0.003)}, {"eccentricity_mm": cs.normal(sd=0.004)}, 64
    )
    values = pieces(cs.Drive.reference_87(), tolerances, 64 * 256)["eccentricity_mm"]
    by_batch = values.to_numpy().reshape(256, 64)
    assert math.isclose(by_batch.std(axis=1, ddof=1).mean(), 0.003, rel_tol=0.03)
    assert math.isclose(by_batch.mean(axis=1).std(), 0.004, rel_tol=0.05)
    assert math.isclose(values.std(), 0.005, rel_tol=0.03)  # type: ignore[arg-type]
    # Neighbours in a batch are alike, and those of two batches are not.
    assert np.corrcoef(by_batch[:, 0], by_batch[:, 1])[0, 1] == pytest.approx(0.64, abs=0.1)
    assert abs(np.corrcoef(by_batch[:-1, 0], by_batch[1:, 0])[0, 1]) < 0.2
    alone = cs.Tolerances({}, {"eccentricity_mm": 0.01}, 5)
    shared = pieces(cs.Drive.reference_87(), alone, 12)["eccentricity_mm"]
    assert shared.n_unique() == 3
    assert shared[:5].n_unique() == 1


@pytest.mark.parametrize(
    ("tolerances", "message"),
    [
        ({}, "tolerances: none"),
        ({"eccentricty_mm": 0.1}, "did you mean eccentricity_mm"),
        ({"eccentricity_mm": 0.0}, "expected a deviation above 0"),
        ({"eccentricity_mm": (0.1, 0.0)}, "low < high"),
        ({"output_pin_count": 1}, "tolerances.output_pin_count"),
        ({"output_stiffness_nm_per_arcmin": 1}, "the drive has no value of it"),
        (3, "expected deviations by input"),
    ],
)
def test_tolerances_that_make_no_sense_are_one_line(tolerances: Any, message: str) -> None:
    with pytest.raises(cs.InputError, match=message):
        cs.Space.around(cs.Drive.reference_87(), tolerances, 8)


def test_a_tolerance_file(tmp_path: Path) -> None:
    path = tmp_path / "tolerances.toml"
    path.write_text("""
batch_size = 20
[tolerances]
eccentricity_mm = 0.01
bush_wall_mm = { distribution = "normal", sd = 0.01, from = -0.02, to = 0.02 }
[batches]
eccentricity_mm = { distribution = "uniform", from = -0.02, to = 0.02 }
""")
    found = cs.Tolerances.from_toml(path)
    assert found == cs.Tolerances(
        {"eccentricity_mm": cs.uniform(-0.01, 0.01),
         "bush_wall_mm": cs.normal(0, 0.01, -0.02, 0.02)},
        {"eccentricity_mm": cs.uniform(-0.02, 0.02)}, 20,
    )  # fmt: skip
    for text, message in (
        ("[tolerance]\nx = 1", "tolerances.toml: tolerance: no such key, did you mean tolerances"),
        ("[batches]\nx = 1", "batch_size: missing"),
        ("", "tolerances: none"),
        ("[tolerances]\nx = 'a'", "found 'a'"),
        ("tolerances = 3", "tolerances"),
    ):
        path.write_text(text)
        with pytest.raises(cs.InputError, match=message):
            cs.Tolerances.from_toml(path)


def test_salib_problems_come_and_go() -> None:
    drive = cs.Drive.reference_87()
    problem = {
        "num_vars": 5,
        "names": ["eccentricity_mm", "bush_wall_mm", "output_pin_diameter_mm",
                  "output_pin_length_mm", "disc_outer_radius_mm"],
        "bounds": [[0.4, 0.6], [2.0, 0.1], [14.0, 17.0, 16.0, 0.5], [30.0, 40.0, 0.25],
                   [60.0, 70.0]],
        "dists": ["unif", "norm", "truncnorm", "triang", "logunif"],
    }  # fmt: skip
    space = cs.Space.from_salib(drive, problem, 256, seed=4)
    assert space.to_salib() == problem
    pytest.importorskip("SALib")
    from SALib.util import scale_samples

    units = cs.Space.sobol(drive, 256, seed=4, **dict.fromkeys(problem["names"], (0.0, 1.0)))  # type: ignore[call-overload]
    names = problem["names"]
    theirs = scale_samples(units.core().axes(names, 0, 256).T, problem)  # type: ignore[arg-type]
    ours = space.core().axes(names, 0, 256).T  # type: ignore[arg-type]
    assert np.allclose(ours, theirs, rtol=1e-9)


def test_salib_problems_that_a_space_cannot_have_are_refused() -> None:
    drive = cs.Drive.reference_87()
    plain = {"num_vars": 1, "names": ["eccentricity_mm"], "bounds": [[0.4, 0.5]]}
    assert cs.Space.from_salib(drive, plain, 8, method="saltelli").total == 24
    for change, message in (
        ({"dists": ["weibull"]}, "found 'weibull', expected one of unif"),
        ({"groups": ["all"]}, "found groups"),
        ({"num_vars": 2}, "expected as many of each"),
        ({"bounds": [[0.4]]}, "found 1 bounds, expected 2"),
        ({"names": ["eccentricty_mm"]}, "did you mean eccentricity_mm"),
    ):
        with pytest.raises(cs.InputError, match=message):
            cs.Space.from_salib(drive, plain | change, 8)
    with pytest.raises(cs.InputError, match="method: found 'grid'"):
        cs.Space.from_salib(drive, plain, 8, method="grid")
    with pytest.raises(cs.InputError, match="SALib has no distribution"):
        cs.Space.sobol(drive, 8, output_pin_count=(6, 8)).to_salib()


def test_a_larger_sample_for_sobol_indices_keeps_the_smaller_one() -> None:
    drive = cs.Drive.reference_87()
    axes: dict[str, Any] = {"eccentricity_mm": cs.normal(0.5, 0.01), "bush_wall_mm": (1, 2)}
    small, large = (cs.Space.saltelli(drive, count, seed=2, **axes) for count in (16, 64))
    assert (small.total, large.total) == (64, 256)
    assert cs.sweep(small).equals(cs.sweep(large[:64]))
    first = cs.sweep(small).head(4)
    assert first["eccentricity_mm"].to_list()[1] == first["eccentricity_mm"].to_list()[3]
    assert isinstance(cs.scan(large).collect(), pl.DataFrame)


def test_tolerances_of_no_input_are_refused_where_they_are_made() -> None:
    for name in ("eccentricty_mm", "shaft_1_height_mm"):
        with pytest.raises(cs.InputError, match=rf"tolerances\.{name}: no such input of a drive"):
            cs.Tolerances({name: 0.01})
        with pytest.raises(cs.InputError, match=rf"tolerances\.{name}: no such input of a drive"):
            cs.Tolerances({}, {name: 0.01})
    for name in ("eccentricity_mm", "hole_clearance_mm", "shaft_12_diameter_mm"):
        assert cs.Tolerances({name: 0.01}).names == (name,)
