"""Searches of made recordings, calibrated and with nothing visited."""

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.simulation.effects import effects
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import long_recording

DRIVE = cs.Drive.reference_87()


def search_of(*values: EffectValue) -> Search:
    """Calibrated search of a recording made with these effects."""
    return search_of_recording(long_recording(3_000, values))


def search_of_recording(recording: cs.Recording, *, one_history: bool = False) -> Search:
    """Calibrated search of a recording."""
    line, pins = DRIVE.nominal_line("input"), int(DRIVE.output_pin_count)
    problem = prepare(recording, line, pins, one_history=one_history)
    library = build_library(problem.history, problem.fitted, tuple(effects()))
    return calibrate(problem, library, 0)
