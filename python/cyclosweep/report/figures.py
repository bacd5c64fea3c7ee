"""The figures of a report, from the data behind it."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep.report.charts import (
    AFTER,
    BEFORE,
    FAINT,
    MEASURED,
    MODELLED,
    QUIET,
    Band,
    Cells,
    Figure,
    Line,
    Panel,
    Placed,
    Points,
    Series,
    Span,
)
from cyclosweep.report.data import ReportData
from cyclosweep.report.loops import LOST_MOTION_SHARE, dead_zone_crossings, loop_figures
from cyclosweep.report.profiles import Profile, by_group, profile, residual_map
from cyclosweep.report.thin import thin
from cyclosweep.report.wording import ARCMIN, number

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

NAME_MEASURED = "measured"
NAME_BEFORE = "simulation before"
NAME_AFTER = "simulation after"
NAME_RESIDUAL_BEFORE = "residual before"
NAME_RESIDUAL_AFTER = "residual after"
MAX_ROWS = 24
"""Most rows of the residual map."""


def all_figures(data: ReportData) -> list[Figure]:
    """Every figure that the data allow, the main picture first."""
    if data.recording.angle_deg is None or len(data.recording) < 2:
        return []
    figures = [main_figure(data), zoom_figure(data)]
    if data.residual_before_deg is not None:
        figures += [profiles_figure(data), map_figure(data)]
    return figures


def noise_of(data: ReportData) -> tuple[float, float]:
    """Find standard deviation [deg] and lag-one autocorrelation of the noise."""
    noise: Mapping[str, Any] = data.result.get("noise") or {}
    sigma = noise.get("sigma_deg")
    rho = noise.get("autocorrelation")
    if not isinstance(sigma, int | float) or not np.isfinite(sigma) or sigma <= 0:
        residual = data.residual_after_deg
        if residual is None:
            residual = data.residual_before_deg
        sigma = 0.0 if residual is None else 1.4826 * float(np.median(np.abs(residual)))
    return float(sigma), float(rho) if isinstance(rho, int | float) and np.isfinite(rho) else 0.0


def main_figure(data: ReportData) -> Figure:
    """Loop measured, before and after; residual before and after with the region shaded."""
    recording = data.recording
    shown = _shown_rows(data)
    loop = Panel(
        title="Torque–twist loop",
        x_label=f"torque at the {recording.side} shaft (N m)",
        y_label=f"twist at the {recording.side} shaft (deg)",
        series=tuple(_loop_series(data, shown, _reach(len(recording), len(shown)))),
        spans=tuple(_spans(data, "torque", labelled=False)),
    )
    before, after = data.residual_before_deg, data.residual_after_deg
    if before is None or after is None:
        return Figure(
            key="loop",
            title="Measured loop",
            caption="The recording as it was read. There is no simulation to compare it with.",
            panels=(Placed(panel=loop, row=0, column=0),),
            row_height=430,
        )
    axis = _residual_axis(data)
    x, x_label = _axis_values(recording, axis)
    sigma, _ = noise_of(data)
    rows = shown[data.scored[shown]]
    limit = 1.2 * max(np.abs(before[rows]).max(), np.abs(after[rows]).max(), 2 * sigma, 1e-9)
    located = _located(data)[rows]
    inside, outside = rows[located], rows[~located]
    panels = [Placed(panel=loop, row=0, column=0, rows=2)]
    repair: list[Series] = []
    after_title = "Residual after" if data.is_repaired else "Residual after (no repair)"
    if data.is_repaired:
        added = before - after
        line = _with_breaks(recording, rows, added, x, _reach(len(recording), len(shown)))
        repair = [Line(*line, "what the repair adds", MODELLED, 1.6)]
    for row, (residual, colour, title, model) in enumerate(
        (
            (before, BEFORE, "Residual before", repair),
            (after, AFTER, after_title, []),
        )
    ):
        rmse = float(np.sqrt(np.mean(residual[data.scored] ** 2)))
        panel = Panel(
            title=f"{title}: {number(rmse)} deg rms over all samples",
            x_label=x_label,
            y_label="residual (deg)",
            series=(
                *_noise_band(x[rows], sigma),
                Points(x[outside], residual[outside], "", FAINT, 1.3),
                Points(x[inside], residual[inside], "", colour, 1.3),
                *model,
            ),
            spans=tuple(_spans(data, axis, labelled=row == 0)),
            y_range=(-limit, limit),
            right_factor=ARCMIN,
            right_label="residual (arcmin)",
            zero_line=True,
        )
        panels.append(Placed(panel=panel, row=row, column=1))
    return Figure(
        key="loop",
        title="Measured loop, simulation before and after, and what is left",
        caption="Before: the published model with calibrated stiffness, free play and datum. "
        "After: the same with the effects named below. Shaded: where simulation and recording "
        "differ beyond noise; samples of other directions or runs are grey. Grey band: ±2 standard "
        f"deviations of the noise ({number(sigma)} deg).",
        panels=tuple(panels),
        rows=2,
        columns=2,
        row_height=258,
    )


def zoom_figure(data: ReportData) -> Figure:
    """Loop around zero torque, and the energy lost in each cycle."""
    recording = data.recording
    torque, measured = recording.torque_nm, recording.angle_deg
    assert measured is not None  # all_figures asks first
    rated = data.rated_torque_nm or float(np.abs(torque).max())
    share = LOST_MOTION_SHARE
    while np.count_nonzero(np.abs(torque) <= share * rated) < 20 and share < 0.5:
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


def profiles_figure(data: ReportData) -> Figure:
    """Mean residual against everything it may depend on, with simultaneous bands."""
    panels = list(_profile_panels(data))
    columns = 2
    return Figure(
        key="profiles",
        title="Residual against torque, angle, run, time, rate and position",
        caption="Means of bins. The band is simultaneous: noise alone leaves all means of a panel "
        "inside in 99 of 100 cases. Rings lie outside.",
        panels=tuple(
            Placed(panel=panel, row=k // columns, column=k % columns)
            for k, panel in enumerate(panels)
        ),
        rows=-(-len(panels) // columns),
        columns=columns,
        row_height=250,
    )


def map_figure(data: ReportData) -> Figure:
    """Residual map over torque by run and direction, before and after."""
    recording, scored = data.recording, data.scored
    before, after = data.residual_before_deg, data.residual_after_deg
    assert before is not None
    assert after is not None
    sigma, rho = noise_of(data)
    row, names = _map_rows(recording, scored)
    maps = [
        residual_map(recording.torque_nm[scored], row, names, residual[scored], sigma, rho)
        for residual in (before, after)
    ]
    limit = max(float(np.nanmax(np.abs(maps[0].mean_deg))), sigma, 1e-12)
    y_names = tuple((float(len(names) - 1 - k), name) for k, name in enumerate(names))
    panels = tuple(
        Placed(
            panel=Panel(
                title=title,
                x_label=f"torque at the {recording.side} shaft (N m)",
                y_label="",
                series=(Cells(m.torque_edges_nm, m.mean_deg, m.outside, limit, "deg"),),
                y_names=y_names,
                y_range=(-0.5, len(names) - 0.5),
            ),
            row=0,
            column=column,
        )
        for column, (m, title) in enumerate(zip(maps, ("Before", "After"), strict=True))
    )
    return Figure(
        key="map",
        title="Residual map",
        caption=f"Mean residual by torque, run and direction: orange −{number(limit)} deg, white "
        f"0, blue +{number(limit)} deg. A dot marks a cell that noise does not explain, all cells "
        "taken together at 99 %.",
        panels=panels,
        columns=2,
        row_height=max(150.0, 17.0 * len(names) + 88),
    )


def _shown_rows(data: ReportData) -> NDArray[np.int64]:
    """Choose samples to draw, with the extremes of the residual among them."""
    residual = data.residual_before_deg
    key = data.recording.angle_deg if residual is None else residual
    assert key is not None
    return thin(len(data.recording), key)


def _loop_series(data: ReportData, rows: NDArray[np.int64], reach: int) -> Iterator[Series]:
    """Measured points and simulated lines over torque."""
    recording = data.recording
    measured = recording.angle_deg
    assert measured is not None
    torque = recording.torque_nm
    yield Points(torque[rows], measured[rows], NAME_MEASURED, MEASURED, 1.4)
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
    jump = np.abs(np.diff(torque)) > 0.1 * np.ptp(recording.torque_nm)
    left_out = np.diff(rows) > reach
    crossing = dead_zone_crossings(torque, measured[rows])
    cut = (run[1:] != run[:-1]) | jump | left_out | crossing
    at = np.flatnonzero(cut) + 1
    return np.insert(x[rows], at, np.nan), np.insert(y[rows], at, np.nan)


def _reach(samples: int, shown: int) -> int:
    """Longest step between drawn samples that thinning makes."""
    return 1 if shown >= samples else 4 * -(-samples // shown)


def _noise_band(x: Floats, sigma: float) -> tuple[Band, ...]:
    """Two standard deviations either side of zero."""
    if sigma <= 0 or not len(x):
        return ()
    ends = np.array([x.min(), x.max()])
    return (Band(ends, np.full(2, -2 * sigma), np.full(2, 2 * sigma), "noise ±2σ", QUIET),)


def _regions(data: ReportData) -> list[Mapping[str, Any]]:
    """Regions of mismatch, the largest share first."""
    regions = (data.result.get("mismatch") or {}).get("regions") or []
    return sorted(regions, key=lambda r: -(r.get("share_of_excess") or 0.0))[:4]


def _residual_axis(data: ReportData) -> str:
    """Quantity in which the first region is narrowest: torque, or time where it is an event."""
    regions = _regions(data)
    if not regions:
        return "torque"
    recording, first = data.recording, regions[0]
    torque = first.get("torque_nm")
    share_torque = 1.0
    if torque:
        share_torque = (torque[1] - torque[0]) / max(float(np.ptp(recording.torque_nm)), 1e-12)
    share_time = 1.0
    if first.get("time_s") and recording.time_s is not None:
        low, high = first["time_s"]
        share_time = (high - low) / max(float(np.ptp(recording.time_s)), 1e-12)
    elif first.get("run"):
        share_time = float(np.mean(_in_run_range(recording, first["run"])))
    return "time" if share_time < 0.75 * share_torque else "torque"


def _in_run_range(recording: Recording, ends: Any) -> Mask:
    """Mark the samples of the runs from the first to the last named."""
    first, last = int(min(ends)), int(max(ends))
    return (recording.run >= first) & (recording.run <= last)


def _axis_values(recording: Recording, axis: str) -> tuple[Floats, str]:
    """Values and label of the residual's axis."""
    if axis == "torque":
        return recording.torque_nm, f"torque at the {recording.side} shaft (N m)"
    if recording.time_s is not None and _is_monotone(recording):
        return recording.time_s, "time (s)"
    return np.arange(1.0, len(recording) + 1), "sample"


