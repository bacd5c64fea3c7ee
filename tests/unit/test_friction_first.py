"""A loud friction is found at its own optimum, however small a share of the torque it takes."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.friction_first import friction_first
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.simulation import effects
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import COMPLIANCE, long_recording

USUAL = (
    "friction_hysteresis",
    "load_dependent_friction",
    "contact_stiffening",
    "load_asymmetry",
)


def test_friction_of_a_five_hundredth_of_the_torque_is_not_spread_over_two_laws() -> None:
    # Fitted jointly from a load-dependent friction a hundred times as large, both laws end at
    # the bounds of their presliding and leave four times the noise.
    shape = {"slip_deg": 2.0, "scatter": 0.6, "skew": 0.0, "slack": 0.0}
    friction = EffectValue("friction_hysteresis", shape, (0.15 / COMPLIANCE,))
    recording = long_recording(3_000, [friction], noise_deg=0.0085)
    drive = cs.Drive.reference_87()
    problem = prepare(recording, drive.nominal_line("input"), int(drive.output_pin_count))
    library = build_library(problem.history, problem.fitted, [effects.find(n) for n in USUAL])
    search = calibrate(problem, library, seed=0)
    found = friction_first(search, search.noise.with_model_error(60.0))
    assert [term.name for term in found] == ["friction_hysteresis"]
    assert found[0].amplitude == pytest.approx(0.15 / COMPLIANCE, rel=0.05)
    assert float(np.log(found[0].shape["slip_deg"])) == pytest.approx(np.log(2.0), abs=0.1)
