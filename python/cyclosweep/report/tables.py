"""The tables of a report as plain rows, shared by the page and the terminal."""

from collections.abc import Callable

import numpy as np

from cyclosweep.page import Table
from cyclosweep.report.data import ReportData
from cyclosweep.report.loop_width import fitted_frictions, width_label
from cyclosweep.report.loops import LoopFigures, loop_figures
from cyclosweep.report.sentences import runs_backwards
from cyclosweep.report.wording import (
    ARCMIN,
    NOTHING,
    angle,
    interval,
    number,
    probability,
    with_error,
    without_unit,
)
from cyclosweep.result import CalibratedParameter, Reading
from cyclosweep.result.calibration_words import AT_REFERENCE, follows_temperature
from cyclosweep.result.series import as_shown
from cyclosweep.result.words import readable, telling_digits


def loop_table(data: ReportData) -> Table | None:
    """Lost motion, hysteresis loss, stiffness and energy: measured, before, after."""
    measured = data.recording.angle_deg
    if measured is None or len(data.recording) < 2:
        return None
    sources = [("measured", measured), ("before", data.before_deg), ("after", data.after_deg)]
    columns = [(name, loop_figures(data.recording, a, data.rated_torque_nm))
               for name, a in sources if a is not None]  # fmt: skip
    figures = [f for _, f in columns]
    side, rated = data.recording.side, data.rated_torque_nm
    of = "rated" if rated else "the largest"
    low, high = figures[0].stiffness_range_nm
    reach = f"{number(low)} to {number(high)} N m"
    extended = " (extended)" if figures[0].extrapolated else ""
    rows = [
        (
            f"lost motion at ±3 % of {of} torque{extended}",
            *(angle(f.lost_motion_deg) for f in figures),
        ),
        (f"hysteresis loss{extended}", *(angle(f.hysteresis_loss_deg) for f in figures)),
        (
            f"slope of the loading branches at the {side}, {reach}",
            *(_stiffness(f.stiffness_nm_per_deg) for f in figures),
        ),
    ]
    if side == "input" and data.ratio:
        ratio = data.ratio
        rows += [
            ("the same slope at the output", *(_at_output(f, ratio) for f in figures)),
            ("lost motion at the output", *(_divided(f.lost_motion_deg, ratio) for f in figures)),
            (
                "hysteresis loss at the output",
                *(_divided(f.hysteresis_loss_deg, ratio) for f in figures),
            ),
        ]
    rows.append(("energy lost in one cycle, mean", *(_mean_energy(f) for f in figures)))
    rows = [row for row in rows if any(cell != NOTHING for cell in row[1:])]
    if not rows:
        return None
    note = (
        f"The slope of the loading branches is taken from {reach}. It contains what friction takes "
        "of the torque on the way up, so that it differs from the stiffness at the top of the "
        "page. Lost motion is the middle of the loop at small torque alone, where free play at the "
        "top of the page is met by lines through the loaded flanks."
    )
    lost, gap = figures[0].lost_motion_deg, figures[0].hysteresis_loss_deg
    if lost is not None and gap is not None and gap > lost:
        note += (
            " Friction holds the shaft inside its play here: the play shows as hysteresis loss "
            "rather than as lost motion."
        )
    if figures[0].extrapolated:
        note += (
            " No sample lies within ±3 % of that torque: lost motion and hysteresis loss are "
            "straight-line extensions of the nearest samples."
        )
    note += data.stand_in_note
    return Table("Loop figures", ("", *(n for n, _ in columns)), tuple(rows), note)


def parameter_table(data: ReportData) -> Table | None:
    """Baseline parameters before and after the repair, with the shift in standard errors."""
    before, after = data.result.baseline.parameters, data.result.repaired.parameters
    if not before:
        return None
    rows = [
        (
            without_unit(name),
            value.unit or NOTHING,
            number(value.nominal, 4),
            _estimate(value),
            _estimate(after.get(name)),
            _shift(value, after.get(name)),
        )
        for name, value in before.items()
    ]
    rows += [
        (without_unit(name), value.unit or NOTHING, NOTHING, NOTHING, _estimate(value), NOTHING)
        for name, value in after.items()
        if name not in before
    ]
    return Table(
        "Parameters",
        ("parameter", "unit", "nominal", "before", "after", "shift (standard errors)"),
        tuple(rows),
        "A stiffness, free play or datum that differs from nominal is calibration, not missing "
        "physics. The shift is how far the repair moved a parameter, in standard errors of the "
        "fit before; behind ± stands the half width of the 95 % interval. With effects in the "
        "model, its compliance and play are what these leave: the drive's own stand at the top of "
        "the page. The compliance scale counts the effects that bend the line, between half and "
        "full torque." + data.stand_in_note,
        frozenset({1}),
    )


