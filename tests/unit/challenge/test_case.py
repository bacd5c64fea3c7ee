"""A concealed case is as visible as asked, tells nothing, and comes out the same twice."""

from pathlib import Path

import numpy as np
import polars as pl
import pytest

from cyclosweep_challenge import ALIASES, NOISES, VOCABULARY, ConcealmentError, make_case
from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import make_programme
from cyclosweep_challenge.rig.specimen import Specimen
from cyclosweep_challenge.trial.concealment import conceal
from cyclosweep_challenge.trial.oracle import oracle_d, oracle_power


@pytest.mark.parametrize("name", VOCABULARY)
def test_d_is_as_wanted(name: str) -> None:
    truth = make_case(21, effects=(name,), d=12.0, samples=900).truth
    (cause,) = truth["causes"]
    assert cause["name"] == name
    assert cause["d"] == pytest.approx(12.0, rel=3e-3)
    white = 12.0 * truth["noise"]["sigma_deg"] / np.sqrt(truth["readings"])
    assert cause["rms_deg"] == pytest.approx(white, rel=3e-3)


def test_two_causes_each_have_their_own_d() -> None:
    case = make_case(5, effects=("friction_hysteresis", "creep"), d=(80.0, 8.0), samples=900)
    assert [round(c["d"], 1) for c in case.truth["causes"]] == pytest.approx([80.0, 8.0], rel=5e-3)


@pytest.mark.parametrize("noise", NOISES)
def test_oracle_has_the_mean_and_spread_it_claims(noise: str) -> None:
    z = [
        make_case(s, effects=("load_asymmetry",), d=4.0, programme="poor", noise=noise).truth[
            "causes"
        ][0]["oracle_z"]
        for s in range(60)
    ]
    assert np.mean(z) == pytest.approx(4.0, abs=0.35)
    assert np.std(z) == pytest.approx(1.0, abs=0.25)


def test_oracle_power_curve() -> None:
    assert oracle_power(0.0) == pytest.approx(0.01)
    assert oracle_power(oracle_d()) == pytest.approx(0.9, abs=1e-3)


@pytest.mark.parametrize("name", ALIASES)
def test_aliases_are_absorbed_whole(name: str) -> None:
    case = make_case(9, effects=(name,), samples=600)
    frame = case.recording
    torque = frame["torque_nm"].to_numpy()
    table = np.column_stack([np.ones_like(torque), np.sign(torque), torque])
    angle = frame["angle_deg"].to_numpy()
    left = angle - table @ np.linalg.lstsq(table, angle)[0]
    assert np.std(left) == pytest.approx(0.2, rel=0.15)
    assert case.truth["effects"] == []


def test_written_files_are_canonical_and_silent(tmp_path: Path) -> None:
    case = make_case(3, effects=("creep",), samples=300)
    case.write(tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == [
        "program.csv",
        "recording.csv",
        "recording.toml",
    ]
    recording = pl.read_csv(tmp_path / "recording.csv")
    assert recording.columns == [
        "time_s",
        "torque_nm",
        "angle_deg",
        "run",
        "crank_deg",
        "temperature_c",
    ]
    assert "angle_deg" not in pl.read_csv(tmp_path / "program.csv").columns
    assert all("creep" not in p.read_text() for p in tmp_path.iterdir())


def test_same_seed_same_case_other_seed_other_case() -> None:
    one, again, other = (make_case(s, effects=("creep",), samples=300) for s in (4, 4, 5))
    assert one.recording.equals(again.recording)
    assert one.truth == again.truth
    assert not one.recording.equals(other.recording)


def test_what_a_programme_cannot_show_is_refused() -> None:
    with pytest.raises(ConcealmentError, match="invisible"):
        make_case(3, effects=("transmission_error",), programme="poor", samples=300)


def test_divided_dial_reads_only_its_divisions() -> None:
    angle = make_case(3, noise="resolution", samples=300).recording["angle_deg"].to_numpy()
    np.testing.assert_allclose(angle, np.round(angle / 0.5) * 0.5, atol=1e-9)


def test_recording_without_a_reading_cannot_be_concealed() -> None:
    # At some sizes every reading fell into the dead zone, and the draw ended in an IndexError.
    streams = np.random.default_rng(1).spawn(3)
    programme = make_programme("rich", streams[1], 300)
    lost = np.ones(len(programme), dtype=bool)
    noise = Noise.draw("white", streams[2], 0.05, 0.0)
    with pytest.raises(ConcealmentError, match="every sample"):
        conceal(Specimen.draw(streams[0]), programme, noise, ["creep"], [10.0], [1.0], lost, {})
