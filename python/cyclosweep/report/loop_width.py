"""What the width of a loop is of, and the friction torque beside what else opens it."""

from cyclosweep.report.data import ReportData
from cyclosweep.report.wording import number
from cyclosweep.result import Reading
from cyclosweep.result.calibration_words import FRICTIONS
from cyclosweep.result.effects import is_reached
from cyclosweep.result.part import NORMAL_95
from cyclosweep.result.words import listed

OPEN_THE_LOOP = ("creep", "viscous_drag", "thermal_drift", "datum_drift")
"""Effects by which a loop is open without friction."""
TORQUE = "N m"
"""Unit of a parameter that is a friction torque."""


def width_label(data: ReportData) -> str:
    """What half the width of the loop is: friction, something else that opens it, or both."""
    answer, side = data.result, data.recording.side
    named = {effect.name for effect in answer.effects}
    possible = named.union(*(rival.effects for rival in answer.explanation_set))
    others = [name for name in OPEN_THE_LOOP if name in named]
    nameless = answer.unknown is not None and not possible.intersection(FRICTIONS)
    read = answer.play_and_stiffness
    if (others or nameless) and (read is None or read.friction_nm is None):
        return f"half the loop's width at the {side}"  # not read: there is nothing to say it is of
    if not others and nameless:
        return f"half the loop's width at the {side}, of friction or of what has no name"
    if not others:
        return f"friction at the {side}, half the loop's width"
    width = f"half the loop's width at the {side}, of"
    if named.intersection(FRICTIONS):
        return f"{width} {listed(['friction', *others])}"
    if possible.intersection(FRICTIONS):
        return f"{width} {listed(others)}, perhaps with friction"
    return f"{width} {listed(others)}, not of friction"


def fitted_frictions(data: ReportData) -> list[tuple[str, Reading]]:
    """Friction torques of the repaired model, which hold what friction alone takes.

    Parameters
    ----------
    data : ReportData
        What to report.

    Returns
    -------
    list of (str, Reading)
        What the torque is, and its value with the 95 % interval [N m].
    """
    found = []
    for effect in data.result.effects:
        if effect.name not in FRICTIONS:
            continue
        for value in effect.parameters.values():
            if value.unit != TORQUE:
                continue
            half = None if value.std_error is None else NORMAL_95 * value.std_error
            ends = None if half is None else (value.estimate - half, value.estimate + half)
            what = value.meaning or "friction torque"
            label = f"{what} at the {data.recording.side}, fitted"
            reached = effect.reached_nm
            if reached is not None and not is_reached(reached, value.estimate):
                label += f" limit ({number(reached)} N m reached)"
            found.append((label, Reading(estimate=value.estimate, ci95=ends)))
    return found
