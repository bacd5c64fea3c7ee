"""What was read from the loop and what the calibration found, in sentences."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import isclose

from cyclosweep.result.answer import Answer, Finding
from cyclosweep.result.calibration import CalibratedParameter
from cyclosweep.result.change import DriveChange
from cyclosweep.result.play_and_stiffness import PlayAndStiffness, Reading
from cyclosweep.result.series import as_shown
from cyclosweep.result.words import degrees, telling_digits
from cyclosweep.simulation.effects.thermal_drift import REFERENCE_C

AT_REFERENCE = f" at {REFERENCE_C:g} degC"
"""Temperature at which the calibration holds where something follows the temperature."""
MEANS = " (means over the recording, whose temperature changed)"
"""What is read from the loop there."""
FRICTIONS = frozenset({"friction_hysteresis", "load_dependent_friction"})
"""Effects that hold a part of the drive until it slides."""
HIDDEN = "as friction hides it"
"""Words by which a finding says why play or stiffness is not given."""
HIDDEN_BY_FRICTION = (
    "Calibration: not stated, as friction hides compliance and play; what model.json holds of them "
    "belongs to its friction and is none of the drive's."
)


def is_hidden_by_friction(findings: Sequence[Finding], topic: str) -> bool:
    """Whether a finding says that friction hides what it is about.

    Parameters
    ----------
    findings : sequence of Finding
        What the loop shows.
    topic : str
        ``"play"``, which is hidden together with the stiffness, or another one.

    Returns
    -------
    bool
    """
    return any(each.topic == topic and HIDDEN in each.text for each in findings)


def follows_temperature(answer: Answer) -> bool:
    """Whether the repaired model has an effect that follows the temperature, named or not."""
    named = [effect.name for effect in answer.effects]
    return "thermal_drift" in (*named, *answer.repaired.stand_ins)


def change_words(change: DriveChange, parameters: Mapping[str, CalibratedParameter]) -> str:
    """Say that the drive changed, and between which ends its compliance lies.

    Parameters
    ----------
    change : DriveChange
        Compliance early and late.
    parameters : mapping of str to CalibratedParameter
        Calibrated parameters by name.

    Returns
    -------
    str
    """
    early, late = change.compliance_early_deg_per_nm, change.compliance_late_deg_per_nm
    low, high = (100 * bound for bound in sorted(map(abs, change.ci95)))
    nominal = parameters["compliance_deg_per_nm"].nominal
    went = "rose" if change.share > 0 else "fell"
    words = (
        f"The drive changed while it was tested: compliance {went}"
        f" by {100 * abs(change.share):.2g} % (95 %: {low:.2g} to {high:.2g}) from {early:.2g} to "
        f"{late:.2g} deg/(N m) at equal torque, earlier against later"
    )
    if nominal:
        ends = sorted((early / nominal, late / nominal))
        words += f", {ends[0]:.2g} to {ends[1]:.2g} times nominal"
    return f"{words}. No stiffness of it holds to three digits."


def play_words(read: PlayAndStiffness | None, *, warms: bool = False) -> str:
    """Say the free play and the stiffness of the drive; nothing where they were not read.

    Parameters
    ----------
    read : PlayAndStiffness or None
        What was read from the loop.
    warms : bool
        Whether they moved with the temperature, so that they are means over the recording.

    Returns
    -------
    str
    """
    if read is None:
        return ""
    said = []
    if play := read.free_play_deg:
        if play.estimate >= 0.0 and play.ci95 is not None:  # where it is none, the overlap is told
            low, high = (as_shown("play_deg", end) for end in play.ci95)
            play = replace(play, ci95=(low, high))
        said.append(f"free play from flank to flank {_read(play, 'deg')}")
        if play.estimate < 0.0:
            said.append("that is none, as the straight lines along the flanks overlap")
    if stiffness := read.stiffness_at_output_nm_per_arcmin:
        said.append(f"stiffness at the output {_read(stiffness, 'N m/arcmin')}")
    return f"Read from the loop{MEANS if warms else ''}: {', '.join(said)}. " if said else ""


def _read(reading: Reading, unit: str) -> str:
    """Value of a reading with its unit and, where there is one, its interval."""
    ends = reading.ci95
    digits = telling_digits(reading.estimate, ends)
    text = f"{reading.estimate:.{digits}g} {unit}"
    if ends is None:
        return text
    return f"{text} (95 %: {ends[0]:.{digits}g} to {ends[1]:.{digits}g})"


def has_friction(answer: Answer) -> bool:
    """Whether the repaired model has a friction, named or not."""
    named = [effect.name for effect in answer.effects]
    return not FRICTIONS.isdisjoint((*named, *answer.repaired.stand_ins))


def calibration_words(
    parameters: Mapping[str, CalibratedParameter],
    *,
    warms: bool = False,
    rubs: bool = False,
    read: PlayAndStiffness | None = None,
) -> str:
    """What the calibration found, against nominal.

    Parameters
    ----------
    parameters : mapping of str to CalibratedParameter
        Calibrated parameters by name.
    warms : bool
        Whether the model has an effect beside them that follows the temperature.
    rubs : bool
        Whether it has a friction beside them: parts that it holds lie beside the elastic ones, and
        the loop is stiffer than these are.
    read : PlayAndStiffness, optional
        What was read from the loop, whose compliance is then another one.

    Returns
    -------
    str
    """
    scale = parameters["compliance_scale"].estimate
    line = parameters.get("compliance_deg_per_nm")
    # Where effects bend the line, its own slope is no compliance of the drive.
    bent = line is not None and not isclose(scale * (line.nominal or 0.0), line.estimate)
    play = parameters["free_play_deg"]
    datum = parameters["datum_deg"].estimate
    # Adding zero turns a negative zero into zero.
    change = round(100 * (scale - 1), 1) + 0.0
    words = (
        f"Calibration{AT_REFERENCE if warms else ''}: compliance {change:+.1f} % against nominal"
    )
    notes = ["between half and full torque"] if bent else []
    if rubs:
        notes.append("of the elastic parts, without those that friction holds")
        if loop := _of_loop(line, read, change):
            notes.append(loop)
    words += f" ({'; '.join(notes)})" if notes else ""
    if play.std_error is not None:
        words += f", free play {degrees(play.estimate)} each side (nominal {play.nominal:.3g})"
    return f"{words}, datum {degrees(datum)}; these are settings of this specimen, not physics."


def _of_loop(line: CalibratedParameter | None, read: PlayAndStiffness | None, change: float) -> str:
    """Compliance of the loop as it was read, against nominal; empty where it is the same.

    Parameters
    ----------
    line : CalibratedParameter or None
        Compliance of the line, with the nominal one.
    read : PlayAndStiffness or None
        What was read from the loop.
    change : float
        What is said of the calibrated one against nominal [%].

    Returns
    -------
    str
    """
    if read is None or read.compliance_deg_per_nm is None or line is None or not line.nominal:
        return ""
    loop = round(100 * (read.compliance_deg_per_nm.estimate / line.nominal - 1), 1) + 0.0
    return "" if loop == change else f"of the loop as read {loop:+.1f} %"
