"""Sweeps that are killed, interrupted or run out of disk leave whole parts and can go on."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import polars as pl
import pytest
from polars.testing import assert_frame_equal

import cyclosweep as cs
from cyclosweep.sweep.dataset import read_footer

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs signals of POSIX")

SCRIPT = Path(__file__).parent / "interrupted_sweep.py"
PARTS = 40
ROWS = 2000


@pytest.fixture(scope="module")
def whole() -> pl.DataFrame:
    return cs.sweep(space())


def space() -> cs.Space:
    return cs.Space.sobol(cs.Drive.reference_87(), PARTS * ROWS, seed=2, eccentricity_mm=(0.3, 0.8))


def go_on(folder: Path) -> None:
    cs.sink(space(), folder, rows_per_part=ROWS)


@contextlib.contextmanager
def running(folder: Path, engine: str) -> Iterator[subprocess.Popen[str]]:
    """Run a slowed-down sweep in a process group of its own, some parts already written."""
    process = subprocess.Popen(
        [sys.executable, str(SCRIPT), str(folder), str(PARTS * ROWS), str(ROWS), engine],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        deadline = time.monotonic() + 60
        while len(list(folder.glob("part-*.parquet"))) < 4:
            assert process.poll() is None, process.stderr and process.stderr.read()
            assert time.monotonic() < deadline
            time.sleep(0.01)
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate(timeout=30)


def whole_parts(folder: Path) -> int:
    """Count the parts, all of which must be whole."""
    paths = list(folder.glob("part-*.parquet"))
    for path in paths:
        assert read_footer(path) is not None, path
    return len(paths)


@pytest.mark.parametrize("engine", ["threads", "processes"])
def test_killed_in_the_middle(tmp_path: Path, engine: str, whole: pl.DataFrame) -> None:
    folder = tmp_path / "study"
    with running(folder, engine) as process:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait(timeout=30)
        assert 4 <= whole_parts(folder) < PARTS
        assert cs.scan_dataset(folder).collect().height % ROWS == 0
    go_on(folder)
    assert whole_parts(folder) == PARTS
    assert_frame_equal(cs.scan_dataset(folder).collect(), whole, check_exact=True)
    assert {path.suffix for path in folder.iterdir()} == {".parquet", ".json"}


def test_lock_of_a_writer_killed_after_its_part_goes(tmp_path: Path) -> None:
    folder = tmp_path / "study"
    go_on(folder)
    part = min(folder.glob("part-*.parquet"))
    (folder / f".{part.stem}.lock").touch()
    go_on(folder)
    assert {path.suffix for path in folder.iterdir()} == {".parquet", ".json"}


def test_killed_again_and_again(tmp_path: Path, whole: pl.DataFrame) -> None:
    folder = tmp_path / "study"
    for _ in range(3):
        before = whole_parts(folder)
        with running(folder, "threads") as process:
            while whole_parts(folder) < before + 5:
                time.sleep(0.005)
            process.kill()
            process.wait(timeout=30)
        assert before < whole_parts(folder) < PARTS
    go_on(folder)
    assert_frame_equal(cs.scan_dataset(folder).collect(), whole, check_exact=True)


def test_interrupted_from_the_keyboard(tmp_path: Path, whole: pl.DataFrame) -> None:
    folder = tmp_path / "study"
    with running(folder, "threads") as process:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=30)
        assert process.returncode not in (0, None)
        found = whole_parts(folder)
        assert 4 <= found < PARTS
        # An interrupted sweep has time to say what it left.
        manifest = json.loads((folder / "_manifest.json").read_text())
        assert len(manifest["parts"]) == found
        assert not list(folder.glob("*.tmp"))
    go_on(folder)
    assert_frame_equal(cs.scan_dataset(folder).collect(), whole, check_exact=True)


def test_two_sweeps_at_once(tmp_path: Path) -> None:
    folder = tmp_path / "study"
    with running(folder, "threads"), pytest.raises(cs.SweepError, match="another sweep"):
        go_on(folder)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs POSIX resource limits")
def test_a_file_size_limit_is_one_clear_error(tmp_path: Path) -> None:
    """A write that the system refuses: exit by SweepError, whole parts only."""
    code = (
        "import resource, sys, cyclosweep as cs\n"
        "sys.path.insert(0, sys.argv[2])\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))\n"
        "space = cs.Space.sobol(cs.Drive.reference_87(), 20_000, eccentricity_mm=(0.3, 0.8))\n"
        "try:\n"
        "    cs.sink(space, sys.argv[1], rows_per_part=5000)\n"
        "except cs.SweepError as error:\n"
        "    print(error)\n"
    )
    folder = tmp_path / "study"
    done = subprocess.run(
        [sys.executable, "-c", code, str(folder), ""], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") == 1
    assert "File too large" in done.stdout
    assert str(folder) in done.stdout
    assert whole_parts(folder) == 0
    assert not list(folder.glob("part-*"))


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """Mount three mebibytes of memory as a disk, where that is allowed."""
    mount = tmp_path / "disk"
    mount.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", str(mount)]
    try:
        done = subprocess.run(command, capture_output=True, check=False)
    except FileNotFoundError:
        pytest.skip("no mount here")
    if done.returncode:
        pytest.skip("mounting is not allowed here")
    yield mount
    subprocess.run(["umount", str(mount)], check=True)


def test_a_full_disk_keeps_whole_parts(small_disk: Path) -> None:
    filler = small_disk / "filler"
    filler.write_bytes(b"\0" * 2_397_152)
    folder = small_disk / "study"
    small = space()[:8000]
    with pytest.raises(cs.SweepError, match="No space left on device") as caught:
        cs.sink(small, folder, rows_per_part=1000)
    assert "\n" not in str(caught.value)
    assert not list(folder.glob("*.tmp"))
    left = whole_parts(folder)
    assert left < 8
    filler.unlink()
    before = {path: path.stat().st_mtime_ns for path in folder.glob("part-*.parquet")}
    assert cs.sink(small, folder, rows_per_part=1000).rows == 8000
    assert whole_parts(folder) == 8
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert cs.scan_dataset(folder).collect().equals(cs.sweep(small))