def hypothesis_table(data: ReportData) -> Table | None:
    """Every effect of the library: hidden share, size, interval, evidence, smallest detectable."""
    rows: list[tuple[str, ...]] = []
    lead: set[int] = set()
    for row in data.hypotheses:
        if row.outcome == "accepted":
            lead.add(len(rows))
        digits = 3 if row.size_deg is None else telling_digits(row.size_deg, row.ci95_deg)
        rows.append(
            (
                readable(row.name),
                row.outcome,
                NOTHING if row.absorbed_share is None else f"{100 * row.absorbed_share:.0f} %",
                number(row.size_deg, digits),
                interval(row.ci95_deg, digits),
                probability(row.p_value),
                number(row.e_value, 2),
                number(row.smallest_detectable_deg),
            )
        )
    if not rows:
        return None
    return Table(
        "Every effect that was tried",
        (
            "effect", "outcome", "hidden by calibration", "size (deg)", "95 % interval (deg)",
            "p", "e", "smallest detectable (deg)",
        ),
        tuple(rows),
        "Hidden by calibration: share of the effect that a refit of stiffness, free play and datum "
        "absorbs. p: chance of so large a signal where the accepted effects are all there is, all "
        "others searched; a dash where what is left is error of the model rather than noise. "
        "e: evidence for the accepted effects together from data not used; 100 is strong, and a "
        "small one says nothing against them, as the published model beside them is calibrated to "
        "each part of those data anew.",
        frozenset({1}),
        frozenset(lead),
    )  # fmt: skip


def held_out_table(data: ReportData) -> Table | None:
    """Errors on data that was not used."""
    if not data.held_out_rows:
        return None
    if any(row.told_after_deg is not None for row in data.held_out_rows):
        return _forecast_table(data)
    rows = tuple(
        (
            row.block,
            _count(row.samples),
            number(row.rmse_before_deg),
            number(row.rmse_after_deg),
            number(row.floor_deg),
        )
        for row in data.held_out_rows
    )
    return Table(
        "Held-out errors",
        ("block", "samples", "before (deg rms)", "after (deg rms)", "floor (deg rms)"),
        rows,
        "The floor is what noise, or one replicate against another, leaves." + data.stand_in_note,
    )


def _forecast_table(data: ReportData) -> Table:
    """Errors of forecasts, three ways, beside the error of another run as the prediction."""
    rows = []
    for row in data.held_out_rows:
        for how, before, after, floor in (
            ("free forecast, all samples", row.rmse_before_deg, row.rmse_after_deg, row.floor_deg),
            (
                "flank as recorded, samples in contact",
                row.told_before_deg,
                row.told_after_deg,
                None,
            ),
            ("distance to the curve", row.near_before_deg, row.near_after_deg, None),
        ):
            rows.append(
                (row.block, how, _count(row.samples), number(before), number(after), number(floor))
            )
    return Table(
        "Held-out errors",
        (
            "block", "judged by", "samples", "before (deg rms)", "after (deg rms)",
            "replicate floor (deg rms)",
        ),
        tuple(rows),
        "A free forecast is what `cyclosweep simulate model.json` gives: it has to find for itself "
        "when the shaft leaves a flank, and a crossing of the dead zone that comes a moment early "
        "or late costs the whole play for that moment. With the flank as recorded, the same model "
        "is asked only for the twist on it. The distance to the curve forgives early and late "
        "alike. The floor is what an earlier run leaves as the prediction of this one."
        + data.stand_in_note,
        frozenset({1}),
        frozenset(range(0, len(rows), 3)),
    )  # fmt: skip


def self_check_table(data: ReportData) -> Table | None:
    """Say what the diagnosis does on synthetic twins of this recording."""
    check = data.result.self_check
    if check is None or (check.false_alarm is None and check.power is None):
        return None
    rows = [
        ("false alarms with nothing missing", _percent(check.false_alarm)),
        ("found, when the named effect is there", _percent(check.power)),
    ]
    for name, shares in check.confusion.items():
        text = ", ".join(
            f"{readable(called)} {_percent(share)}" for called, share in shares.items()
        )
        rows.append((f"twin with {readable(name)} is called", text))
    return Table(
        "Self-check on synthetic twins of this recording",
        ("", "share of twins"),
        tuple(rows),
        "Twins have the same load history, noise and resolution, and known causes.",
        frozenset({1}) if check.confusion else frozenset(),
    )


def _shift(before: CalibratedParameter, after: CalibratedParameter | None) -> str:
    """How far the repair moved a parameter, in standard errors."""
    if after is None or not before.std_error:
        return NOTHING
    shift = (after.estimate - before.estimate) / before.std_error
    return f"{shift:+.1f}".replace("-", "−")