def _is_monotone(recording: Recording) -> bool:
    """Whether the clock runs through all runs without starting afresh."""
    return recording.time_s is not None and bool((np.diff(recording.time_s) >= 0).all())


def _spans(data: ReportData, axis: str, *, labelled: bool) -> Iterator[Span]:
    """Shaded stretches of the regions on an axis."""
    recording = data.recording
    x, _ = _axis_values(recording, axis)
    for region in _regions(data)[:2]:
        if axis == "torque":
            ends = region.get("torque_nm")
        elif region.get("time_s") and recording.time_s is not None and _is_monotone(recording):
            ends = region["time_s"]
        elif region.get("run"):
            rows = _in_run_range(recording, region["run"])
            ends = [x[rows].min(), x[rows].max()] if rows.any() else None
        else:
            ends = None
        if ends:
            yield Span(float(ends[0]), float(ends[1]), _region_label(region) if labelled else "")
            labelled = False


def _located(data: ReportData) -> Mask:
    """Mark the samples of the shaded regions; all where there is none."""
    recording = data.recording
    regions = _regions(data)[:2]
    marked = np.full(len(recording), not regions)
    for region in regions:
        rows = np.ones(len(recording), dtype=bool)
        for key, values in (
            ("torque_nm", recording.torque_nm),
            ("time_s", recording.time_s),
            ("temperature_c", recording.temperature_c),
        ):
            if region.get(key) and values is not None:
                low, high = region[key]
                rows &= (values >= low) & (values <= high)
        if region.get("run"):
            rows &= _in_run_range(recording, region["run"])
        if region.get("direction") in ("loading", "unloading"):
            rows &= recording.structure.loading == (region["direction"] == "loading")
        marked |= rows
    return marked


