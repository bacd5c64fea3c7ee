"""Play through which a rig turns the shaft: found in the angle, and kept out of the fit."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.turned_play import turned_play
from cyclosweep.simulation.effects.history import Floats
from cyclosweep_challenge.scoreboard.made_rig import COMPLIANCE_DEG_PER_NM, Friction
from cyclosweep_challenge.scoreboard.turned_rig import TurnedLoops, turned

DRIVE = cs.Drive.reference_87()


def read(loops: TurnedLoops) -> tuple[Floats, Floats]:
    """Torque and angle of a recording."""
    recording = turned(loops)
    assert recording.angle_deg is not None
    return recording.torque_nm, recording.angle_deg


def loaded(torque: Floats) -> Floats:
    return np.asarray(np.sign(torque) * (np.abs(torque) > 0.25 * np.abs(torque).max()))


@pytest.mark.parametrize("friction_nm", [0.0, 2.0, 6.0])
@pytest.mark.parametrize("noise_deg", [0.0, 0.2])
@pytest.mark.parametrize("play_deg", [4.0, 28.0])
def test_ends_of_the_play_are_those_of_the_rig_whatever_the_friction(
    friction_nm: float, noise_deg: float, play_deg: float
) -> None:
    loops = TurnedLoops(
        1,
        readings=600,
        noise_deg=noise_deg,
        play_deg=play_deg,
        friction=Friction("jenkins", constant_nm=friction_nm),
    )
    torque, angle = read(loops)
    found = turned_play(COMPLIANCE_DEG_PER_NM * torque, angle, loaded(torque))
    assert found is not None
    assert found.datum_deg == pytest.approx(0.0, abs=0.5 * found.margin_deg)
    assert found.free_play_deg <= play_deg + 3.0 * noise_deg
    # No reading within the play is taken for one in contact.
    clean, _ = read(TurnedLoops(1, readings=600, noise_deg=0.0, play_deg=play_deg))
    within = clean == 0.0
    assert np.all(found.holds(angle)[within])
    assert np.mean(found.holds(angle)[~within]) < 0.1


def test_shaft_that_falls_through_the_play_is_not_turned() -> None:
    recording = turned(TurnedLoops(1, noise_deg=0.01))
    assert recording.angle_deg is not None
    torque, angle = recording.torque_nm, recording.angle_deg
    few = np.cumsum(torque == 0.0) % 12 == 0
    shown = (torque != 0.0) | few
    torque, angle = torque[shown], angle[shown]
    assert turned_play(COMPLIANCE_DEG_PER_NM * torque, angle, loaded(torque)) is None


def test_noise_that_wanders_shows_no_play() -> None:
    torque, _ = read(TurnedLoops(1, play_deg=0.0))
    rng = np.random.default_rng(2)
    slow = np.zeros_like(torque)
    for k, step in enumerate(rng.normal(0.0, 0.1, len(torque) - 1), 1):
        slow[k] = 0.97 * slow[k - 1] + step
    twist = COMPLIANCE_DEG_PER_NM * torque
    assert turned_play(twist, twist + slow, loaded(torque)) is None


@pytest.mark.parametrize(
    "friction",
    [
        Friction(constant_nm=2.0),
        Friction("jenkins", 10.0, 5.0),
        Friction("bouc-wen", 2.0, 2.0),
    ],
    ids=["dahl", "jenkins", "bouc-wen"],
)
def test_friction_of_a_rig_that_sets_the_angle_is_explained_to_the_noise(
    friction: Friction,
) -> None:
    # The readings within the play were taken for readings under load: UNKNOWN_PHYSICS, a
    # stiffening beside the friction, and 7 deg left.
    found = cs.diagnose(turned(TurnedLoops(3, friction=friction)), DRIVE, full=False)
    assert found.verdict in ("IDENTIFIED", "MOSTLY_EXPLAINED")
    assert [effect.name for effect in found.answer.effects] == ["friction_hysteresis"]
    assert found.answer.repaired is not None
    assert (found.answer.repaired.rmse_deg or np.inf) < 1.2 * 0.05


def test_what_replaces_the_class_of_a_large_effect_is_no_effect() -> None:
    # A cubic spring: take-up leaves a fiftieth of it, in which waves of the mesh were named.
    found = cs.diagnose(turned(TurnedLoops(4, noise_deg=0.01, stiffening=0.3)), DRIVE, full=False)
    names = {effect.name for effect in found.answer.effects}
    assert not names & {"transmission_error", "phase_dependent_compliance"}
