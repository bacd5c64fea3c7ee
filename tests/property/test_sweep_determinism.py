"""Equal bits whatever the number of threads and however a study is cut."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cyclosweep as cs
from tests.property.determinism_sweep import digest, spaces

SCRIPT = Path(__file__).parent / "determinism_sweep.py"
ROWS = 12_423  # of the grid; no multiple of any block


def test_equal_bits_on_any_number_of_threads() -> None:
    digests = set()
    for threads in ("1", "2", "5"):
        environment = {**os.environ, "RAYON_NUM_THREADS": threads, "POLARS_MAX_THREADS": threads}
        done = subprocess.run(
            [sys.executable, str(SCRIPT)],
            capture_output=True,
            text=True,
            check=True,
            env=environment,
        )
        digests.add(done.stdout)
    digests.add("".join(f"{digest(cs.sweep(space))}\n" for space in spaces()))
    assert len(digests) == 1


@pytest.mark.parametrize("number", range(4))
@pytest.mark.parametrize("pieces", [2, 7])
def test_equal_bits_in_any_sharding(number: int, pieces: int) -> None:
    space = spaces()[number]
    whole = cs.sweep(space)
    edges = np.linspace(0, len(space), pieces + 1).astype(int).tolist()
    parts = [cs.sweep(space[a:b]) for a, b in itertools.pairwise(edges)]
    assert digest(pl.concat(parts)) == digest(whole)


@given(start=st.integers(0, ROWS), rows=st.integers(0, 9000))
@settings(deadline=None, max_examples=30)
def test_equal_bits_in_any_slice(start: int, rows: int) -> None:
    space = spaces()[0]
    assert len(space) == ROWS
    cut = space[start : start + rows]
    assert digest(cs.sweep(cut)) == digest(cs.sweep(space)[start : start + rows])


def test_equal_bits_when_variants_are_picked() -> None:
    for space in spaces():
        whole = cs.sweep(space)
        scattered = pl.col("variant") % 7 == 3
        picked = cs.scan(space).filter(scattered).collect()
        assert digest(picked) == digest(whole.filter(scattered))


def test_equal_bits_from_a_grid_and_from_a_table_of_its_values() -> None:
    """A grid's stages are computed once per combination; a table's for every variant."""
    space = spaces()[0]
    grid = cs.sweep(space)
    names = [axis.name for axis in space.axes]
    table = cs.sweep(cs.Space.table(space.drive, grid.select(names)))
    assert digest(table) == digest(grid)


def test_equal_bits_for_one_drive_alone() -> None:
    for space in spaces():
        frame = cs.sweep(space).filter(status="ok")
        for row in frame[:: len(frame) // 20].iter_rows(named=True):
            for name, value in space[row["variant"]].evaluate().items():
                assert row[name] == value
