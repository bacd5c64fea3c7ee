"""The free play, the stiffness and the friction of a drive, read from its measured loop."""

from collections.abc import Mapping, Sequence

import numpy as np
from scipy import stats

from cyclosweep.recording import Recording
from cyclosweep.report.straight_lines import LINE_SHARES, friction_of_all, straight_lines
from cyclosweep.report.wording import ARCMIN
from cyclosweep.result import CalibratedParameter, PlayAndStiffness, Reading
from cyclosweep.result.part import NORMAL_95

CONFIDENCE = 0.95
"""Confidence of the intervals."""
BY_LINES = (
    "straight lines through the middle of the loop between "
    f"{100 * LINE_SHARES[0]:.0f} and {100 * LINE_SHARES[1]:.0f} % of the largest torque, means of "
    "the rising and the falling branch, so that friction cancels: free play is the distance of the "
    "lines of both flanks at zero torque, compliance their slope, friction half the width of the "
    "loop in torque"
)
BY_MODEL = (
    "the published model fitted to all readings, a straight line on each flank: free play is the "
    "distance of the lines at zero torque, compliance their slope"
)
BY_REPAIRED_MODEL = (
    "the published model with what was found to be missing, fitted to all readings: free play is "
    "that of the model, compliance the slope of its elastic law, between half and full torque "
    "where effects bend it"
)
BY_ALL_RUNS = "; friction half the width of the loop in torque at equal angle, all runs together"
FEW_FOR_FRICTION = (
    "friction takes rising and falling branches on both flanks, of more readings than there are"
)
"""Why there is no friction."""


def play_and_stiffness(
    recording: Recording,
    calibrated: Mapping[str, CalibratedParameter],
    ratio: float,
    *,
    repaired: bool = False,
    hidden: str | None = None,
    unsteady: bool = False,
) -> PlayAndStiffness:
    """Read free play, stiffness and friction by one definition, with intervals over the runs.

    Where the recording is too coarse for lines through the branches, as one read by hand, the
    calibrated model takes their place, with the effects that were found: the lines without them
    are bent by these, friction above all, by many times their standard errors.

    Parameters
    ----------
    recording : Recording
        The measured loop.
    calibrated : mapping of str to CalibratedParameter
        Calibrated parameters: of the repaired model where effects were found, else of the
        published one.
    ratio : float
        Ratio of the drive.
    repaired : bool
        Whether they are those of the repaired model.
    hidden : str or None
        Why friction hides the play; then neither play nor stiffness is given.
    unsteady : bool
        Whether the loops drift from run to run; then no stiffness is given.

    Returns
    -------
    PlayAndStiffness
    """
    lines = straight_lines(recording)
    friction = _reading([line.friction_nm for line in lines])
    by_model = BY_REPAIRED_MODEL if repaired else BY_MODEL
    if not lines and (width := friction_of_all(recording)) is not None:
        friction, by_model = Reading(estimate=width), by_model + BY_ALL_RUNS
    reasons = [] if friction is not None else [FEW_FOR_FRICTION]
    if hidden is not None:
        reasons.append(f"friction hides play and stiffness: {hidden}")
        return PlayAndStiffness(
            definition=BY_LINES,
            runs=len(lines),
            friction_nm=friction,
            reason="; ".join(reasons),
        )
    if lines:
        play = _reading([line.play_deg for line in lines])
        compliance = _reading([line.compliance_deg_per_nm for line in lines])
    else:
        play = _fitted(calibrated.get("free_play_deg"), 2.0)
        compliance = _whole_compliance(calibrated)
    if play is None:
        reasons.append("only one flank was loaded, so that no play can be read")
    if unsteady:
        compliance = None
        reasons.append("the loops drift from run to run, so that no stiffness can be read")
    at_input = recording.side == "input"
    return PlayAndStiffness(
        definition=BY_LINES if lines else by_model,
        runs=len(lines),
        free_play_deg=play,
        free_play_at_output_deg=_times(play, 1.0 / ratio if at_input else 1.0),
        compliance_deg_per_nm=compliance,
        stiffness_at_output_nm_per_arcmin=_inverse(
            _times(compliance, ARCMIN / (ratio**2 if at_input else 1.0))
        ),
        friction_nm=friction,
        reason="; ".join(reasons) or None,
    )


def mean_and_interval(
    values: Sequence[float],
) -> tuple[float | None, tuple[float, float] | None]:
    """Mean with its 95 % interval by Student's t.

    Parameters
    ----------
    values : sequence of float
        Independent readings.

    Returns
    -------
    mean : float or None
        None without values.
    interval : (float, float) or None
        None for fewer than two.

    Examples
    --------
    >>> mean_and_interval([1.0])
    (1.0, None)
    """
    if not values:
        return None, None
    mean = float(np.mean(values))
    if len(values) < 2:
        return mean, None
    quantile = stats.t.ppf(0.5 + 0.5 * CONFIDENCE, len(values) - 1)
    half = float(quantile * stats.sem(values))
    return mean, (mean - half, mean + half)


def _reading(values: Sequence[float]) -> Reading | None:
    """Mean over the runs; None without any."""
    mean, interval = mean_and_interval(values)
    return None if mean is None else Reading(estimate=mean, ci95=interval)


def _fitted(value: CalibratedParameter | None, factor: float) -> Reading | None:
    """Fitted parameter times a factor; None where the recording does not determine it."""
    if value is None or value.std_error is None:
        return None
    half = NORMAL_95 * value.std_error
    ends = (factor * (value.estimate - half), factor * (value.estimate + half))
    return Reading(estimate=factor * value.estimate, ci95=ends)


def _whole_compliance(calibrated: Mapping[str, CalibratedParameter]) -> Reading | None:
    """Compliance with what bends the line; its line alone is only what the effects leave of it."""
    scale, line = calibrated.get("compliance_scale"), calibrated.get("compliance_deg_per_nm")
    if scale is None or line is None or line.nominal is None:
        return _fitted(line, 1.0)
    return _fitted(scale, line.nominal)


def _times(reading: Reading | None, factor: float) -> Reading | None:
    """Reading in another unit or at the other shaft."""
    if reading is None:
        return None
    ends = None if reading.ci95 is None else (factor * reading.ci95[0], factor * reading.ci95[1])
    return Reading(estimate=factor * reading.estimate, ci95=ends)


def _inverse(reading: Reading | None) -> Reading | None:
    """One over a reading; without an interval where that would have no upper end."""
    if reading is None or reading.estimate <= 0:
        return None
    ends = reading.ci95
    inverted = None if ends is None or ends[0] <= 0 else (1.0 / ends[1], 1.0 / ends[0])
    return Reading(estimate=1.0 / reading.estimate, ci95=inverted)
