"""Recordings rewritten as laboratories write them are understood by `cyclosweep inspect` alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.recording.inspection import Inspection, inspect
from cyclosweep.recording.proposed import Known
from tests.support.arrays import Floats, present
from tests.support.lab_files import STYLES, rewrite

EXAMPLE = Path(__file__).parents[2] / "examples" / "measured-13-to-1"


def understood(path: Path, drive: cs.Drive, side: str) -> Inspection:
    return inspect(
        path, Known(drive, "reference-87", "output" if side == "output" else "input"), {}
    )


def columns_of(recording: cs.Recording) -> dict[str, Floats]:
    """Columns of a canonical recording by role."""
    return {
        name: np.asarray(values, dtype=np.float64)
        for name in ("time_s", "torque_nm", "angle_deg", "run", "crank_deg", "temperature_c")
        if (values := getattr(recording, name)) is not None
    }


def made_up(seed: int) -> dict[str, Floats]:
    """Two runs of the reference drive, the clock of which goes past a thousand seconds."""
    rng = np.random.default_rng(seed)
    torque = 20 * np.sin(np.linspace(0, 25, 600))
    angle = 28 * np.sign(torque) + 2.73 * torque + 0.05 * rng.normal(size=600)
    return {
        "time_s": np.arange(600.0) + np.repeat([0.0, 5000.0], 300),
        "torque_nm": torque,
        "angle_deg": angle,
        "run": np.repeat([1.0, 2.0], 300),
        "crank_deg": np.repeat([10.0, 20.0], 300),
        "temperature_c": np.linspace(20, 30, 600),
    }


@pytest.mark.parametrize("style", STYLES)
def test_every_style_is_understood(tmp_path: Path, reference: cs.Drive, style: str) -> None:
    table = made_up(4)
    found = understood(rewrite(table, style, tmp_path, "loop"), reference, "input")
    assert found.proposal.open == []
    recording = found.recording
    assert recording is not None
    np.testing.assert_allclose(recording.torque_nm, table["torque_nm"], atol=1e-8)
    np.testing.assert_allclose(present(recording.angle_deg), table["angle_deg"], atol=1e-7)
    np.testing.assert_allclose(present(recording.time_s), table["time_s"], atol=1e-6)
    np.testing.assert_array_equal(recording.run, table["run"])
    np.testing.assert_allclose(present(recording.crank_deg), table["crank_deg"], atol=1e-8)
    np.testing.assert_allclose(present(recording.temperature_c), table["temperature_c"], atol=1e-8)


@pytest.mark.shared
@pytest.mark.parametrize(
    ("file", "style"),
    [
        ("other-rigs/foot-cam1-x33.csv", "german text"),
        ("other-rigs/wall-no-clock.csv", "american text"),
        ("practice/case-002/recording.csv", "workbook"),
        ("practice/case-008/recording.csv", "matlab"),
        ("practice/case-004/recording.csv", "tdms"),
    ],
)
def test_a_shared_recording_rewritten_reads_the_same(
    shared_recordings: Path, tmp_path: Path, file: str, style: str
) -> None:
    own = cs.Recording.read(shared_recordings / file)
    assert own.drive is not None
    rewritten = rewrite(columns_of(own), style, tmp_path, "loop")
    again = understood(rewritten, cs.Drive.load(own.drive), own.side).recording
    assert again is not None
    np.testing.assert_allclose(again.torque_nm, own.torque_nm, atol=1e-7)
    np.testing.assert_allclose(present(again.angle_deg), present(own.angle_deg), atol=1e-6)
    assert again.angle_resolution_deg == pytest.approx(own.angle_resolution_deg)
    assert (again.history, again.runs) == (own.history, own.runs)


@pytest.mark.shared
def test_the_verdict_of_a_rewritten_recording(shared_recordings: Path, tmp_path: Path) -> None:
    own = cs.Recording.read(shared_recordings / "practice" / "case-002" / "recording.csv")
    drive = cs.Drive.reference_87()
    path = rewrite(columns_of(own), "german text", tmp_path, "loop")
    again = understood(path, drive, "input").recording
    assert again is not None
    found = [cs.diagnose(r, drive, full=False) for r in (own, again)]
    assert found[0].verdict == found[1].verdict
    assert [e["name"] for e in found[0].effects] == [e["name"] for e in found[1].effects]


@pytest.mark.shared
@pytest.mark.parametrize("ramp", ["base_runin1", "base910_unr_cold5"])
def test_the_metadata_of_a_ramp_are_proposed(shared_recordings: Path, ramp: str) -> None:
    (path,) = shared_recordings.glob(f"cycloidal-13-to-1/*__{ramp}.csv.gz")
    own = cs.Recording.read(path, EXAMPLE / "recording.toml")
    drive = cs.Drive.from_toml(EXAMPLE / "drive.toml")
    recording = inspect(path, Known(drive, str(EXAMPLE / "drive.toml")), {}).recording
    assert recording is not None
    for name in ("side", "history", "runs", "conditioning_runs", "holdout_runs", "torque_from"):
        assert getattr(recording, name) == getattr(own, name), name
    np.testing.assert_allclose(recording.torque_nm, own.torque_nm, atol=1e-9)
    np.testing.assert_allclose(present(recording.angle_deg), present(own.angle_deg), atol=1e-9)
