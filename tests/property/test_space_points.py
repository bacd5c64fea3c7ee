"""Points of every sampling method: balance, range, bijection, and access at any place."""

from __future__ import annotations

import itertools
import tracemalloc
from collections.abc import Callable, Iterable
from typing import Any, cast

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

import cyclosweep as cs

SAMPLED: dict[str, Callable[..., cs.Space]] = {
    "sobol": cs.Space.sobol,
    "latin-hypercube": cs.Space.latin_hypercube,
    "random": cs.Space.random,
}
AXES: dict[str, Any] = {
    "eccentricity_mm": (0.3, 0.8),
    "output_pin_diameter_mm": (10.0, 22.0),
    "output_pin_count": (6, 12),
    "bush_wall_mm": [1.0, 2.0, 3.0],
    "hole_clocking_deg": cs.linspace(-4, 4, 9),
}


def points(space: cs.Space, start: int | None = None, stop: int | None = None) -> dict[str, Any]:
    """Values of every axis, by name."""
    core = space.core()
    first = space.start if start is None else start
    last = space.stop if stop is None else stop
    names = [axis.name for axis in space.axes]
    return dict(zip(names, core.axes(names, first, last), strict=True))


def unit(space: cs.Space, name: str, low: float, high: float) -> npt.NDArray[np.float64]:
    scaled: npt.NDArray[np.float64] = (points(space)[name] - low) / (high - low)
    return scaled


def test_a_grid_is_the_product_of_its_axes(reference: cs.Drive) -> None:
    linear = cs.linspace(0.31, 0.77, 13)
    space = cs.Space.grid(
        reference,
        eccentricity_mm=linear,
        output_pin_count=[8, 6, 9],
        output_pin_diameter_mm=cs.linspace(22, 10, 7),
        criterion=["inside", "statics"],
        shaft_2_length_mm=[20.0],
    )
    expected = itertools.product(
        np.linspace(0.31, 0.77, 13), [8, 6, 9], np.linspace(22, 10, 7), [1, 2], [20.0]
    )
    assert len(space) == 13 * 3 * 7 * 2
    assert list(zip(*points(space).values(), strict=True)) == list(expected)


@pytest.mark.parametrize("steps", [1, 2, 3, 1000, 99_991])
@pytest.mark.parametrize(("low", "high"), [(0.1, 0.7), (-3.3, 1e9), (5.0, 5.0), (1.0, -2.0)])
def test_equidistant_values_are_numpy_s(
    reference: cs.Drive, low: float, high: float, steps: int
) -> None:
    space = cs.Space.grid(reference, hole_clocking_deg=cs.linspace(low, high, steps))
    assert np.array_equal(points(space)["hole_clocking_deg"], np.linspace(low, high, steps))


@pytest.mark.parametrize("method", SAMPLED)
@pytest.mark.parametrize("seed", [0, 1, 2**64 - 1])
def test_values_lie_in_range(reference: cs.Drive, method: str, seed: int) -> None:
    space = SAMPLED[method](reference, 5000, seed=seed, **AXES)
    found = points(space)
    assert 0.3 <= found["eccentricity_mm"].min() < 0.301
    assert 0.799 < found["eccentricity_mm"].max() <= 0.8
    assert set(found["output_pin_count"]) == {6, 7, 8, 9, 10, 11, 12}
    assert set(found["bush_wall_mm"]) == {1, 2, 3}
    assert set(found["hole_clocking_deg"]) == set(range(-4, 5))


@pytest.mark.parametrize("method", SAMPLED)
def test_seed_and_axis_decide_the_points(reference: cs.Drive, method: str) -> None:
    def drawn(seed: int) -> dict[str, Any]:
        return points(
            SAMPLED[method](
                reference, 512, seed=seed, eccentricity_mm=(0, 1), output_torque_nm=(0, 1)
            )
        )

    first, again, other = drawn(3), drawn(3), drawn(4)
    for name in first:
        assert np.array_equal(first[name], again[name])
        assert not np.array_equal(first[name], other[name])
    assert not np.array_equal(*first.values())
    assert abs(np.corrcoef(*first.values())[0, 1]) < 0.15


@pytest.mark.parametrize("exponent", [4, 8, 13])
def test_sobol_points_are_a_net(reference: cs.Drive, exponent: int) -> None:
    """Every axis of 2^m points meets each of 2^m strata once, and pairs of axes are balanced."""
    count = 2**exponent
    names = [name for name in reference.inputs() if name.endswith(("_mm", "_nm", "_deg"))]
    space = cs.Space.sobol(reference, count, seed=exponent, **dict.fromkeys(names, (0.0, 1.0)))
    columns = points(space)
    for values in columns.values():
        assert np.array_equal(np.sort(np.floor(values * count)), np.arange(count))
    first, second = list(columns.values())[:2]
    for split in range(exponent + 1):
        wide, high = 2**split, 2 ** (exponent - split)
        cells = np.floor(first * wide) * high + np.floor(second * high)
        assert len(np.unique(cells)) == count  # a (0, m, 2)-net, as scipy's first two axes are


def test_any_aligned_stretch_of_sobol_points_is_balanced(reference: cs.Drive) -> None:
    space = cs.Space.sobol(reference, 2**40, seed=5, eccentricity_mm=(0.0, 1.0))
    start = 2**39 + 7 * 1024
    values = points(space, start, start + 1024)["eccentricity_mm"]
    assert np.array_equal(np.sort(np.floor(values * 1024)), np.arange(1024))


