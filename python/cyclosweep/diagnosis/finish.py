"""Last parts of an answer: play and stiffness, remarks, words, its check against itself."""

from dataclasses import replace

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.plausibility import doubts, with_remarks
from cyclosweep.diagnosis.verification import Verification
from cyclosweep.recording import Recording
from cyclosweep.report.play_and_stiffness import play_and_stiffness
from cyclosweep.report.summary import do_now, summary_of
from cyclosweep.result import Answer, PlayAndStiffness
from cyclosweep.result.contradictions import Recorded, contradictions
from cyclosweep.result.statement import statement_of


def finished(
    answer: Answer,
    drive: Drive,
    concluded: Conclusion,
    verified: Verification,
) -> Answer:
    """Add play and stiffness, remarks, statement and summary; say what in it cannot both hold.

    Parameters
    ----------
    answer : Answer
        The answer without these parts.
    drive : Drive
        The drive that was diagnosed.
    concluded : Conclusion
        Verdict and accepted structure.
    verified : Verification
        Whether the loops drift.

    Returns
    -------
    Answer
    """
    read = _play_and_stiffness(answer, drive, concluded, verified)
    answer = replace(answer, play_and_stiffness=read)
    recording = concluded.search.problem.recording
    hidden = concluded.accepted.fit.hidden_play is not None
    remarks = doubts(answer, recording, float(drive.ratio), hidden=hidden)
    answer = with_remarks(answer, remarks)
    sentences = (statement_of(answer), verified.held_out.missed)
    answer = replace(answer, statement=" ".join(filter(None, sentences)))
    answer = replace(answer, summary=summary_of(answer), do_now=do_now(answer))
    wrong = contradictions(answer, _recorded(recording))
    faults = tuple(f"This answer contradicts itself: {each}." for each in wrong)
    return replace(answer, notes=(*answer.notes, *faults))


def _recorded(recording: Recording) -> Recorded | None:
    """Ranges of angle and torque of a recording; None without an angle."""
    if recording.angle_deg is None:
        return None
    return Recorded(float(np.ptp(recording.angle_deg)), float(np.ptp(recording.torque_nm)))


def _play_and_stiffness(
    answer: Answer, drive: Drive, concluded: Conclusion, verified: Verification
) -> PlayAndStiffness:
    """Read the free play and the stiffness from the loop, where friction does not hide them.

    Parameters
    ----------
    answer : Answer
        Its calibrated parameters stand in where no lines can be laid: those beside the effects
        where there are any.
    drive : Drive
        The drive that was diagnosed.
    concluded : Conclusion
        Verdict and accepted structure.
    verified : Verification
        Whether the loops drift.

    Returns
    -------
    PlayAndStiffness
    """
    repaired = bool(concluded.accepted.fit.terms)
    model = answer.repaired if repaired else answer.baseline
    return play_and_stiffness(
        concluded.search.problem.recording,
        model.parameters,
        float(drive.ratio),
        repaired=repaired,
        hidden=concluded.accepted.fit.hidden_play,
        unsteady=verified.drift is not None,
    )
