"""Mistakes of units and soft drives are told from friction that slides, and found beside it."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.reversals import compliance_after_reversals
from cyclosweep.diagnosis.strokes import LOOP_SHARE, strokes_of
from tests.support.metal import ELASTIC_NM_PER_DEG, metal

DRIVE = cs.Drive.reference_87().replace(
    free_play_deg=0.0, output_stiffness_nm_per_arcmin=ELASTIC_NM_PER_DEG / 60.0
)
"""Drive whose file gives the stiffness that the bar has below its yield point."""
GROWING = tuple(np.linspace(0.1, 2.0, 6))
"""Cycles that grow, so that friction slides over a part of the travel only [deg]."""


def growing(
    every: int = 1, *, hardening: float = 12.0, torque: float = 1.0, angle: float = 1.0
) -> cs.Diagnosis:
    """Diagnose a bar in growing cycles, whose loop as a whole is many times too soft."""
    recording = metal(
        every,
        peaks_deg=GROWING,
        hardening_nm_per_deg=hardening,
        torque_factor=torque,
        angle_factor=angle,
    )
    return cs.diagnose(recording, DRIVE, full=False)


def held(friction: float, *, torque: float = 1.0, angle: float = 1.0) -> cs.Diagnosis:
    """Diagnose a spring whose friction holds it, by a share of the torque at the peaks."""
    rng = np.random.default_rng(12)
    applied = 40.0 * np.concatenate([np.r_[0:1:40j, 1:-1:80j, -1:0:40j]] * 3)
    twist, at = np.zeros(len(applied)), 0.0
    for k, now in enumerate(applied):
        # Friction slides from a hundredth of the largest twist on, and holds below it.
        at = float(np.clip(at, now - 40.0 * friction, now + 40.0 * friction))
        twist[k] = (at + 0.01 * (now - at)) / ELASTIC_NM_PER_DEG
    twist += rng.normal(0.0, 2e-4, len(twist))
    recording = cs.Recording.from_arrays(applied * torque, twist * angle, side="output")
    return cs.diagnose(recording, DRIVE, full=False)


def told(found: cs.Diagnosis) -> list[str]:
    """What is said of units, and of a compliance far from the drive file."""
    said = [each.text for each in found.answer.plausibility if each.quantity == "compliance"]
    return [*said, found.statement] if found.verdict == "DATA_FAULT" else said


@pytest.mark.parametrize("every", [1, 2])
@pytest.mark.parametrize("hardening", [12.0, 16.0, 20.0])
def test_friction_that_slides_is_no_fault_and_no_soft_drive(every: int, hardening: float) -> None:
    # The line through the whole loop is 10 to 15 times softer than the file says.
    found = growing(every, hardening=hardening)
    assert "slides fully" not in found.statement
    assert told(found) == []


def test_friction_that_slides_all_the_way_is_no_soft_drive() -> None:
    found = cs.diagnose(metal(), DRIVE)
    assert "slides fully" in found.statement
    assert told(found) == []


@pytest.mark.parametrize(
    ("torque", "angle", "unit"),
    [
        (1.0, 17.453, "the angle is in mrad"),
        (1.0, 60.0, "the angle is in arcmin"),
        (1.0, 1.0 / 57.296, "the angle is in rad"),
        (1000.0, 1.0, "the torque is in N mm"),
        (1.0 / 9.81, 1.0, "the torque is in kgf m"),
    ],
)
def test_a_mistake_of_units_is_named_beside_friction_that_slides(
    torque: float, angle: float, unit: str
) -> None:
    found = growing(torque=torque, angle=angle)
    assert any(unit in text for text in told(found))
    slides = cs.diagnose(metal(torque_factor=torque, angle_factor=angle), DRIVE)
    (text,) = told(slides)
    assert unit in text
    assert slides.statement.startswith("Check first: the compliance right after reversals")


@pytest.mark.parametrize("friction", [0.05, 0.15, 0.3])
@pytest.mark.parametrize(
    ("torque", "angle", "unit"),
    [(1.0, 17.453, "mrad"), (8.85, 1.0, "lbf in"), (1.0, 1.0 / 57.296, "rad")],
)
def test_a_mistake_of_units_is_named_beside_friction_that_holds(
    friction: float, torque: float, angle: float, unit: str
) -> None:
    assert any(f"in {unit} " in text for text in told(held(friction, torque=torque, angle=angle)))


def test_a_mistake_of_units_is_a_fault_where_friction_holds_half_of_the_torque() -> None:
    assert held(0.5, angle=1.0 / 57.296).verdict == "DATA_FAULT"


def test_friction_that_holds_is_no_mistake_of_units() -> None:
    assert told(held(0.3)) == []


def test_a_soft_drive_is_remarked_on_beside_friction_that_slides() -> None:
    found = growing(torque=1.0 / 3.0)
    (text,) = told(found)
    assert "right after reversals" in text
    assert "softer than calculated" in text
    assert found.answer.plausibility[0].factor == pytest.approx(3.0, rel=0.1)


def test_slopes_after_reversals_leave_out_what_slides() -> None:
    recording = metal(peaks_deg=GROWING, hardening_nm_per_deg=12.0)
    strokes = strokes_of(recording)
    assert strokes is not None
    assert strokes.loop_share > LOOP_SHARE
    slope = compliance_after_reversals(recording)
    assert slope == pytest.approx(1.0 / (ELASTIC_NM_PER_DEG + 12.0), rel=0.05)


def test_no_slope_without_a_reversal_under_load() -> None:
    torque = np.r_[0.0:40.0:50j]
    recording = cs.Recording.from_arrays(torque, torque / ELASTIC_NM_PER_DEG)
    assert compliance_after_reversals(recording) is None