def _region_label(region: Mapping[str, Any]) -> str:
    """Direction and runs of a region."""
    words = [str(region["direction"])] if region.get("direction") not in (None, "both") else []
    run = region.get("run")
    if run:
        words.append(f"run {run[0]}" if run[0] == run[-1] else f"runs {run[0]}–{run[-1]}")
    return ", ".join(words)


def _profile_panels(data: ReportData) -> Iterator[Panel]:
    """One panel for every quantity that the recording has."""
    recording, scored = data.recording, data.scored
    structure = recording.structure
    side = recording.side
    torque_label = f"torque at the {side} shaft (N m)"
    yield _profile_panel(
        data, recording.torque_nm, scored & structure.loading, "Loading", torque_label, split=True
    )
    yield _profile_panel(
        data,
        recording.torque_nm,
        scored & ~structure.loading,
        "Unloading",
        torque_label,
        split=True,
    )
    assert recording.angle_deg is not None
    yield _profile_panel(
        data, recording.angle_deg, scored, "Twist", f"twist at the {side} shaft (deg)", split=True
    )
    if len(set(recording.run[scored])) > 1:
        yield _run_panel(data)
    if recording.time_s is not None:
        time, label = _axis_values(recording, "time")
        yield _profile_panel(data, time, scored, "Time", label, bins=72)
        yield _profile_panel(
            data, _torque_rate(recording), scored, "Rate of loading", "torque rate (N m/s)"
        )
    if recording.crank_deg is not None and np.ptp(recording.crank_deg) > 0:
        yield _profile_panel(
            data, recording.crank_deg % 360.0, scored, "Mesh position", "crank position (deg)"
        )
    if recording.temperature_c is not None and np.ptp(recording.temperature_c) > 0:
        yield _profile_panel(
            data, recording.temperature_c, scored, "Temperature", "temperature (°C)"
        )


