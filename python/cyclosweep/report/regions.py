"""Where simulation and recording differ, as stretches of an axis and as samples."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep.report.charts import Span
from cyclosweep.report.data import ReportData
from cyclosweep.result import Region

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


def regions_of(data: ReportData) -> list[Region]:
    """Regions of mismatch, the largest share first."""
    return sorted(data.result.mismatch.regions, key=lambda r: -(r.share_of_excess or 0.0))[:4]


def residual_axis(data: ReportData) -> str:
    """Quantity in which the first region is narrowest: torque, or time where it is an event."""
    regions = regions_of(data)
    if not regions:
        return "torque"
    recording, first = data.recording, regions[0]
    share_torque = 1.0
    if first.torque_nm:
        low, high = first.torque_nm
        share_torque = (high - low) / max(float(np.ptp(recording.torque_nm)), 1e-12)
    share_time = 1.0
    if first.time_s and recording.time_s is not None:
        low, high = first.time_s
        share_time = (high - low) / max(float(np.ptp(recording.time_s)), 1e-12)
    elif first.run:
        share_time = float(np.mean(_in_run_range(recording, first)))
    return "time" if share_time < 0.75 * share_torque else "torque"


def _in_run_range(recording: Recording, region: Region) -> Mask:
    """Mark the samples of the runs and readings from the first to the last named."""
    ends = region.run or (int(recording.run.min()), int(recording.run.max()))
    rows = (recording.run >= min(ends)) & (recording.run <= max(ends))
    if region.readings:
        place = np.arange(1, len(recording) + 1)
        rows &= (place >= region.readings[0]) & (place <= region.readings[1])
    return np.asarray(rows)


def axis_values(recording: Recording, axis: str) -> tuple[Floats, str]:
    """Return values and label of the residual's axis.

    Parameters
    ----------
    recording : Recording
        What was measured.
    axis : {"torque", "time"}
        Quantity; where there is no clock through all runs, the sample's number stands for time.

    Returns
    -------
    values : ndarray of float, shape (n,)
    label : str
        With the unit.
    """
    if axis == "torque":
        return recording.torque_nm, f"torque at the {recording.side} shaft (N m)"
    if recording.time_s is not None and _is_monotone(recording):
        return recording.time_s, "time (s)"
    return np.arange(1.0, len(recording) + 1), "sample"


def _is_monotone(recording: Recording) -> bool:
    """Whether the clock runs through all runs without starting afresh."""
    return recording.time_s is not None and bool((np.diff(recording.time_s) >= 0).all())


def spans_of(data: ReportData, axis: str, *, labelled: bool) -> Iterator[Span]:
    """Shaded stretches of the regions on an axis.

    Parameters
    ----------
    data : ReportData
        With the regions.
    axis : {"torque", "time"}
        Quantity of the axis.
    labelled : bool
        Whether the first stretch carries direction and runs.

    Yields
    ------
    Span
    """
    recording = data.recording
    x, _ = axis_values(recording, axis)
    for region in regions_of(data)[:2]:
        ends: tuple[float, float] | None = None
        if axis == "torque":
            ends = region.torque_nm
        elif region.time_s and recording.time_s is not None and _is_monotone(recording):
            ends = region.time_s
        elif region.run:
            rows = _in_run_range(recording, region)
            ends = (float(x[rows].min()), float(x[rows].max())) if rows.any() else None
        if ends:
            yield Span(*ends, _region_label(region) if labelled else "")
            labelled = False


def located(data: ReportData) -> Mask:
    """Mark the samples of the shaded regions; all where there is none."""
    recording = data.recording
    regions = regions_of(data)[:2]
    marked = np.full(len(recording), not regions)
    for region in regions:
        rows = np.ones(len(recording), dtype=bool)
        for ends, values in (
            (region.torque_nm, recording.torque_nm),
            (region.time_s, recording.time_s),
            (region.temperature_c, recording.temperature_c),
        ):
            if ends is not None and values is not None:
                rows &= (values >= ends[0]) & (values <= ends[1])
        if region.run:
            rows &= _in_run_range(recording, region)
        if region.direction in ("loading", "unloading"):
            rows &= recording.structure.loading == (region.direction == "loading")
        marked |= rows
    return marked


def _region_label(region: Region) -> str:
    """Direction and runs of a region."""
    words = [] if region.direction in (None, "both") else [str(region.direction)]
    if region.run:
        first, last = region.run
        words.append(f"run {first}" if first == last else f"runs {first}–{last}")
    if region.readings:
        words.append(f"readings {region.readings[0]}–{region.readings[1]}")
    return ", ".join(words)
