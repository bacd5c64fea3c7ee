"""The measured and the practice recordings are read as their descriptions say."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs

pytestmark = pytest.mark.shared
EXAMPLE = Path(__file__).parents[2] / "examples" / "measured-13-to-1"
RAMPS = ("base_runin1", "base_runin5", "conic_runin1", "base910_unr_runin1", "base910_unr_cold5")


@pytest.mark.parametrize("ramp", RAMPS)
def test_measured_ramps(shared_recordings: Path, ramp: str) -> None:
    (path,) = shared_recordings.glob(f"cycloidal-13-to-1/*__{ramp}.csv.gz")
    recording = cs.Recording.read(path, EXAMPLE / "recording.toml")
    assert recording.runs == (100, 101, 102)
    assert recording.conditioning_runs == (100,)
    assert recording.holdout_runs == (102,)
    assert recording.history == "continuous"
    assert recording.side == "output"
    assert recording.drive == str(EXAMPLE / "drive.toml")
    assert recording.blocking_fault is None
    # 12 s a ramp within |command| <= 24 N m at 64 ticks a second
    assert recording.unscored is not None
    scored = ~recording.unscored
    assert all(750 < np.count_nonzero(scored & (recording.run == r)) < 790 for r in recording.runs)
    assert recording.torque_from == "motor-current"
    assert recording.time_s is not None
    assert recording.angle_deg is not None
    within = np.diff(recording.run) == 0
    assert (np.diff(recording.time_s)[within] > 0).all()
    assert np.ptp(recording.angle_deg) < 20
    assert 15 < np.abs(recording.torque_nm[scored]).max() < 26
    long = [b for b in recording.structure.branches if b.stop - b.start > 100]
    assert len(long) == 12


def test_practice_recordings(shared_recordings: Path) -> None:
    folders = sorted((shared_recordings / "practice").glob("case-*"))
    assert len(folders) >= 9
    for folder in folders:
        recording = cs.Recording.read(folder / "recording.csv")
        program = cs.Recording.read(folder / "program.csv")
        assert recording.drive == "reference-87"
        assert recording.faults == ()
        assert recording.notes == ()
        assert program.is_program
        assert program.faults == ()
        assert len(recording.structure.branches) >= 2 * len(recording.runs)
