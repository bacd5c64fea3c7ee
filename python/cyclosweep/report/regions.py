"""Where simulation and recording differ, as stretches of an axis and as samples."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording
from cyclosweep.report.charts import Span
from cyclosweep.report.data import ReportData

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


def regions_of(data: ReportData) -> list[Mapping[str, Any]]:
    """Regions of mismatch, the largest share first."""
    regions = (data.result.get("mismatch") or {}).get("regions") or []
    return sorted(regions, key=lambda r: -(r.get("share_of_excess") or 0.0))[:4]


def residual_axis(data: ReportData) -> str:
    """Quantity in which the first region is narrowest: torque, or time where it is an event."""
    regions = regions_of(data)
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


def axis_values(recording: Recording, axis: str) -> tuple[Floats, str]:
    """Values and label of the residual's axis."""
    if axis == "torque":
        return recording.torque_nm, f"torque at the {recording.side} shaft (N m)"
    if recording.time_s is not None and _is_monotone(recording):
        return recording.time_s, "time (s)"
    return np.arange(1.0, len(recording) + 1), "sample"


def _is_monotone(recording: Recording) -> bool:
    """Whether the clock runs through all runs without starting afresh."""
    return recording.time_s is not None and bool((np.diff(recording.time_s) >= 0).all())


def spans_of(data: ReportData, axis: str, *, labelled: bool) -> Iterator[Span]:
    """Shaded stretches of the regions on an axis."""
    recording = data.recording
    x, _ = axis_values(recording, axis)
    for region in regions_of(data)[:2]:
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


def located(data: ReportData) -> Mask:
    """Mark the samples of the shaded regions; all where there is none."""
    recording = data.recording
    regions = regions_of(data)[:2]
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
