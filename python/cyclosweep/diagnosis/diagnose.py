"""The diagnosis from beginning to end, a line for each stage."""

import logging
from collections.abc import Callable, Collection
from functools import partial

from threadpoolctl import threadpool_limits

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.compose import compose
from cyclosweep.diagnosis.conclude import conclude
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.inputs import check_measured, check_options, considered_effects, drive_for
from cyclosweep.diagnosis.locate import locate
from cyclosweep.diagnosis.model_error_table import with_error_table
from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.diagnosis.prepare.problem import Problem, prepare
from cyclosweep.diagnosis.prepare.single_outliers import without_single_outliers
from cyclosweep.diagnosis.refuse import (
    NoDiagnosisError,
    check_prepared,
    check_recording,
    refused,
)
from cyclosweep.diagnosis.repair import repair
from cyclosweep.diagnosis.sliding import find_sliding, sliding_diagnosis
from cyclosweep.diagnosis.torque_zero import identify_with_torque_zero
from cyclosweep.diagnosis.verification import verify
from cyclosweep.display import Steps, shown_steps
from cyclosweep.recording import Recording
from cyclosweep.simulation.effects import Effect

_LOG = logging.getLogger(__name__)


def diagnose(
    recording: Recording,
    drive: Drive | None = None,
    *,
    tolerance_deg: float | None = None,
    seed: int = 0,
    full: bool = True,
    without: Collection[str] = (),
    progress: Steps = None,
) -> Diagnosis:
    """Locate where recording and simulation differ, name what is missing, model and verify it.

    Parameters
    ----------
    recording : Recording
        Measured torque and twist.
    drive : Drive, optional
        The drive; default: the one named in the recording's metadata.
    tolerance_deg : float, optional
        Size below which an effect does not matter [deg]; default 1 % of the largest elastic twist.
    seed : int
        Seed of every random draw; equal seeds give equal results.
    full : bool
        False leaves out the held-out proof, the self-check and the next experiment.
    without : collection of str
        Effects that are not considered, as if nobody had listed them.
    progress : bool or callable, optional
        True shows the step at work; a callable is called with a few words before each long step.

    Returns
    -------
    Diagnosis

    Raises
    ------
    InputError
        The recording has no angle, no drive is known, or an option is out of its range.
    DesignError
        The drive cannot be built.
    """
    check_measured(recording)
    drive = drive_for(recording, drive)
    check_options(tolerance_deg, seed, full)
    effects = considered_effects(without)
    # The matrices are small: a second thread of the linear algebra costs several times the time,
    # and the last digits would depend on the machine.
    with (
        shown_steps(recording.name, progress, _LOG) as say,
        threadpool_limits(limits=1, user_api="blas"),
    ):
        try:
            found = _run_stages(recording, drive, effects, tolerance_deg, seed, full, say)
        except NoDiagnosisError as refusal:
            found = refused(recording, drive, refusal, seed)
    _LOG.info("%s", found)
    return found


def _run_stages(
    recording: Recording,
    drive: Drive,
    effects: tuple[Effect, ...],
    tolerance_deg: float | None,
    seed: int,
    full: bool,
    say: Callable[[str], None],
) -> Diagnosis:
    """Run one stage after the other.

    Identification may start over with what it has found, before places are looked for.
    """
    say("preparing")
    check_recording(recording)
    sliding = find_sliding(recording)
    if sliding is not None:
        return sliding_diagnosis(recording, drive, sliding, effects, seed)
    line, pins = drive.nominal_line(recording.side), int(drive.output_pin_count)
    mesh_ratio = float(drive.ratio) if recording.side == "output" else 1.0
    recording = without_single_outliers(recording, line)
    prepared = partial(prepare, recording, line, pins, mesh_ratio=mesh_ratio)

    def calibrated(problem: Problem) -> Search:
        check_prepared(problem, drive)
        return calibrate(problem, build_library(problem.history, problem.fitted, effects), seed)

    searched = identify_with_torque_zero(recording, prepared, calibrated, say)
    say("bounding what was not found")
    concluded = conclude(searched, drive, tolerance_deg)
    regions = locate(concluded)
    repaired = repair(concluded, drive)
    verified = verify(concluded, full=full, say=say)
    repaired = with_error_table(concluded, repaired, verified)
    return compose(drive, concluded, regions, repaired, verified)