def _profile_panel(
    data: ReportData,
    x: Floats,
    rows: Mask,
    title: str,
    label: str,
    *,
    split: bool = False,
    bins: int = 24,
) -> Panel:
    """Mean residual before and after against one quantity, each side of zero by itself if asked."""
    sigma, rho = noise_of(data)
    before, after = data.residual_before_deg, data.residual_after_deg
    assert before is not None
    assert after is not None
    parts = [rows & (x < 0), rows & (x >= 0)] if split else [rows]
    parts = [part for part in parts if np.count_nonzero(part) >= 2]
    series: list[Series] = []
    for part in parts:
        profiles = [
            (profile(x[part], residual[part], sigma, rho, bins=bins // len(parts), cells=bins),
             name, colour)
            for residual, name, colour in (
                (before, NAME_RESIDUAL_BEFORE, BEFORE),
                (after, NAME_RESIDUAL_AFTER, AFTER),
            )
        ]  # fmt: skip
        series += _profile_series(profiles)
    return Panel(
        title=title, x_label=label, y_label="mean residual (deg)", series=tuple(series),
        zero_line=True,
    )  # fmt: skip


def _profile_series(profiles: list[tuple[Profile, str, str]]) -> list[Series]:
    """Band, lines and rings of profiles that share their bins."""
    first = profiles[0][0]
    series: list[Series] = [
        Band(first.x, -first.band_deg, first.band_deg, "what noise explains", QUIET)
    ]
    for means, name, colour in profiles:
        series.append(Line(means.x, means.mean_deg, name, colour, 1.8, colour == BEFORE))
        series.append(Points(means.x, means.mean_deg, name, colour, 2.0))
        out = means.outside
        series.append(Points(means.x[out], means.mean_deg[out], name, colour, 3.6, hollow=True))
    return series


def _run_panel(data: ReportData) -> Panel:
    """Mean residual of every run."""
    sigma, rho = noise_of(data)
    rows = data.scored
    before, after = data.residual_before_deg, data.residual_after_deg
    assert before is not None
    assert after is not None
    run = data.recording.run[rows]
    profiles = [
        (by_group(run, residual[rows], sigma, rho), name, colour)
        for residual, name, colour in (
            (before, NAME_RESIDUAL_BEFORE, BEFORE),
            (after, NAME_RESIDUAL_AFTER, AFTER),
        )
    ]
    numbers = profiles[0][0].x
    step = max(1, len(numbers) // 12)
    return Panel(
        title="Run",
        x_label="run",
        y_label="mean residual (deg)",
        series=tuple(_profile_series(profiles)),
        x_names=tuple((float(n), f"{n:.0f}") for n in numbers[::step]),
        zero_line=True,
    )


def _torque_rate(recording: Recording) -> Floats:
    """Rate of torque within each run [N m/s]; 0 where the clock stands still."""
    assert recording.time_s is not None
    rate = np.zeros(len(recording))
    for run in recording.runs:
        rows = np.flatnonzero(recording.run == run)
        if len(rows) < 2:
            continue
        step = np.diff(recording.time_s[rows])
        slope = np.divide(
            np.diff(recording.torque_nm[rows]), step, out=np.zeros(len(step)), where=step > 0
        )
        rate[rows] = np.r_[slope[:1], slope]
    return rate


def _map_rows(recording: Recording, scored: Mask) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """Row of every scored sample in the residual map, and the rows' names."""
    loading = recording.structure.loading[scored]
    run = recording.run[scored]
    runs = list(dict.fromkeys(run.tolist()))
    group = max(1, -(-2 * len(runs) // MAX_ROWS))
    place = {k: number // group for number, k in enumerate(runs)}
    row = 2 * np.array([place[k] for k in run.tolist()], dtype=np.int64) + ~loading
    names: list[str] = []
    for start in range(0, len(runs), group):
        members = runs[start : start + group]
        label = f"run {members[0]}" if group == 1 else f"runs {members[0]}–{members[-1]}"
        names += [f"{label} loading", f"{label} unloading"]
    return row, tuple(names)


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
