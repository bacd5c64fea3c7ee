"""Recordings rewritten as laboratory programs write them: other names, units, separators, formats.

Each style takes the columns of a recording's file by their canonical role and writes the same
readings, to twelve digits, under names and in units that nothing but the file itself states.
"""

from collections.abc import Callable, Mapping
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import openpyxl
import scipy.io
from nptdms import ChannelObject, RootObject, TdmsWriter
from numpy.typing import NDArray

__all__ = ["STYLES", "rewrite"]

Table = Mapping[str, NDArray[np.float64]]

LBF_IN = 4.4482216152605 * 0.0254
FT_LBF = 12 * LBF_IN


def _german_text(path: Path, table: Table) -> None:
    """Semicolons, decimal commas, divided thousands, a preamble and a row of units."""
    names = {
        "time_s": ("Zeit", "ms", 1e-3),
        "torque_nm": ("Drehmoment", "lbf in", LBF_IN),
        "angle_deg": ("Verdrehwinkel", "arcmin", 1 / 60),
        "run": ("Versuch", "-", 1.0),
        "crank_deg": ("Kurbel Position", "mrad", np.degrees(1e-3)),
        "temperature_c": ("Temperatur", "K", 1.0),
        "command": ("Sollmoment", "lbf in", LBF_IN),
        "current": ("Strom Iq", "mA", 1e-3),
    }
    lines = ["Pruefstand 3", "Datum;11.07.2024;15:47:12", "Pruefer;Meyer", "Rate;1.000,00;Hz", ""]
    lines.append(";".join(names[role][0] for role in table))
    lines.append(";".join(f"[{names[role][1]}]" for role in table))
    cells = []
    for role, values in table.items():
        shifted = values + 273.15 if role == "temperature_c" else values / names[role][2]
        cells.append([f"{x:,.10f}" if role != "run" else f"{x:.0f}" for x in shifted])
    swap = str.maketrans(",.", ".,")
    lines += [";".join(row).translate(swap) for row in zip(*cells, strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="latin-1")


def _american_text(path: Path, table: Table) -> None:
    """Tabulators, units in the names, times as ISO dates."""
    names = {
        "time_s": ("Timestamp", 1.0),
        "torque_nm": ("Torque (ft-lbf)", FT_LBF),
        "angle_deg": ("Position [mrad]", np.degrees(1e-3)),
        "run": ("Test", 1.0),
        "crank_deg": ("Mesh lock (deg)", 1.0),
        "temperature_c": ("Oil temp (°F)", 1.0),
        "command": ("Torque command (ft-lbf)", FT_LBF),
        "current": ("Current (A)", 1.0),
    }
    start = datetime(2024, 7, 11, 15, 47, 12)
    cells = []
    for role, values in table.items():
        if role == "time_s":
            cells.append([(start + timedelta(seconds=float(t))).isoformat() for t in values])
        else:
            warm = values * 9 / 5 + 32 if role == "temperature_c" else values / names[role][1]
            cells.append([f"{x:.12g}" for x in warm])
    head = "Acme Test Stand v4.2\nOperator: J. Doe\n\n" + "\t".join(names[r][0] for r in table)
    rows = "\n".join("\t".join(row) for row in zip(*cells, strict=True))
    path.write_text(f"{head}\n{rows}\n", encoding="utf-8")


_PLAIN = {
    "time_s": ("Time", "min", 60.0),
    "torque_nm": ("Moment", "N mm", 1e-3),
    "angle_deg": ("Angle", "rad", np.degrees(1.0)),
    "run": ("Trial", "", 1.0),
    "crank_deg": ("Crank", "turns", 360.0),
    "temperature_c": ("Temperature", "degC", 1.0),
    "command": ("Moment setpoint", "N mm", 1e-3),
    "current": ("Motor current", "A", 1.0),
}


def _workbook(path: Path, table: Table) -> None:
    """Excel with a cover sheet, a title and a row of units."""
    book = openpyxl.Workbook(write_only=True)
    cover = book.create_sheet("Cover")
    cover.append(["Report", 4711])
    sheet = book.create_sheet("Measurement")
    sheet.append(["Torsion test"])
    sheet.append([])
    sheet.append([_PLAIN[role][0] for role in table])
    sheet.append([_PLAIN[role][1] or None for role in table])
    columns = [(values / _PLAIN[role][2]).tolist() for role, values in table.items()]
    for row in zip(*columns, strict=True):
        sheet.append(row)
    book.save(path)


def _matlab(path: Path, table: Table) -> None:
    """A structure of vectors beside one of their units."""
    names = {role: _PLAIN[role][0].replace(" ", "_") for role in table}
    data = {names[role]: values / _PLAIN[role][2] for role, values in table.items()}
    units = {names[role]: _PLAIN[role][1] for role in table if _PLAIN[role][1]}
    scipy.io.savemat(path, {"rig": "bench 3", "data": data, "units": units})


def _tdms(path: Path, table: Table) -> None:
    """A group of channels with their units as properties."""
    channels = [
        ChannelObject(
            "Data", _PLAIN[role][0], values / _PLAIN[role][2],
            properties={"unit_string": _PLAIN[role][1]},
        )
        for role, values in table.items()
    ]  # fmt: skip
    with TdmsWriter(path) as writer:
        writer.write_segment([RootObject(), *channels])


STYLES: dict[str, tuple[str, Callable[[Path, Table], None]]] = {
    "german text": (".csv", _german_text),
    "american text": (".txt", _american_text),
    "workbook": (".xlsx", _workbook),
    "matlab": (".mat", _matlab),
    "tdms": (".tdms", _tdms),
}
"""How laboratories write: ending of the file's name, and what writes it."""


def rewrite(table: Table, style: str, folder: Path, name: str) -> Path:
    """Write readings in a style.

    Parameters
    ----------
    table : mapping of str to ndarray, shape (rows,)
        Readings in canonical units by role; also ``command`` [N m] and ``current`` [A].
    style : str
        One of `STYLES`.
    folder : Path
        Where the file goes.
    name : str
        Its stem.

    Returns
    -------
    Path
    """
    ending, write = STYLES[style]
    path = folder / f"{name}{ending}"
    write(path, table)
    return path
