"""TDMS files of LabVIEW and DIAdem, read by npTDMS."""

from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.file_table import GridTable
from cyclosweep.recording.formats.installed import needs
from cyclosweep.recording.messages import one_line
from cyclosweep.recording.metadata import TableOptions

__all__ = ["read_tdms"]


def read_tdms(path: Path, options: TableOptions) -> GridTable:
    """Read the group with most samples, or the one that the metadata name.

    Parameters
    ----------
    path : Path
        The file.
    options : TableOptions
        Group to take.

    Returns
    -------
    GridTable
        With a column ``time`` in seconds where the channels carry their time step.

    Raises
    ------
    InputError
        Not installed, damaged, or channels of unequal length.
    """
    nptdms: Any = needs("nptdms", path, "export the channels as CSV")
    try:
        with path.open("rb") as raw, nptdms.TdmsFile.open(raw) as file:
            groups = {
                group.name: [_channel(c) for c in group.channels()] for group in file.groups()
            }
    except Exception as error:  # npTDMS raises ValueError, KeyError, struct.error for damage
        raise InputError(f"{path}: not a readable TDMS file ({one_line(str(error))})") from None
    if options.sheet is not None and options.sheet not in groups:
        raise InputError(
            f"{path}, key table.sheet: found {options.sheet!r}, expected one of {', '.join(groups)}"
        )
    sizes = {name: sum(len(c[1]) for c in channels) for name, channels in groups.items()}
    group = options.sheet or max(sizes, key=lambda name: sizes[name], default=None)
    if group is None or not sizes[group]:
        raise InputError(f"{path}: no channel with samples")
    channels = groups[group]
    length = max(len(values) for _, values, _, _ in channels)
    notes = []
    others = [name for name in groups if name != group and sizes[name]]
    if others:
        notes.append(
            f"Group {group!r} read; {', '.join(map(repr, others))} have samples, too "
            "([table] sheet)."
        )
    left = [name for name, values, _, _ in channels if len(values) != length]
    if left:
        notes.append(f"Channels of another length left out: {', '.join(left)}.")
    kept = [channel for channel in channels if len(channel[1]) == length]
    columns = {name: values for name, values, _, _ in kept}
    units = {name: unit for name, _, unit, _ in kept if unit}
    steps = {step for *_, step in kept if step}
    if len(steps) == 1 and "time" not in columns:
        step = steps.pop()
        columns["time"] = np.arange(length) * step
        units["time"] = "s"
        notes.append(f"Clock made of the time step of the channels, {step:g} s.")
    return GridTable(path, columns, units, notes)


def _channel(channel: Any) -> tuple[str, Any, str, float]:
    """Name, values, unit and time step [s] of a channel; 0 where it has no time step."""
    known = channel.properties
    unit = str(known.get("unit_string", known.get("NI_UnitDescription", ""))).strip()
    return channel.name, channel[:], unit, float(known.get("wf_increment", 0.0) or 0.0)
