"""Workers that die or fail: retried, bounded, and the rest kept."""

import os
import signal
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import cyclosweep as cs
from cyclosweep.sweep import dataset
from cyclosweep.sweep.dataset import Dataset, Part
from cyclosweep.sweep.summary import PartSummary

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs signals of POSIX")

COUNT, ROWS = 2**14, 2**11


def space() -> cs.Space:
    return cs.Space.sobol(cs.Drive.reference_87(), COUNT, eccentricity_mm=(0.3, 0.8))


class KillsItsWorker(Dataset):
    """Kills the process that computes one part, once or always."""

    def write(self, part: Part) -> PartSummary:
        mark = self.folder / "killed"
        if part.index == 3 and (self.folder / "always").exists():
            os.kill(os.getpid(), signal.SIGKILL)
        if part.index == 3 and not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().write(part)


def test_a_killed_process_is_retried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dataset, "Dataset", KillsItsWorker)
    folder = tmp_path / "study"
    cs.sink(space(), folder, rows_per_part=ROWS, engine="processes", workers=2, progress=False)
    assert (folder / "killed").exists()
    assert cs.scan_dataset(folder).collect().equals(cs.sweep(space()))


def test_a_part_that_always_kills_its_worker_is_named_and_the_rest_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dataset, "Dataset", KillsItsWorker)
    folder = tmp_path / "study"
    folder.mkdir()
    (folder / "always").touch()
    with pytest.raises(cs.SweepError, match=r"part 3 failed: .*; 7 of 8 parts written"):
        cs.sink(space(), folder, rows_per_part=ROWS, engine="processes", workers=2, progress=False)
    assert len(list(folder.glob("part-*.parquet"))) == 7


class FailsAlways(Dataset):
    tried = 0

    def write(self, part: Part) -> PartSummary:
        if part.index == 5:
            type(self).tried += 1
            raise RuntimeError("no luck with this one")
        return super().write(part)


def test_a_part_that_always_fails_is_tried_thrice_and_told_at_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dataset, "Dataset", FailsAlways)
    with (
        ThreadPoolExecutor(2) as pool,
        pytest.raises(cs.SweepError, match=r"part 5 failed: no luck with this one; 7 of 8"),
    ):
        cs.sink(space(), tmp_path, rows_per_part=ROWS, executor=pool, progress=False)
    assert FailsAlways.tried == 3
    monkeypatch.undo()
    assert cs.sink(space(), tmp_path, rows_per_part=ROWS, progress=False).rows == COUNT
