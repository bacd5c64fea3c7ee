"""Recordings along the component model's curves: rest between the branches, truth kept apart."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep_challenge.component_rig.command import write_recording
from cyclosweep_challenge.component_rig.rig import Curve

EXAMPLE = Path(__file__).parents[3] / "examples" / "components-87.toml"


def straight() -> Curve:
    """Play of 2 deg each side, 1 N m/deg beyond, friction of a tenth."""
    angle = np.linspace(-12.0, 12.0, 241)
    beyond = np.sign(angle) * np.maximum(np.abs(angle) - 2.0, 0.0)
    friction = 0.1 * np.abs(beyond)
    return Curve(angle, beyond + friction, beyond - friction)


def test_the_crank_rests_between_the_branches() -> None:
    torque = np.array([0.0, 5.5, 5.0, 4.6, 4.5, 4.0, 0.0, -5.5, -4.0])
    found = straight().follow(torque)
    # Loading by 1.1, unloading by 0.9 of the elastic torque; rest in between.
    expected = [0.0, 7.0, 7.0, 7.0, 7.0, 2.0 + 4.0 / 0.9, 2.0, -7.0, -2.0 - 4.0 / 0.9]
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_a_recording_of_a_drive_s_curves(tmp_path: Path) -> None:
    drive = cs.Drive.from_toml(EXAMPLE)
    files = {}
    for crank in (0.0, 30.0):
        curve = drive.torque_twist("input", crank)
        curve.table.write_csv(tmp_path / f"{crank:g}.csv")
        files[crank] = tmp_path / f"{crank:g}.csv"
    out = tmp_path / "rig"
    write_recording(files, out, drive="reference-87", seed=3, samples=200)
    assert not (out / "truth.json").exists()
    truth = json.loads((tmp_path / "rig-truth.json").read_text())
    recording = cs.Recording.read(out / "recording.csv")
    assert recording.angle_deg is not None
    assert recording.angle_resolution_deg == pytest.approx(0.1)
    clean = np.array(truth["clean_deg"])
    assert np.std(recording.angle_deg - clean) == pytest.approx(0.1, rel=0.2)
    # Loading at the largest torque is the curve's own angle there.
    largest = 0.9 * min(Curve.read(files[0.0]).largest_torque(), 1e9)
    table = pl.read_csv(files[0.0]).filter(pl.col("angle_deg") > 0)
    loading, angle = table["loading_torque_nm"].to_numpy(), table["angle_deg"].to_numpy()
    assert clean[:200].max() == pytest.approx(angle[np.argmax(loading >= largest)], abs=0.5)


def test_a_curve_without_friction_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    cs.Drive.from_toml(EXAMPLE).torque_twist("output", points=5).table.write_csv(path)
    with pytest.raises(ValueError, match="--side input"):
        Curve.read(path)
    path.write_text("angle_deg\n1\n")
    with pytest.raises(ValueError, match="expected columns"):
        Curve.read(path)