def _stiffness(nm_per_deg: float | None) -> str:
    """Stiffness in N m/arcmin and N m/rad."""
    if nm_per_deg is None:
        return NOTHING
    return f"{number(nm_per_deg / ARCMIN)} N m/arcmin ({number(np.degrees(nm_per_deg))} N m/rad)"


def _at_output(figures: LoopFigures, ratio: float) -> str:
    """Stiffness of the input shaft as seen from the output shaft."""
    k = figures.stiffness_nm_per_deg
    return _stiffness(None if k is None else k * ratio**2)


def _divided(value_deg: float | None, ratio: float) -> str:
    """Angle of the input shaft as seen from the output shaft."""
    return angle(None if value_deg is None else value_deg / ratio)


def _mean_energy(figures: LoopFigures) -> str:
    """Mean energy of the cycles."""
    energy = list(figures.energy_j.values())
    return f"{number(float(np.mean(energy)))} J" if energy else NOTHING


def _percent(share: float | None) -> str:
    """Write a share in percent."""
    return NOTHING if share is None else f"{100 * share:.3g} %"


def _count(samples: int | None) -> str:
    """Write a number of samples."""
    return NOTHING if samples is None else str(samples)


def _estimate(value: CalibratedParameter | None) -> str:
    """Estimate of a parameter with its standard error."""
    return NOTHING if value is None else with_error(value.estimate, value.std_error)


def play_table(data: ReportData) -> Table | None:
    """The free play, the stiffness and the friction of the drive, by one definition each."""
    read = data.result.play_and_stiffness
    if read is None:
        return None
    side = data.recording.side
    friction = _friction(read.friction_nm, runs_backwards(data))
    rows = [
        (f"free play at the {side}, from flank to flank", *_play(read.free_play_deg)),
        ("stiffness at the output", *_read(read.stiffness_at_output_nm_per_arcmin, _stiffnesses)),
        (width_label(data), *friction),
        *((label, *_read(torque, _torques)) for label, torque in fitted_frictions(data)),
    ]
    if side == "input":
        rows.insert(1, ("free play at the output", *_play(read.free_play_at_output_deg)))
    shown = tuple(row for row in rows if row[1] != NOTHING)
    note = f"Read by {read.definition}."
    if read.runs == 1:
        note += " No intervals: there is a single run to read from."
    elif read.runs:
        note += f" Intervals by Student's t over {read.runs} runs."
    if follows_temperature(data.result):
        note += (
            " The values are means over the recording, whose temperature changed: the calibration "
            f"beside thermal drift, under Parameters, holds{AT_REFERENCE}."
        )
    if read.reason:
        note += f" A value is missing because {read.reason}."
    return Table("Free play and stiffness", ("", "value", "95 % interval"), shown, note)


def _read(reading: Reading | None, write: Callable[[float, int], str]) -> tuple[str, str]:
    """Value and interval of a reading."""
    if reading is None:
        return NOTHING, NOTHING
    digits = telling_digits(reading.estimate, reading.ci95)
    return write(reading.estimate, digits), interval(reading.ci95, digits)


def _play(reading: Reading | None) -> tuple[str, str]:
    """Free play and its interval, neither below zero: where the lines overlap there is none."""
    if reading is None:
        return NOTHING, NOTHING
    digits = telling_digits(reading.estimate, reading.ci95)
    ends = None if reading.ci95 is None else [as_shown("play_deg", end) for end in reading.ci95]
    if reading.estimate < 0.0:
        overlap = angle(-reading.estimate, digits)
        return f"none, the lines overlap by {overlap}", interval(ends, digits)
    return angle(reading.estimate, digits), interval(ends, digits)


def _friction(reading: Reading | None, backwards: bool) -> tuple[str, str]:
    """Friction and its interval; none where the interval holds zero, or where it was not read.

    Parameters
    ----------
    reading : Reading or None
        As read from the loop.
    backwards : bool
        Whether the loop runs the wrong way round, so that a value below zero is no error.

    Returns
    -------
    (str, str)
    """
    if reading is None:
        return "not read", NOTHING
    if reading.ci95 is None and reading.estimate <= 0.0 and not backwards:
        return "none found", NOTHING
    low, high = reading.ci95 or (reading.estimate, reading.estimate)
    if low <= 0.0 <= high:
        return "none found", f"at most {_torques(high)}" if high > 0.0 else NOTHING
    return _read(reading, _torques)


def _stiffnesses(nm_per_arcmin: float, digits: int) -> str:
    """Stiffness in N m/arcmin and as compliance."""
    compliance = 1.0 / (ARCMIN * nm_per_arcmin)
    return f"{number(nm_per_arcmin, digits)} N m/arcmin ({number(compliance, digits)} deg/(N m))"


def _torques(value_nm: float, digits: int = 3) -> str:
    """Torque."""
    return f"{number(value_nm, digits)} N m"
