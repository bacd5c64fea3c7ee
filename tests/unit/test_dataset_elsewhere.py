"""Datasets that other programs read, older folders, and studies too large for any disk."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from pathlib import Path

import duckdb
import pandas as pd
import polars as pl
import pyarrow.dataset
import pytest
from polars.testing import assert_frame_equal

import cyclosweep as cs
from cyclosweep.atomic import unfinished

SPACE = cs.Space.grid(
    cs.Drive.reference_87(), eccentricity_mm=[0.4, 0.6, 0.9], output_pin_count=[6, 8, 9]
)
COLUMNS = ["variant", "eccentricity_mm", "output_pin_count", "twist_1tn_deg"]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    cs.sink(SPACE, tmp_path / "ein Ordner", rows_per_part=4)
    return tmp_path / "ein Ordner"


def test_pandas_reads_the_folder(folder: Path) -> None:
    table = pd.read_parquet(folder)
    expected = cs.sweep(SPACE)
    assert table["status"].astype(str).to_list() == expected["status"].to_list()
    for name in COLUMNS:
        found = pl.Series(name, table[name].to_numpy(), nan_to_null=name.startswith("twist"))
        assert found.to_list() == expected[name].to_list()


def test_a_part_that_is_being_written_is_passed_over_and_later_deleted(folder: Path) -> None:
    with unfinished(folder / "part-000001.parquet") as file:
        file.write_text("half a part")
        assert len(pd.read_parquet(folder)) == len(SPACE)
        assert pyarrow.dataset.dataset(folder).count_rows() == len(SPACE)
        killed = [Path(f"{file}.killed.tmp"), folder / "part-000002.parquet.host-1-1.tmp"]
        for path in killed:
            path.write_text("what a killed writer left")
        cs.sink(SPACE, folder, rows_per_part=4, resume=True)
        assert not any(path.exists() for path in killed)
        file.write_bytes((folder / "part-000001.parquet").read_bytes())


def test_pyarrow_reads_the_folder(folder: Path) -> None:
    table = pyarrow.dataset.dataset(folder).to_table(columns=COLUMNS)
    found = pl.DataFrame(table)
    assert_frame_equal(found, cs.sweep(SPACE).select(COLUMNS), check_exact=True)


def test_duckdb_reads_the_folder(folder: Path) -> None:
    with duckdb.connect() as connection:
        found = connection.execute(
            f"select status, count(*) from '{folder}/*.parquet' group by 1 order by 2"
        ).fetchall()
        best = connection.execute(
            f"select min(twist_1tn_deg) from '{folder}/*.parquet' where status = 'ok'"
        ).fetchall()
    expected = cs.sweep(SPACE)
    assert found == [("eccentricity_too_large_for_ring", 3), ("ok", 6)]
    assert best == [(expected["twist_1tn_deg"].min(),)]


def test_a_folder_with_the_manifest_under_its_former_name_goes_on(folder: Path) -> None:
    (folder / "_manifest.json").rename(folder / "manifest.json")
    (folder / "part-000001.parquet").unlink()
    before = (folder / "part-000000.parquet").stat().st_mtime_ns
    with pytest.raises(cs.InputError, match="holds another study"):
        cs.sink(SPACE[1:], folder, limits={"hole_web_mm": (1, None)}, rows_per_part=4)
    cs.sink(SPACE, folder, rows_per_part=4)
    assert sorted(path.name for path in folder.iterdir()) == [
        "_manifest.json",
        *(f"part-{number:06d}.parquet" for number in range(3)),
    ]
    assert (folder / "part-000000.parquet").stat().st_mtime_ns == before


def test_a_study_of_10_to_the_15_starts_at_once_in_constant_memory(tmp_path: Path) -> None:
    """Its first parts are written and the interruption leaves them and a manifest."""
    program = textwrap.dedent("""
        import resource, sys, time
        import cyclosweep as cs
        from cyclosweep.sweep import shards

        drive = cs.Drive.reference_87()
        steps = cs.linspace(0.3, 0.6, 10**5)
        space = cs.Space.grid(drive, eccentricity_mm=steps, free_play_deg=cs.linspace(0, 9, 10**5),
                              output_pin_length_mm=cs.linspace(20, 30, 10**5))
        assert len(space) == 10**15
        parts = 0
        def stop(self, amount):
            global parts
            parts += 1
            if parts == 3:
                raise KeyboardInterrupt
        shards.Progress.advance = stop
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        try:
            cs.sink(space, sys.argv[1], rows_per_part=1000)
        except KeyboardInterrupt:
            pass
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        print(grown / 1024, time.process_time())
    """)
    run = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    grown_mib, seconds = map(float, run.stdout.split())
    assert grown_mib < 200
    assert seconds < 20
    assert cs.scan_dataset(tmp_path).select(pl.len()).collect().item() >= 3000
    assert (tmp_path / "_manifest.json").exists()
