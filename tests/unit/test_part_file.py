"""Files of parts: the core's writer beside polars' on the same columns."""

from __future__ import annotations

import errno
from io import BytesIO
from pathlib import Path

import numpy as np
import polars as pl
import pyarrow.parquet as pq
import pytest

import cyclosweep as cs
import cyclosweep._core as _core
from cyclosweep.sweep.kernel_columns import stretch_arrays
from cyclosweep.sweep.part_file import write_arrays, write_rows
from cyclosweep.sweep.summary import summary_of_part

DRIVE = cs.Drive.reference_87()
PARTS = {"ring_pin_radius_mm": 2.0, "disc_width_mm": 12.0, "ring_clearance_mm": 0.02}

STUDIES = {
    "random, some refused": cs.Study(
        cs.Space.sobol(
            DRIVE, 3000, seed=3, output_pin_count=(4, 30), output_pin_diameter_mm=(5.0, 40.0)
        )
    ),
    "grid of limits": cs.Study(
        cs.Space.grid(
            DRIVE,
            eccentricity_mm=cs.linspace(0.3, 0.8, 40),
            criterion=["inside", "statics"],
            disc_count=[1, 2, 3],
        ),
        limits=(("active_pins_mean", 7.0, float("inf")),),
    ),
    "with a train": cs.Study(cs.Space.grid(DRIVE, load_inertia_kg_m2=cs.linspace(1, 20, 300))),
    "one row": cs.Study(cs.Space.grid(DRIVE, eccentricity_mm=[0.6])),
    "all refused": cs.Study(cs.Space.grid(DRIVE, output_pin_diameter_mm=[60.0, 70.0])),
    "components": cs.Study(
        cs.Space.grid(
            DRIVE.replace(**PARTS),
            ring_clearance_mm=[0.0, 0.01, 0.02],
            output_pin_diameter_mm=[10.0, 16.0, 60.0],
        ),
        model="components",
    ),
}


@pytest.mark.parametrize("name", STUDIES)
def test_the_file_is_that_of_polars(name: str, tmp_path: Path) -> None:
    study = STUDIES[name]
    names = study.computed()
    arrays = stretch_arrays(study, names, 0, len(study))
    rows = pl.DataFrame(arrays.series(names))
    ours, theirs = tmp_path / "ours.parquet", tmp_path / "theirs.parquet"
    write_arrays(arrays, rows, ours, {"key": "text"}, 1000)
    write_rows(rows, theirs, {"key": "text"}, 1000)
    found = pl.read_parquet(ours)
    assert found.schema == rows.schema == study.schema()
    assert found.equals(rows)
    assert pl.read_parquet_metadata(ours) == pl.read_parquet_metadata(theirs)
    here, there = pq.ParquetFile(ours), pq.ParquetFile(theirs)
    assert here.schema_arrow.equals(there.schema_arrow)
    assert here.read().equals(there.read())
    assert here.num_row_groups == there.num_row_groups == -(-len(study) // 1000)
    for group in range(here.num_row_groups):
        for column in range(here.metadata.num_columns):
            mine = here.metadata.row_group(group).column(column)
            other = there.metadata.row_group(group).column(column)
            assert mine.path_in_schema == other.path_in_schema
            assert mine.statistics.null_count == other.statistics.null_count
            assert mine.statistics.has_min_max == other.statistics.has_min_max
            assert mine.statistics.min == other.statistics.min
            assert mine.statistics.max == other.statistics.max


@pytest.mark.parametrize("name", STUDIES)
def test_ranges_from_arrays_are_those_of_the_table(name: str) -> None:
    study = STUDIES[name]
    names = study.computed()
    arrays = stretch_arrays(study, names, 0, len(study))
    rows = pl.DataFrame(arrays.series(names))
    quick = summary_of_part(rows, 0, len(study), study, arrays.reals())
    assert quick == summary_of_part(rows, 0, len(study), study)
    assert quick.ranges or name == "all refused"


def test_a_filter_on_a_result_is_pushed_down_and_right(tmp_path: Path) -> None:
    study = STUDIES["random, some refused"]
    cs.sink(study.space, tmp_path / "study", rows_per_part=1000)
    found = cs.scan_dataset(tmp_path / "study").filter(pl.col("active_pins_mean") > 9).collect()
    whole = cs.sweep(study.space)
    assert found.equals(whole.filter(pl.col("active_pins_mean") > 9))
    assert 0 < found.height < whole.height


def _write(path: Path, columns: list[object], rows: int = 3) -> None:
    """Write columns of real numbers "a", "c" beside counts "b"."""
    template, others = BytesIO(), BytesIO()
    schema = {"a": pl.Float64, "b": pl.UInt32, "c": pl.Float64}
    pl.DataFrame(schema=schema).write_parquet(template)
    counts = np.arange(rows, dtype=np.uint32)
    pl.DataFrame({"b": counts}).write_parquet(others)
    _core.write_parquet(
        str(path),
        template.getvalue(),
        others.getvalue(),
        [],
        columns,  # type: ignore[arg-type]
        rows,
        1_000_000,
    )


def test_columns_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    first, last = np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0])
    _write(tmp_path / "good.parquet", [(first, None), None, (last, np.array([True, False, True]))])
    found = pl.read_parquet(tmp_path / "good.parquet").to_dict(as_series=False)
    assert found == {"a": [1.0, 2.0, 3.0], "b": [0, 1, 2], "c": [4.0, None, 6.0]}
    bad: list[list[object]] = [
        [(first, None), None, (last[:2], None)],
        [(first, np.array([True])), None, (last, None)],
        [(first, None), None],
        [None, (first, None), (last, None)],
        [(first, None), (last, None), (last, None)],
    ]
    for columns in bad:
        with pytest.raises(ValueError, match=r"columns|column"):
            _write(tmp_path / "bad.parquet", columns)


@pytest.mark.parametrize(
    ("path", "number"), [("/dev/full", errno.ENOSPC), ("/nowhere/at/all", errno.ENOENT)]
)
def test_an_error_of_the_system_keeps_its_number(path: str, number: int) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full on this system")
    many = np.zeros(100_000)
    with pytest.raises(OSError, match=path) as raised:
        _write(Path(path), [(many, None), None, (many, None)], len(many))
    assert raised.value.errno == number
