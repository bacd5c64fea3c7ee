"""Programmes of the usual rigs show what docs/rigs.md says they show, and no more."""

import dataclasses
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.model import EffectValue

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "examples" / "rigs"


class Case(NamedTuple):
    """A rig, an effect in the drive that it shows, and one that it cannot show."""

    rig: str
    effect: EffectValue
    noise_deg: float
    hidden: str


CASES = (
    Case(
        "weights-and-protractor",
        EffectValue("friction_hysteresis", {"slip_deg": 2.0, "scatter": 0.8}, (1.0,)),
        0.3,
        "creep",
    ),
    Case(
        "torque-sensor-and-encoder",
        EffectValue("creep", {"time_constant_s": 20.0}, (2e-5,)),
        0.002,
        "dial_eccentricity",
    ),
    Case(
        "motor-current",
        EffectValue("viscous_drag", {"power": 1.0, "lag_s": 0.08}, (0.03,)),
        0.05,
        "thermal_drift",
    ),
    Case(
        "back-to-back",
        EffectValue("transmission_error", {"order_1": 2.0}, (0.006, 0.004)),
        0.002,
        "datum_drift",
    ),
)


def diagnosed(case: Case) -> cs.Diagnosis:
    """Diagnosis of the programme of a rig, run on a drive with the effect."""
    programme = cs.Recording.read(RIGS / f"{case.rig}.csv")
    drive = cs.Drive.reference_87()
    model = dataclasses.replace(cs.Model.of_drive(drive, programme.side), effects=(case.effect,))
    angle = cs.simulate(model, programme).angle_deg
    assert angle is not None
    read = angle + np.random.default_rng(31).normal(0.0, case.noise_deg, angle.size)
    step = programme.angle_resolution_deg
    if step:
        read = step * np.round(read / step)
    return cs.diagnose(programme.with_angle(read), drive)


@pytest.mark.parametrize("case", CASES, ids=[case.rig for case in CASES])
def test_programme_shows_what_the_page_says(case: Case) -> None:
    found = diagnosed(case)
    named = [effect["name"] for effect in found.effects]
    assert named == [case.effect.name]
    assert case.hidden in {row.name for row in found.answer.not_testable}


@pytest.mark.parametrize("case", CASES, ids=[case.rig for case in CASES])
def test_page_names_programme_and_effects(case: Case) -> None:
    sections = re.split(r"^## ", (ROOT / "docs" / "rigs.md").read_text("utf-8"), flags=re.MULTILINE)
    (section,) = (text for text in sections if f"**Programme** `{case.rig}`" in text)
    assert (
        f"`{case.hidden}`" in section.split("**Not testable**")[1].split("**Common mistakes**")[0]
    )
