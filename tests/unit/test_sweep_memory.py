"""Memory lent to tables: never taken back while anybody sees it, and not too much of it kept."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.sweep import memory

COUNT = 2**18


@pytest.fixture(autouse=True)
def empty_pool() -> Iterator[None]:
    gc.collect()
    memory._free.clear()
    yield
    memory._free.clear()


def test_a_block_comes_back_when_its_last_view_is_gone() -> None:
    block = memory.take(COUNT)
    address = block.ctypes.data
    row = block.reshape(4, -1)[2]
    del block
    gc.collect()
    assert not memory._free
    del row
    gc.collect()
    assert [free.ctypes.data for free in memory._free] == [address]
    assert memory.take(COUNT).ctypes.data == address


def test_a_column_keeps_its_block() -> None:
    block = memory.take(COUNT)
    block[:] = 1.0
    column = pl.Series("x", block.reshape(2, -1)[1])
    del block
    gc.collect()
    other = memory.take(COUNT)
    other[:] = 2.0
    assert column.eq(1.0).all()


def test_a_frame_is_left_alone_by_the_next_sweeps() -> None:
    space = cs.Space.sobol(cs.Drive.reference_87(), 20_000, seed=3, eccentricity_mm=(0.3, 0.9))
    first = cs.sweep(space)
    copy = pl.DataFrame({name: first[name].to_list() for name in ("status", "eccentricity_mm")})
    twist = first["twist_4tn_deg"]
    values = twist.to_list()
    del first
    for seed in range(3):
        cs.sweep(
            cs.Space.sobol(cs.Drive.reference_87(), 20_000, seed=seed, eccentricity_mm=(0.1, 1))
        )
    assert twist.to_list() == values
    assert cs.sweep(space)["eccentricity_mm"].to_list() == copy["eccentricity_mm"].to_list()


def test_nothing_of_an_older_table_shines_through() -> None:
    space = cs.Space.sobol(cs.Drive.reference_87(), 20_000, seed=3, eccentricity_mm=(0.3, 1.4))
    fresh = cs.sweep(space)
    blocks = [memory.take(count) for count in (COUNT, 20_000 * len(fresh.columns))]
    for block in blocks:
        block[:] = np.pi
    del block, blocks
    gc.collect()
    assert cs.sweep(space).equals(fresh)


def test_only_so_much_is_kept() -> None:
    size = memory.MOST_KEPT // 8 // 3
    blocks = [memory.take(size) for _ in range(5)]
    blocks.append(memory.take(memory.MOST_KEPT // 8 + 1))
    del blocks
    gc.collect()
    assert sum(block.nbytes for block in memory._free) <= memory.MOST_KEPT


def _counts(count: int) -> npt.NDArray[np.uint32]:
    return np.empty(count, np.uint32)


def test_memory_of_another_size_is_refused() -> None:
    core = cs.Study.of(cs.Space.grid(cs.Drive.reference_87())).core
    with pytest.raises(ValueError, match="memory for 3 numbers, expected 1 times 1"):
        core.fill_range(0, 1, [], ["hole_web_mm"], [False], np.empty(3), _counts(0))
    with pytest.raises(ValueError, match="memory for 3 numbers, expected 1 times 1"):
        core.fill_range(0, 1, [], ["active_pins_min"], [True], np.empty(0), _counts(3))
    with pytest.raises(ValueError, match="memory for 3 numbers"):
        core.fill_axes([], 0, 1, np.empty(3))
