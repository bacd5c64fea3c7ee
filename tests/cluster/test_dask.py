"""Dask: a worker killed in the middle, a scheduler lost, and what a task carries."""

import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any, cast

import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.sweep import executors
from cyclosweep.sweep.attempts import write_parts
from cyclosweep.sweep.dataset import Dataset
from cyclosweep.sweep.executors import dask_executor

distributed = pytest.importorskip("distributed", reason="the dask extra is not installed")
pytestmark = [
    pytest.mark.filterwarnings("default"),
    pytest.mark.skipif(sys.platform == "win32", reason="needs signals of POSIX"),
]

COUNT, ROWS = 2**19, 2**14


def space() -> cs.Space:
    return cs.Space.sobol(
        cs.Drive.reference_87(), COUNT, eccentricity_mm=(0.3, 0.8), output_pin_count=(6, 12)
    )


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> pl.DataFrame:
    folder = tmp_path_factory.mktemp("alone")
    cs.sink(space(), folder, rows_per_part=ROWS, progress=False)
    return cs.scan_dataset(folder).collect()


def first_part_in(folder: Path, seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if any(folder.glob("part-*.parquet")):
            return
        time.sleep(0.01)
    raise AssertionError("no part was written")


def test_a_worker_killed_in_the_middle_changes_nothing(tmp_path: Path, alone: pl.DataFrame) -> None:
    folder = tmp_path / "study"
    with dask_executor(2, None) as executor:
        pids = list(cast("Any", executor)._client.run(os.getpid).values())
        assert len(pids) == 2

        def kill() -> None:
            first_part_in(folder)
            os.kill(pids[0], signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        summary = cs.sink(space(), folder, rows_per_part=ROWS, executor=executor, progress=False)
        killer.join()
    assert summary.rows == COUNT
    assert cs.scan_dataset(folder).collect().equals(alone)


def test_the_dask_engine_writes_the_same_dataset(tmp_path: Path, alone: pl.DataFrame) -> None:
    cs.sink(space(), tmp_path, rows_per_part=ROWS, engine="dask", workers=2, progress=False)
    assert cs.scan_dataset(tmp_path).collect().equals(alone)


def test_a_lost_scheduler_is_one_error_and_the_same_call_resumes(
    tmp_path: Path, alone: pl.DataFrame
) -> None:
    folder = tmp_path / "study"
    address = tmp_path / "scheduler.json"
    scheduler = subprocess.Popen(
        [
            *(sys.executable, "-m", "distributed.cli.dask_scheduler"),
            *("--port", "0", "--no-dashboard", "--scheduler-file", str(address)),
        ],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    worker = subprocess.Popen(
        [
            *(sys.executable, "-m", "distributed.cli.dask_worker"),
            *("--scheduler-file", str(address), "--no-nanny", "--nthreads", "1"),
            "--no-dashboard",
        ],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        end = time.monotonic() + 60
        while not address.exists() and time.monotonic() < end:
            time.sleep(0.05)
        time.sleep(0.2)
        where = json.loads(address.read_text())["address"]

        def kill() -> None:
            first_part_in(folder)
            scheduler.kill()

        killer = threading.Thread(target=kill)
        killer.start()
        with pytest.raises(cs.SweepError, match="scheduler is gone"):
            cs.sink(
                space(),
                folder,
                rows_per_part=ROWS,
                engine="dask",
                scheduler=where,
                progress=False,
            )
        killer.join()
    finally:
        for process in (scheduler, worker):
            process.kill()
            process.wait()
    cs.sink(space(), folder, rows_per_part=ROWS, progress=False)
    assert cs.scan_dataset(folder).collect().equals(alone)


def test_a_scheduler_that_is_not_there_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(executors, "_CONNECT_S", 0.5)
    with pytest.raises(cs.SweepError, match=r"scheduler tcp://127\.0\.0\.1:9: "):
        cs.sink(
            space(),
            tmp_path / "study",
            engine="dask",
            scheduler="tcp://127.0.0.1:9",
            progress=False,
        )


def test_a_task_is_small(tmp_path: Path) -> None:
    dataset = Dataset(cs.Study.of(space()), tmp_path, ROWS)
    dataset.study.core.evaluate_range(0, 10, [])
    assert len(pickle.dumps((write_parts, dataset, [dataset.part(0)]))) < 20_000


def test_what_is_no_address_of_a_scheduler_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(cs.InputError, match="scheduler tcp://x: missing port"):
        cs.sink(
            cs.Space.grid(cs.Drive.reference_87()), tmp_path, engine="dask", scheduler="tcp://x"
        )
