"""Plausibility: which mistake a compliance, play or datum far from the drive file suggests."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log

import numpy as np

from cyclosweep.diagnosis.doubts import compliance_doubt, datum_doubt, play_doubt
from cyclosweep.diagnosis.mistakes import likely_mistakes, with_others
from cyclosweep.diagnosis.reversals import compliance_after_reversals
from cyclosweep.diagnosis.strokes import LOOP_SHARE, strokes_of
from cyclosweep.recording import Recording
from cyclosweep.recording.exchanged_columns import EXCHANGED, are_exchanged
from cyclosweep.result import (
    Answer,
    CalibratedParameter,
    Doubt,
    NextExperiment,
    PlayAndStiffness,
)
from cyclosweep.result.contradictions import NONE_NEEDED
from cyclosweep.result.plausibility import Quantity

FAR_COMPLIANCE = 2.0
"""Factor from nominal beyond which a compliance is remarked on. Real drives are often softer than
their file by more than that, so that the remark says what it would mean; among 300 made recordings
whose drives scatter by a tenth, effects of the size of the twist itself move it by less."""
FAR_PLAY = 2.2
"""Factor from nominal beyond which a free play is remarked on."""
FAR_PLAY_SHARE = 0.1
"""Share of the elastic twist by which the play must differ from nominal as well: a play of
hundredths of a degree may be any multiple of another."""
SURE_PLAY = 5.0
"""Standard errors of a fitted play by which it must differ from nominal, too."""
FAR_DATUM = 3.0
"""Multiple of half the nominal range of the angle, play and elastic twist together, beyond which
a datum is remarked on: a zero that was set on the drive lies within the range."""
CLEAR = log(1.03)
"""How near a compliance must be to a mistake of less than `FAR_COMPLIANCE`, as lbf ft for N m."""
SAME_PLAY = log(1.1)
"""How near nominal the play must then be."""
AFTER_REVERSALS = " right after reversals of the load, before friction slips again,"
"""Which compliance is meant where friction slides."""

CHECK_FIRST = (
    "settle what stands under Check first: load the drive with a known weight on a known arm and "
    "compare both columns of the file with it"
)
"""What to do before any other experiment where a calibrated value is far from the drive file."""

REMARKS: dict[str, Quantity] = {
    "columns_swapped": "columns",
    "unit_contradicted": "columns",
    "column_unread": "columns",
    "saturation": "range",
}
"""Remarks of reading to be settled first, and what each is about."""


def doubts(
    answer: Answer, recording: Recording, ratio: float, *, hidden: bool = False
) -> tuple[Doubt, ...]:
    """Remark on compliance, play and datum far from nominal, and on what reading found at fault.

    An effect may take compliance or play from the line, or hide in it, and friction that slides may
    be taken for compliance: a value is far only where all readings of it say so, on the same side.

    Parameters
    ----------
    answer : Answer
        With the calibrated parameters of the published and of the repaired model, and with play and
        stiffness as read from the loop.
    recording : Recording
        What was measured.
    ratio : float
        Ratio of the drive.
    hidden : bool
        Whether friction hides play and stiffness, so that neither is stated.

    Returns
    -------
    tuple of Doubt
        Empty where every value is near nominal.
    """
    before, after = answer.baseline.parameters, answer.repaired.parameters
    line = after["compliance_deg_per_nm"]
    nominal = line.nominal or line.estimate
    elastic = abs(nominal) * float(abs(recording.torque_nm).max())
    nominal_play = after["free_play_deg"].nominal or 0.0
    plays = _plays(before, after, answer.play_and_stiffness)
    known = bool(plays) and not hidden
    far_play = _far_play(plays, nominal_play, FAR_PLAY_SHARE * elastic) if known else None
    play_factor = None
    if known and nominal_play > FAR_PLAY_SHARE * elastic:
        play_factor = _nearest([play for play, _ in plays], nominal_play) / nominal_play
    compliance = _compliance_doubt(before, after, recording, ratio, play_factor, far_play, hidden)
    found = [] if compliance is None else [compliance]
    if far_play is not None and not (compliance and compliance.suggests):
        far = compliance is not None
        found.append(play_doubt(far_play, nominal_play, compliance_is_far=far))
    datum = min((each["datum_deg"].estimate for each in (after, before)), key=abs)
    reach = nominal_play + elastic * max(_nearest([_scale(after), _scale(before)], 1.0), 1.0)
    if plays and abs(datum) > FAR_DATUM * reach:
        found.append(datum_doubt(datum, reach))
    modulo = recording.modulo_fault(2.0 * nominal_play)
    if modulo is not None:
        found.append(Doubt(quantity="angle_modulo", text=modulo.reason))
    # How the file was read decides what everything else means.
    return (*_remarks_of_reading(recording), *found)


def compliance_beside_sliding(recording: Recording, *, hidden: bool = False) -> float | None:
    """Compliance by the slopes after reversals, where a sliding friction may be taken for it.

    A mistake of units changes these slopes as it changes all others; a friction that slides does
    not, but makes the loop as a whole softer without limit. Far below nominal the slopes tell
    nothing: friction that holds makes them so.

    Parameters
    ----------
    recording : Recording
        What was measured.
    hidden : bool
        Whether friction is known to hide the stiffness; else the width of the loop decides.

    Returns
    -------
    float or None
        In deg/(N m). None where friction carries less than the spring, and where there are no such
        slopes.
    """
    strokes = strokes_of(recording)
    if not hidden and (strokes is None or strokes.loop_share < LOOP_SHARE):
        return None
    return compliance_after_reversals(recording)


def with_remarks(answer: Answer, remarks: tuple[Doubt, ...]) -> Answer:
    """Add remarks to an answer; where there are any, their check comes before what is to be done.

    Parameters
    ----------
    answer : Answer
        The answer with its next experiment.
    remarks : tuple of Doubt
        What is far from the drive file.

    Returns
    -------
    Answer
    """
    plan = answer.next_experiment
    if remarks and plan is not None:
        plan = _after_check(plan)
    return replace(answer, plausibility=remarks, next_experiment=plan)


def _after_check(plan: NextExperiment) -> NextExperiment:
    """Put the check of what is far from the drive file before the next programme."""
    if plan.program == NONE_NEEDED:
        return NextExperiment(program=CHECK_FIRST)
    return replace(plan, program=f"{CHECK_FIRST}; then {plan.program}")


def doubts_where_it_slides(recording: Recording, nominal: float, ratio: float) -> tuple[Doubt, ...]:
    """Remark on the slopes after reversals where friction slides all the way.

    Parameters
    ----------
    recording : Recording
        What was measured.
    nominal : float
        Compliance by the drive's file [deg/(N m)].
    ratio : float
        Ratio of the drive.

    Returns
    -------
    tuple of Doubt
        Also what reading found at fault.
    """
    remarks = _remarks_of_reading(recording)
    turned, angle = compliance_after_reversals(recording), recording.angle_deg
    if turned is None or angle is None or turned <= 0.0:
        return remarks
    # From one limit of the friction to the other the shaft travels at least its elastic twist.
    most = float(angle.max() - angle.min()) / float(np.ptp(recording.torque_nm))
    if turned <= FAR_COMPLIANCE * nominal and most * FAR_COMPLIANCE >= nominal:
        return remarks
    suggested = likely_mistakes(turned / nominal, None, ratio)
    return (*remarks, compliance_doubt(turned / nominal, nominal, suggested, AFTER_REVERSALS))


def _scale(parameters: Mapping[str, CalibratedParameter]) -> float:
    """Compliance of all that is elastic over the nominal one, as it is stated."""
    return parameters["compliance_scale"].estimate


def _compliance_doubt(
    before: Mapping[str, CalibratedParameter],
    after: Mapping[str, CalibratedParameter],
    recording: Recording,
    ratio: float,
    play_factor: float | None,
    far_play: float | None,
    hidden: bool,
) -> Doubt | None:
    """Remark on a compliance far from nominal; None where it is near, or nothing tells it.

    Parameters
    ----------
    before, after : mapping of str to CalibratedParameter
        Calibrated parameters of the published and of the repaired model by name.
    recording : Recording
        What was measured.
    ratio : float
        Ratio of the drive.
    play_factor : float or None
        Free play over its nominal value; None where it is not known.
    far_play : float or None
        Free play, where it is far from nominal [deg].
    hidden : bool
        Whether friction hides play and stiffness.

    Returns
    -------
    Doubt or None
    """
    line = after["compliance_deg_per_nm"]
    nominal = abs(line.nominal or line.estimate)
    factors = [_scale(after), _scale(before)]
    fitted = _nearest(factors, 1.0)
    read = compliance_beside_sliding(recording, hidden=hidden)
    turned = None if read is None else read / nominal
    if turned is not None and turned * FAR_COMPLIANCE >= 1.0:
        if turned <= FAR_COMPLIANCE:
            return None
        suggested = likely_mistakes(turned, None, ratio)
        if not suggested and min(factors) > 0.0:
            suggested = likely_mistakes(fitted, None, ratio)
        return compliance_doubt(turned, nominal, suggested, AFTER_REVERSALS)
    far = not 1.0 / FAR_COMPLIANCE <= fitted <= FAR_COMPLIANCE
    if min(factors) < 1.0 < max(factors):
        return None
    suggested = ()
    if min(factors) > 0.0:
        torque, angle = recording.torque_nm, recording.angle_deg
        if far and angle is not None and are_exchanged(torque, angle, nominal):
            suggested = (EXCHANGED,)
        elif far:
            # Friction that holds stiffens the line without it: what is stated names the mistake.
            suggested = likely_mistakes(factors[0], play_factor, ratio)
            if not suggested:
                suggested = likely_mistakes(fitted, play_factor, ratio)
            if fitted < 1.0 and turned is not None and turned > 0.0:
                suggested = with_others(likely_mistakes(turned, None, ratio), suggested)
        elif not hidden and (play_factor is None or abs(log(max(play_factor, 1e-9))) < SAME_PLAY):
            suggested = likely_mistakes(fitted, play_factor, ratio, CLEAR)
    if suggested or (far and not hidden):
        return compliance_doubt(factors[0], nominal, suggested, play_is_far=far_play is not None)
    return None


def _remarks_of_reading(recording: Recording) -> tuple[Doubt, ...]:
    """Remarks on how a file was read, to be settled before anything else."""
    return tuple(
        Doubt(
            quantity=REMARKS[fault.kind],
            text=fault.reason[0].lower() + fault.reason[1:].rstrip("."),
        )
        for fault in recording.faults
        if fault.kind in REMARKS
    )


def _nearest(values: Sequence[float], nominal: float) -> float:
    """Return of several readings of a value the one that is nearest to nominal.

    Parameters
    ----------
    values : sequence of float
        Readings.
    nominal : float
        Value by the drive's file.

    Returns
    -------
    float
        By the factor where all are above zero, else by the difference.
    """
    if nominal > 0 and all(value > 0 for value in values):
        return min(values, key=lambda value: abs(log(value / nominal)))
    return min(values, key=lambda value: abs(value - nominal))


def _plays(
    before: Mapping[str, CalibratedParameter],
    after: Mapping[str, CalibratedParameter],
    read: PlayAndStiffness | None,
) -> list[tuple[float, float]]:
    """Free plays of each side, and by how much each may be wrong [deg].

    Parameters
    ----------
    before, after : mapping of str to CalibratedParameter
        Calibrated parameters of the published and of the repaired model by name.
    read : PlayAndStiffness or None
        What was read from the loop.

    Returns
    -------
    list of (float, float)
        That which the answer states comes first; empty where no play was determined.
    """
    plays = []
    if read is not None and read.runs and read.free_play_deg is not None:
        play = read.free_play_deg
        low, high = play.ci95 or (play.estimate, play.estimate)
        plays.append((play.estimate / 2.0, (high - low) / 4.0))
    for fitted in (after["free_play_deg"], before["free_play_deg"]):
        if fitted.std_error is not None:
            plays.append((fitted.estimate, SURE_PLAY * fitted.std_error))
    return plays


def _far_play(plays: Sequence[tuple[float, float]], nominal: float, least: float) -> float | None:
    """Free play of each side, where all readings of it are far from nominal on the same side.

    Parameters
    ----------
    plays : sequence of (float, float)
        Readings, and by how much each may be wrong [deg].
    nominal : float
        Play by the drive's file [deg].
    least : float
        Difference that does not count [deg].

    Returns
    -------
    float or None
        The one that the answer states [deg].
    """
    for play, error in plays:
        near = nominal / FAR_PLAY <= play <= nominal * FAR_PLAY
        if near or abs(play - nominal) <= max(least, error):
            return None
    above = [play > nominal for play, _ in plays]
    return plays[0][0] if all(above) or not any(above) else None