def test_sobol_is_as_even_as_scipy_s(reference: cs.Drive) -> None:
    names = ["eccentricity_mm", "output_pin_diameter_mm", "bush_wall_mm", "output_pin_length_mm"]
    space = cs.Space.sobol(reference, 1024, seed=1, **dict.fromkeys(names, (0.0, 1.0)))
    ours = np.column_stack(list(points(space).values()))
    theirs = stats.qmc.Sobol(4, rng=1).random(1024)
    chance = np.random.default_rng(0).random((1024, 4))
    assert stats.qmc.discrepancy(ours) < 2 * stats.qmc.discrepancy(theirs)
    assert stats.qmc.discrepancy(ours) < 0.1 * stats.qmc.discrepancy(chance)


@pytest.mark.parametrize("count", [1, 2, 3, 64, 1000, 4097])
def test_latin_hypercube_meets_every_stratum_once(reference: cs.Drive, count: int) -> None:
    space = cs.Space.latin_hypercube(
        reference, count, seed=9, eccentricity_mm=(0.0, 1.0), bush_wall_mm=(0.0, 1.0)
    )
    for values in points(space).values():
        assert np.array_equal(np.sort(np.floor(values * count)), np.arange(count))


def test_random_points_are_uniform_and_independent(reference: cs.Drive) -> None:
    space = cs.Space.random(
        reference, 20_000, seed=2, eccentricity_mm=(0.0, 1.0), bush_wall_mm=(0.0, 1.0)
    )
    first, second = points(space).values()
    for values in (first, second):
        assert stats.kstest(values, "uniform").pvalue > 1e-4
        assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 0.03
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.03


@pytest.mark.parametrize("method", SAMPLED)
@given(
    exponent=st.integers(0, 63),
    place=st.floats(0, 1, exclude_max=True),
    seed=st.integers(0, 2**64 - 1),
)
@settings(deadline=None, max_examples=40)
def test_a_variant_is_a_function_of_its_number_alone(
    method: str, exponent: int, place: float, seed: int
) -> None:
    count = 2**exponent
    space = SAMPLED[method](cs.Drive.reference_87(), count, seed=seed, **AXES)
    start = min(int(place * count), max(0, count - 40))
    stop = min(count, start + 40)
    indices = np.arange(start, stop, dtype=np.uint64)
    backwards = np.ascontiguousarray(indices[::-1])
    core = space.core()
    for name, values in points(space, start, stop).items():
        assert np.array_equal(core.axis_at(name, backwards)[::-1], values)
        assert np.isfinite(values).all()


def test_the_largest_space_is_read_in_constant_memory(reference: cs.Drive) -> None:
    space = cs.Space.sobol(reference, 2**63, seed=1, **AXES)
    tracemalloc.start()
    tail = space[2**63 - 1000 :]
    frame = cs.sweep(tail)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert frame["variant"].to_list() == list(range(2**63 - 1000, 2**63))
    assert space[2**63 - 1].eccentricity_mm == frame["eccentricity_mm"][-1]
    assert space[-1] == space[2**63 - 1]
    assert peak < 20e6
    assert cs.scan(space).head(3).collect().height == 3
    assert f"{2**63:,} variants" in repr(space)


def test_a_huge_grid_is_read_in_constant_memory(reference: cs.Drive) -> None:
    space = cs.Space.grid(
        reference,
        eccentricity_mm=cs.linspace(0.3, 0.8, 2**30),
        output_pin_diameter_mm=cs.linspace(10, 22, 2**30),
    )
    tail = space[2**60 - 10 :]
    frame = cs.sweep(tail)
    assert frame["eccentricity_mm"].to_list() == [0.8] * 10
    assert frame["output_pin_diameter_mm"][-1] == 22
    assert frame["variant"][-1] == 2**60 - 1


ENDS = st.none() | st.integers(-120, 120)


@given(first=st.builds(slice, ENDS, ENDS), second=st.builds(slice, ENDS, ENDS))
@settings(deadline=None, max_examples=100)
def test_slices_keep_the_variants_values(first: slice, second: slice) -> None:
    whole = cs.Space.sobol(cs.Drive.reference_87(), 97, seed=1, **AXES)
    expected = list(range(97))[first][second]
    cut = whole[first][second]
    assert len(cut) == len(expected)
    assert cs.sweep(cut)["variant"].to_list() == expected
    if expected:
        assert cut[0] == whole[expected[0]]
        assert cut[-1] == whole[expected[-1]]


def test_a_space_is_cut_in_steps_of_one(reference: cs.Drive) -> None:
    space = cs.Space.grid(reference, output_pin_count=[6, 8])
    with pytest.raises(ValueError, match="steps of one"):
        space[::2]
    with pytest.raises(IndexError):
        space[2]
    assert [drive.output_pin_count for drive in cast("Iterable[cs.Drive]", space)] == [6, 8]


def test_the_one_space_too_large_for_len(reference: cs.Drive) -> None:
    space = cs.Space.sobol(reference, 2**63, eccentricity_mm=(0.3, 0.8))
    with pytest.raises(OverflowError, match="one too many for len"):
        len(space)
    assert len(space[1:]) == 2**63 - 1
