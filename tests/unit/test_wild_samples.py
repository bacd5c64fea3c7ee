"""A single sample far off decides neither whether angle and torque are related, nor the side."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.unit.test_inspect import inspected, loop, write


@pytest.mark.parametrize("place", [30, 200])
def test_one_wild_angle(tmp_path: Path, place: int) -> None:
    time, torque, angle, _ = loop("output")
    angle[place] = 9999.0
    path = write(tmp_path / "loop.csv", "time_s,torque_nm,angle_deg", time, torque, angle)
    found = inspected(path, "--drive", "reference-87", "--out", str(tmp_path / "loop.toml"))
    assert found["metadata"]["side"] == "output"
    assert found["checks"] == []
    recording = cs.Recording.read(path)
    assert recording.blocking_fault is None
    answer = cs.diagnose(recording, full=False)
    assert answer.verdict not in {"DATA_FAULT", "INSUFFICIENT_DATA"}
    assert "single_outliers" in {fault.kind for fault in answer.recording.faults}


@pytest.mark.parametrize("run", [[1.2] * 5 + [1.7] * 5, [1.0] * 9 + [np.nan]])
def test_runs_that_are_no_whole_numbers_are_refused(run: list[float]) -> None:
    with pytest.raises(cs.InputError, match=r"run, sample \d+: found .*, expected an integer"):
        cs.Recording.from_arrays(np.arange(10.0), np.arange(10.0), run=run)
    whole = cs.Recording.from_arrays(np.arange(4.0), np.arange(4.0), run=[1.0, 1.0, 2.0, 2.0])
    assert whole.runs == (1, 2)
