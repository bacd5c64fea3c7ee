"""Figures of the residual alone: profiles against everything it may depend on, and a map."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep.report.charts import (
    AFTER,
    BEFORE,
    QUIET,
    Band,
    Cells,
    Figure,
    Line,
    Panel,
    Placed,
    Points,
    Series,
)
from cyclosweep.report.data import ReportData
from cyclosweep.report.profiles import Profile, by_group, profile, residual_map
from cyclosweep.report.regions import axis_values
from cyclosweep.report.wording import number

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

MAX_ROWS = 24
"""Most rows of the residual map."""

LEAST_BINS = 3
"""Fewest means that show how a residual depends on something."""

NAME_RESIDUAL_BEFORE = "residual before"
NAME_RESIDUAL_AFTER = "residual after"


def profiles_figures(data: ReportData) -> list[Figure]:
    """Mean residual against everything it may depend on; none where readings are too few."""
    panels = [panel for panel in _profile_panels(data) if _bins(panel) >= LEAST_BINS]
    columns = 2
    if not panels:
        return []
    figure = Figure(
        key="profiles",
        title="Residual against torque, angle, run, time, rate and position",
        caption="Means of bins. The band is simultaneous: noise alone leaves all means of a panel "
        "inside in 99 of 100 cases. Rings lie outside." + _left_out(data) + data.stand_in_note,
        panels=tuple(
            Placed(panel=panel, row=k // columns, column=k % columns)
            for k, panel in enumerate(panels)
        ),
        rows=-(-len(panels) // columns),
        columns=columns,
        row_height=250,
    )
    return [figure]


def map_figure(data: ReportData) -> Figure:
    """Residual map over torque by run and direction, before and after."""
    recording, scored = data.recording, data.scored & ~data.on_the_way_through
    before, after = data.residual_before_deg, data.residual_after_deg
    assert before is not None
    assert after is not None
    sigma, rho = data.noise
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
        "taken together at 99 %." + _left_out(data) + data.stand_in_note,
        panels=panels,
        columns=2,
        row_height=max(150.0, 17.0 * len(names) + 88),
    )


def _bins(panel: Panel) -> int:
    """Number of means in a panel of profiles."""
    return sum(len(s.x) for s in panel.series if isinstance(s, Band))


def _left_out(data: ReportData) -> str:
    """Say how many readings the means leave out; nothing where there are none."""
    count = int(np.count_nonzero(data.on_the_way_through & data.scored))
    return f" {count} readings on the way through the dead zone are left out." if count else ""


def _profile_panels(data: ReportData) -> Iterator[Panel]:
    """One panel for every quantity that the recording has."""
    recording, scored = data.recording, data.scored & ~data.on_the_way_through
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
        yield _run_panel(data, scored)
    if recording.time_s is not None:
        time, label = axis_values(recording, "time")
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
    sigma, rho = data.noise
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


def _run_panel(data: ReportData, rows: Mask) -> Panel:
    """Mean residual of every run."""
    sigma, rho = data.noise
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
