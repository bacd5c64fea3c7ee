"""A friction that slides fully is named, and no stiffness is read where the torque fixes none."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.sliding import find_sliding
from tests.support.metal import metal

LIMIT_NM = 300.0
"""Friction of the made brake [N m]."""


def driven(stiffness_nm_per_deg: float, hardening_nm_per_deg: float = 0.0) -> cs.Recording:
    """Recording of a brake behind a spring, whose motion is driven to and fro [deg]."""
    rng = np.random.default_rng(5)
    angle = np.concatenate([np.linspace(a, b, 200)[1:] for a, b in ((0, 8), (8, -8), (-8, 8)) * 2])
    torque, slip = np.zeros(len(angle)), 0.0
    for k, at in enumerate(angle):
        reach = LIMIT_NM / stiffness_nm_per_deg
        slip = min(max(slip, at - reach), at + reach)
        torque[k] = stiffness_nm_per_deg * (at - slip) + hardening_nm_per_deg * at
    torque += rng.normal(0.0, 0.02 * LIMIT_NM, len(torque))
    return cs.Recording.from_arrays(torque, angle, side="output", drive="reference-87")


def test_a_brake_is_named_without_a_stiffness() -> None:
    found = cs.diagnose(driven(300.0), cs.Drive.reference_87())
    assert [each["name"] for each in found.effects] == ["friction_hysteresis"]
    limit = found.effects[0]["parameters"]["friction_torque_nm"]
    assert limit["estimate"] == pytest.approx(LIMIT_NM, rel=0.02)
    assert found.effects[0]["size_nm"] == pytest.approx(LIMIT_NM, rel=0.02)
    assert "not determined by torque" in found.statement
    assert found.verdict == "UNKNOWN_PHYSICS"
    assert found.model is None
    assert found.content["repaired"]["parameters"] == {}
    assert found.content["unknown"]["size_deg"] == pytest.approx(14.0, abs=2.5)


def test_a_brake_that_may_not_be_named_still_gives_no_stiffness() -> None:
    drive = cs.Drive.reference_87()
    found = cs.diagnose(driven(300.0), drive, without=("friction_hysteresis",))
    assert found.effects == []
    assert "not determined by torque" in found.statement


def test_its_report_is_written(tmp_path: Path) -> None:
    cs.diagnose(driven(300.0), cs.Drive.reference_87()).write(tmp_path)
    assert "not determined by torque" in (tmp_path / "report.html").read_text()


def test_a_spring_with_a_large_friction_keeps_its_stiffness() -> None:
    # Spring torque 960 N m at the ends, friction 300 N m: the torque still fixes the twist.
    assert find_sliding(driven(300.0, hardening_nm_per_deg=120.0)) is None


@pytest.mark.parametrize("every", [1, 2, 3])
def test_sliding_does_not_depend_on_how_densely_it_is_read(every: int) -> None:
    dense, read = find_sliding(metal()), find_sliding(metal(every))
    assert dense is not None
    assert read is not None
    assert read.friction_nm == pytest.approx(dense.friction_nm, rel=0.03)
    assert read.loop_share == pytest.approx(dense.loop_share, abs=0.03)
    assert read.rising.share == pytest.approx(dense.rising.share, abs=0.05)


def test_readings_that_stand_there_twice_change_nothing() -> None:
    once = metal()
    rows = np.sort(np.r_[np.arange(len(once)), np.arange(len(once))[::2]])
    assert once.angle_deg is not None
    twice = cs.Recording.from_arrays(once.torque_nm[rows], once.angle_deg[rows], side="output")
    assert find_sliding(twice) == find_sliding(once)


@pytest.mark.parametrize("every", [1, 4])
def test_readings_where_the_torque_is_held_are_no_travel(every: int) -> None:
    # 200 readings at rest under each peak: of the readings most, of the travel nothing.
    once = driven(300.0)
    assert once.angle_deg is not None
    turn = np.flatnonzero(np.abs(np.abs(once.angle_deg) - 8.0) < 1e-9)
    rows = np.sort(np.r_[np.arange(len(once)), np.repeat(turn, 200)])[::every]
    held = cs.Recording.from_arrays(once.torque_nm[rows], once.angle_deg[rows], side="output")
    found, free = find_sliding(held), find_sliding(once)
    assert found is not None
    assert free is not None
    assert found.rising.share == pytest.approx(free.rising.share, abs=0.02)
    assert found.friction_nm == pytest.approx(free.friction_nm, rel=0.01)


@pytest.mark.parametrize("every", [1, 5, 20])
def test_a_spring_with_friction_does_not_slide_however_it_is_read(every: int) -> None:
    spring = driven(300.0, hardening_nm_per_deg=120.0)
    assert spring.angle_deg is not None
    rows = slice(None, None, every)
    thin = cs.Recording.from_arrays(spring.torque_nm[rows], spring.angle_deg[rows], side="output")
    assert find_sliding(thin) is None


@pytest.mark.shared
@pytest.mark.parametrize("name", ["damper-30lb-1in-0.5Hz", "damper-36lb-1in-0.25Hz"])
def test_measured_brakes(shared_recordings: Path, name: str) -> None:
    recording = cs.Recording.read(shared_recordings / "other-rigs" / f"{name}.csv")
    found = cs.diagnose(recording, full=False)
    assert [each["name"] for each in found.effects] == ["friction_hysteresis"]
    assert "not determined by torque" in found.statement
    assert found.content["baseline"]["parameters"] == {}


def test_a_remark_on_units_comes_before_all_else_that_is_to_be_done() -> None:
    """The statement alone said it; the summary's advice and the next experiment did not."""
    leg = np.linspace(-9.0, 9.0, 40)
    torque = np.r_[leg, np.full(60, 9.0), leg[::-1], np.full(60, -9.0)]
    up, down = 2.7 * (leg + 9.0), 300.0 + 2.7 * (leg[::-1] + 9.0)
    angle = np.r_[up, np.linspace(48.6, 348.6, 60), down, np.linspace(300.0, 0.0, 60)]
    noise = np.random.default_rng(0).normal(0.0, 0.02, 400)
    drive = cs.Drive.reference_87()

    def brake(factor: float) -> cs.Diagnosis:
        made = cs.Recording.from_arrays(
            np.tile(torque, 2) + noise, factor * np.tile(angle, 2), run=np.repeat([0, 1], 200),
            side="input",
        )  # fmt: skip
        return cs.diagnose(made, drive, full=False)

    right, in_mrad = brake(1.0).answer, brake(1000.0 * np.pi / 180.0).answer
    assert in_mrad.statement.startswith("Check first: the compliance right after reversals")
    assert in_mrad.do_now.startswith("Check first: the compliance right after reversals")
    assert in_mrad.next_experiment is not None
    assert right.next_experiment is not None
    assert in_mrad.next_experiment.program.startswith("settle what stands under Check first")
    assert in_mrad.next_experiment.program.endswith(right.next_experiment.program)
    assert right.plausibility == ()
    assert right.do_now.startswith("Look at")
