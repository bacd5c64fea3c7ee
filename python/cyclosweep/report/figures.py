"""The figures of a report: the main picture, the zoom with the energy, those of the residual."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep.report.charts import (
    AFTER,
    BEFORE,
    MEASURED,
    MODELLED,
    Figure,
    Line,
    Panel,
    Placed,
    Points,
    Series,
)
from cyclosweep.report.data import ReportData
from cyclosweep.report.dots import ResidualDots, dot_size
from cyclosweep.report.loops import LOST_MOTION_SHARE, dead_zone_crossings, loop_figures
from cyclosweep.report.regions import spans_of
from cyclosweep.report.residual_figures import map_figure, profiles_figures
from cyclosweep.report.residual_panel import Residual, ResidualAxis
from cyclosweep.report.thin import thin
from cyclosweep.report.wording import number
from cyclosweep.result.stand_in_words import stand_in_words

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

COUNTED = {
    "readings in contact": [
        "Errors count readings in contact, each on the flank that the recording shows."
    ],
    "whole loops": [
        "Errors count whole loops, the way through the play included: where a simulation crosses "
        "it early or late, a reading is wrong by the whole play."
    ],
}
"""What is said of the readings that errors count."""
NAME_MEASURED = "measured"
NAME_BEFORE = "simulation before"
NAME_AFTER = "simulation after"


def all_figures(data: ReportData) -> list[Figure]:
    """Every figure that the data allow, the main picture first."""
    if data.recording.angle_deg is None or len(data.recording) < 2:
        return []
    figures = [main_figure(data), zoom_figure(data)]
    if data.residual_before_deg is not None:
        figures += [*profiles_figures(data), map_figure(data)]
    return figures


def main_figure(data: ReportData) -> Figure:
    """Loop measured, before and after; residual before and after with the region shaded."""
    shown = _shown_rows(data)
    loop = _loop_panel(data, shown)
    before, after = data.residual_before_deg, data.residual_after_deg
    if before is None or after is None:
        return Figure(
            key="loop",
            title="Measured loop",
            caption="The recording as it was read. There is no simulation to compare it with.",
            panels=(Placed(panel=loop, row=0, column=0),),
            row_height=430,
        )
    axis = ResidualAxis.of(data, shown[data.scored[shown]])
    repair = _repair_series(data, axis, before - after, _reach(len(data.recording), len(shown)))
    title = "Residual after" if data.is_repaired else "Residual after (no repair)"
    upper = Residual("Residual before", BEFORE, before, data.result.baseline.rmse_deg, repair, True)
    lower = Residual(title, AFTER, after, data.result.repaired.rmse_deg, (), False)
    return Figure(
        key="loop",
        title="Measured loop, simulation before and after, and what is left",
        caption=_main_caption(data, axis.dots, np.maximum(abs(before), abs(after))),
        panels=(
            Placed(panel=loop, row=0, column=0, rows=2),
            Placed(panel=upper.panel(data, axis, axis.dots.before_deg), row=0, column=1),
            Placed(panel=lower.panel(data, axis, axis.dots.after_deg), row=1, column=1),
        ),
        rows=2,
        columns=2,
        row_height=258,
    )


def _loop_panel(data: ReportData, rows: NDArray[np.int64]) -> Panel:
    """Twist over torque."""
    return Panel(
        title="Torque–twist loop",
        x_label=f"torque at the {data.recording.side} shaft (N m)",
        y_label=f"twist at the {data.recording.side} shaft (deg)",
        series=tuple(_loop_series(data, rows, _reach(len(data.recording), len(rows)))),
        spans=tuple(spans_of(data, "torque", labelled=False)),
    )


def _repair_series(
    data: ReportData, axis: ResidualAxis, added_deg: Floats, reach: int
) -> tuple[Series, ...]:
    """Line of what the repair adds to the simulation.

    Parameters
    ----------
    data : ReportData
    axis : ResidualAxis
    added_deg : ndarray, shape (n,)
        Twist of the repaired simulation beyond that of the calibrated one [deg].
    reach : int
        Samples between two drawn ones beyond which the line is broken.

    Returns
    -------
    tuple of Series
        Empty where nothing was repaired.
    """
    if not data.is_repaired:
        return ()
    line = _with_breaks(data.recording, axis.rows, added_deg, axis.x, reach)
    return (Line(*line, "what the repair adds", MODELLED, 1.6),)


def _main_caption(data: ReportData, dots: ResidualDots, largest_deg: Floats) -> str:
    """Words below the main picture.

    Parameters
    ----------
    data : ReportData
    dots : ResidualDots
    largest_deg : ndarray, shape (n,)
        Larger residual of each sample, before or after [deg].

    Returns
    -------
    str
    """
    change = _change(data)
    words = [
        "Before: the published model with calibrated stiffness, free play and datum. "
        f"After: the same{change}. Shaded: where simulation and recording "
        "differ beyond noise; samples of other directions or runs are grey. Grey band: ±2 standard "
        f"deviations of the noise of a dot ({number(dots.sigma_deg)} deg)."
    ]
    words += COUNTED.get(data.result.baseline.counted or "", [])
    if dots.averaged > 1:
        words.append(
            f"A dot is the mean of {dots.averaged} neighbouring samples, as in the diagnosis."
        )
        beyond = int(np.count_nonzero(data.on_the_way_through))
    else:
        beyond = int(np.count_nonzero(largest_deg[data.scored] > dots.limit_deg))
    if beyond:
        words.append(
            f"{beyond} of {np.count_nonzero(data.scored)} samples lie beyond the scale of the "
            "residuals, most of them on the way through the dead zone."
        )
    return " ".join(words)


def _change(data: ReportData) -> str:
    """What the repaired model has beyond the calibrated one, in words."""
    named = "the effects named below" if data.result.effects else ""
    parts = [part for part in (named, stand_in_words(data.result)) if part]
    return f" with {' and '.join(parts)}" if parts else ", as nothing was repaired"


def zoom_figure(data: ReportData) -> Figure:
    """Loop around zero torque, and the energy lost in each cycle."""
    recording = data.recording
    torque, measured = recording.torque_nm, recording.angle_deg
    assert measured is not None  # all_figures asks first
    rated = data.rated_torque_nm or float(np.abs(torque).max())
    share = LOST_MOTION_SHARE
    enough = min(20, len(torque) // 4)
    while np.count_nonzero(np.abs(torque) <= share * rated) < enough and share < 0.5:
        share *= 2
    near = np.flatnonzero(np.abs(torque) <= share * rated)
    every = len(near)
    near = near[thin(every, measured[near], 3000)]
    reach = _reach(every, len(near))
    of = "rated" if data.rated_torque_nm else "the largest"
    sides = _zoom_sides(torque[near], measured[near], share * rated)
    panels = [
        Placed(
            panel=Panel(
                title=f"Around zero: ±{number(100 * share)} % of {of} torque" if not column else "",
                x_label=f"torque at the {recording.side} shaft (N m)",
                y_label=f"twist at the {recording.side} shaft (deg)",
                series=tuple(_loop_series(data, near[rows], reach)),
                x_range=x_range,
            ),
            row=0,
            column=column,
        )
        for column, (rows, x_range) in enumerate(sides)
    ]
    energy = _energy_series(data)
    if energy:
        runs = list(recording.runs)
        step = max(1, len(runs) // 12)
        panels.append(
            Placed(
                panel=Panel(
                    title="Energy lost in one cycle",
                    x_label="run",
                    y_label="energy (J)",
                    series=tuple(energy),
                    x_names=tuple((float(k), str(run)) for k, run in enumerate(runs))[::step],
                    x_range=(-0.6, len(runs) - 0.4),
                ),
                row=0,
                column=len(sides),
            )
        )
    return Figure(
        key="zoom",
        title="Around zero torque, and energy",
        caption="Lost motion is read between +3 % and −3 % of rated torque at mid-width, the "
        "hysteresis loss as the gap between the branches at zero torque.",
        panels=tuple(panels),
        columns=len(sides) + 1,
        row_height=330,
    )


def _zoom_sides(
    torque: Floats, angle: Floats, limit: float
) -> list[tuple[Mask, tuple[float, float]]]:
    """Both sides of the dead zone in one panel, or in two where it dwarfs everything else."""
    right = torque >= 0
    both = np.ones(len(torque), dtype=bool)
    if not right.any() or right.all():
        return [(both, (-limit, limit))]
    within = max(np.ptp(angle[right]), np.ptp(angle[~right]))
    if np.ptp(angle) < 5 * within:
        return [(both, (-limit, limit))]
    return [(~right, (-limit, 0.0)), (right, (0.0, limit))]


def _shown_rows(data: ReportData) -> NDArray[np.int64]:
    """Choose samples to draw, with the extremes of the residual among them."""
    residual = data.residual_before_deg
    key = data.recording.angle_deg if residual is None else residual
    assert key is not None
    run = data.recording.run
    ends = np.flatnonzero(np.diff(run, prepend=run[:1] - 1, append=run[-1:] + 1))
    ends = np.unique(np.r_[ends[:-1], ends[1:] - 1])
    chosen = thin(len(data.recording), key)
    return np.union1d(chosen, ends) if len(ends) < len(chosen) else chosen


def _loop_series(data: ReportData, rows: NDArray[np.int64], reach: int) -> Iterator[Series]:
    """Measured points and simulated lines over torque."""
    recording = data.recording
    measured = recording.angle_deg
    assert measured is not None
    torque = recording.torque_nm
    yield Points(torque[rows], measured[rows], NAME_MEASURED, MEASURED, dot_size(len(rows)))
    for angle, name, colour, dashed in (
        (data.before_deg, NAME_BEFORE, BEFORE, True),
        (data.after_deg, NAME_AFTER, AFTER, False),
    ):
        if angle is not None:
            x, y = _with_breaks(recording, rows, angle, torque, reach)
            yield Line(x, y, name, colour, 1.5, dashed)


def _with_breaks(
    recording: Recording, rows: NDArray[np.int64], y: Floats, x: Floats, reach: int
) -> tuple[Floats, Floats]:
    """Put a NaN where the run ends, the dead zone is crossed unseen, or samples are left out.

    Thinned rows leave out some samples anyway; `reach` is how many.
    """
    measured = recording.angle_deg
    assert measured is not None
    torque, run = recording.torque_nm[rows], recording.run[rows]
    step = np.abs(np.diff(torque))
    # A dozen readings by hand are far apart, all of them.
    usual = 3.0 * float(np.median(step)) if len(step) else 0.0
    jump = step > max(0.1 * float(np.ptp(recording.torque_nm)), usual)
    left_out = np.diff(rows) > reach
    crossing = dead_zone_crossings(torque, measured[rows])
    cut = (run[1:] != run[:-1]) | jump | left_out | crossing
    at = np.flatnonzero(cut) + 1
    return np.insert(x[rows], at, np.nan), np.insert(y[rows], at, np.nan)


def _reach(samples: int, shown: int) -> int:
    """Longest step between drawn samples that thinning makes."""
    return 1 if shown >= samples else 4 * -(-samples // shown)


def _energy_series(data: ReportData) -> list[Series]:
    """Energy per cycle of the measured loop and of both simulations."""
    recording = data.recording
    place = {run: float(k) for k, run in enumerate(recording.runs)}
    series: list[Series] = []
    for angle, name, colour, hollow, shift in (
        (recording.angle_deg, NAME_MEASURED, MEASURED, False, 0.0),
        (data.before_deg, NAME_BEFORE, BEFORE, True, -0.14),
        (data.after_deg, NAME_AFTER, AFTER, True, 0.14),
    ):
        if angle is None:
            continue
        energy = loop_figures(recording, angle, data.rated_torque_nm).energy_j
        if energy:
            x = np.array([place[run] + shift for run in energy])
            series.append(Points(x, np.array(list(energy.values())), name, colour, 4.2, hollow))
    return series
