"""Committed values of a few hundred variants: numbers that move must be seen to move.

`make golden` (`python -m tests.golden.regenerate`) writes them anew; CHANGELOG says why.
"""

from __future__ import annotations

import polars as pl
from polars.testing import assert_frame_equal

from tests.golden.regenerate import GOLDEN, variants


def test_no_value_has_moved() -> None:
    found = variants()
    schema = {name: pl.String if t == pl.Boolean else t for name, t in found.schema.items()}
    golden = pl.read_csv(GOLDEN, schema=schema)
    flags = [name for name, t in found.schema.items() if t == pl.Boolean]
    assert_frame_equal(
        found.with_columns(pl.col(flags).cast(pl.String)),
        golden,
        check_exact=False,
        rel_tol=1e-12,
        abs_tol=1e-300,
    )


def test_the_golden_rows_are_worth_having() -> None:
    found = variants()
    assert found["status"].n_unique() >= 4
    assert found.filter(status="ok")["criterion"].n_unique() == 3
    assert found.filter(status="ok").height > 150
    assert GOLDEN.stat().st_size < 100_000
