"""Files of laboratory programs, each written by another library, read as the same loop."""

import json
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import openpyxl
import pandas
import pytest
import scipy.io
import xlwt
from nptdms import ChannelObject, RootObject, TdmsWriter

import cyclosweep as cs
from cyclosweep.recording.units import find_unit, split_name
from tests.support.arrays import present
from tests.support.binary_workbook import write_binary_workbook

TIME = np.arange(40) * 0.5
TORQUE = 12.0 * np.sin(np.arange(40) / 6.0)
ANGLE = 3.0 * TORQUE + 28.0 * np.sign(TORQUE)
META = """
side = "output"
[columns]
time_s = "Time"
torque_nm = { column = "Torque", unit = "lbf in" }
angle_deg = { column = "Angle", unit = "mrad" }
"""
LBF_IN = 0.112984829
MRAD = 0.0572957795


def assert_is_the_loop(recording: cs.Recording) -> None:
    np.testing.assert_allclose(recording.torque_nm, TORQUE, rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(present(recording.angle_deg), ANGLE, rtol=1e-5, atol=1e-4)
    np.testing.assert_allclose(present(recording.time_s), TIME, atol=1e-6)


def signals() -> dict[str, Any]:
    return {"Time": TIME, "Torque": TORQUE / LBF_IN, "Angle": ANGLE / MRAD}


def read(path: Path, meta: str = META) -> cs.Recording:
    path.with_name("loop.toml").write_text(meta)
    return cs.Recording.read(path)


def write_excel(path: Path) -> None:
    book = openpyxl.Workbook()
    cover = book.active
    assert cover is not None
    cover.title = "Info"
    cover.append(["Operator", "Meyer"])
    sheet = book.create_sheet("Data")
    sheet.append(["Rig 3", None, None])
    sheet.append(["Rate", 2.0, "Hz"])
    sheet.append([])
    sheet.append(["Time", "Torque", "Angle", "Comment"])
    sheet.append(["s", "lbf in", "mrad", None])
    for row in zip(*signals().values(), strict=True):
        sheet.append([*map(float, row), "ok"])
    book.save(path)


def write_excel_with_dates(path: Path) -> None:
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    sheet.append(["Time", "Torque", "Angle"])
    start = datetime(2024, 7, 11, 15, 47, 12)
    for t, *row in zip(*signals().values(), strict=True):
        sheet.append([start + timedelta(seconds=float(t)), *map(float, row)])
    book.save(path)


def write_excel_97(path: Path) -> None:
    book = xlwt.Workbook()
    sheet = book.add_sheet("Data")
    for place, (name, values) in enumerate(signals().items()):
        sheet.write(0, place, name)
        for row, value in enumerate(values.tolist(), start=1):
            sheet.write(row, place, value)
    book.save(path)


def write_excel_binary(path: Path) -> None:
    rows = np.column_stack(list(signals().values())).tolist()
    write_binary_workbook(path, list(signals()), rows)


def write_open_document(path: Path) -> None:
    pandas.DataFrame(signals()).to_excel(path, engine="odf", index=False)


def write_mat5(path: Path) -> None:
    scipy.io.savemat(path, signals())


def write_mat5_struct(path: Path) -> None:
    units = {"Torque": "lbf in", "Angle": "mrad"}
    scipy.io.savemat(path, {"rig": "bench 3", "data": {**signals(), "units": units}, "gain": 2.0})


def write_mat5_matrix(path: Path) -> None:
    names = np.array(["Time", "Torque", "Angle"], dtype=object)
    matrix = np.column_stack(list(signals().values()))
    scipy.io.savemat(path, {"data": matrix, "colheaders": names})


def write_mat73(path: Path) -> None:
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("data")
        group.attrs["MATLAB_class"] = np.bytes_("struct")
        for name, values in signals().items():
            item = group.create_dataset(name, data=values[np.newaxis, :])
            item.attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(128))


def write_hdf5(path: Path) -> None:
    with h5py.File(path, "w") as file:
        for name, values in signals().items():
            file[name] = values
        file["Torque"].attrs["unit"] = "lbf in"
        file["Angle"].attrs["unit"] = "mrad"


def write_tdms(path: Path) -> None:
    given = signals()
    units = {"Time": "s", "Torque": "lbf in", "Angle": "mrad"}
    channels = [
        ChannelObject("Data", name, values, properties={"unit_string": units[name]})
        for name, values in given.items()
    ]
    notes = ChannelObject("Events", "mark", np.array([1.0, 2.0]))
    with TdmsWriter(path) as writer:
        writer.write_segment([RootObject(), *channels, notes])


def write_json(path: Path) -> None:
    plain = {name: list(values) for name, values in signals().items()}
    units = {"Torque": "lbf in", "Angle": "mrad"}
    path.write_text(json.dumps({"rig": "bench 3", "data": plain, "units": units}))


def write_json_records(path: Path) -> None:
    names = list(signals())
    rows = [
        dict(zip(names, map(float, row), strict=True))
        for row in zip(*signals().values(), strict=True)
    ]
    path.write_text(json.dumps(rows))


def write_json_split(path: Path) -> None:
    rows = [list(map(float, row)) for row in zip(*signals().values(), strict=True)]
    path.write_text(json.dumps({"columns": list(signals()), "data": rows}))


def write_json_lines(path: Path) -> None:
    names = list(signals())
    path.write_text(
        "\n".join(json.dumps(dict(zip(names, map(float, r), strict=True)))
                  for r in zip(*signals().values(), strict=True))
    )  # fmt: skip


LVM = """LabVIEW Measurement
Writer_Version\t2
Reader_Version\t2
Separator\tTab
Decimal_Separator\t,
Multi_Headings\tNo
X_Columns\t{columns}
Time_Pref\tRelative
Operator\tMeyer
Date\t2024/07/11
Time\t15:47:12,0155
***End_of_Header***
\t
Channels\t2\t\t
Samples\t40\t40\t
Date\t2024/07/11\t2024/07/11\t
Y_Unit_Label\tlbf in\tmrad\t
X_Dimension\tTime\tTime\t
X0\t0,0000000000000000E+0\t0,0000000000000000E+0\t
Delta_X\t0,500000\t0,500000\t
***End_of_Header***\t\t\t
X_Value\tTorque\tAngle\tComment
"""


def write_lvm(path: Path, columns: str = "One") -> None:
    lines = []
    for t, torque, angle in zip(*signals().values(), strict=True):
        clock = f"{t:.6f}" if columns == "One" else ""
        lines.append(f"{clock}\t{torque:.6f}\t{angle:.6f}\t".replace(".", ","))
    path.write_text(LVM.format(columns=columns) + "\n".join(lines) + "\n", newline="\r\n")


def write_lvm_without_x(path: Path) -> None:
    write_lvm(path, "No")


def write_savetxt(path: Path) -> None:
    np.savetxt(path, np.column_stack(list(signals().values())), header="Time Torque Angle")


def write_blanks(path: Path) -> None:
    lines = "".join(
        f"  {t:9.4f}   {m:12.6f}  {a:12.6f}\n" for t, m, a in zip(*signals().values(), strict=True)
    )
    path.write_text("Rig 3, run of 11 July\n\n   Time    Torque     Angle\n" + lines)


def text(separator: str, decimal: str, thousands: str, units: bool = True) -> str:
    def spelt(x: float) -> str:
        digits = f"{x:,.6f}"
        return digits.translate({ord(","): thousands, ord("."): decimal})

    head = separator.join(signals()) + "\n"
    if units:
        head += separator.join(["[s]", "[lbf in]", "[mrad]"]) + "\n"
    rows = zip(*signals().values(), strict=True)
    return head + "".join(separator.join(map(spelt, map(float, row))) + "\n" for row in rows)


def write_german(path: Path) -> None:
    path.write_text(text(";", ",", "."))


def write_german_late(path: Path) -> None:
    """Divide thousands first far below the rows that are looked at to find the table."""
    lines = text(";", ",", "", units=False).splitlines()
    angles = [line.split(";")[2] for line in lines[1:]]
    near = [f"{100 + k},500000;0,000000;{angles[-1]}" for k in range(700)]
    far = [f"1.{k:03d},500000;0,000000;{angles[-1]}" for k in range(600)]
    path.write_text("\n".join(lines + near + far) + "\n")


def write_swiss(path: Path) -> None:
    path.write_text("Datum;11.07.2024\nPruefer;Meyer\n\n" + text(";", ".", "'"))


def write_english(path: Path) -> None:
    path.write_text(text("\t", ".", ","))


def write_quoted(path: Path) -> None:
    lines = text(";", ".", ",").splitlines()
    path.write_text("".join('"' + line.replace(";", '","') + '"\n' for line in lines))


def write_iso(path: Path) -> None:
    start = datetime(2024, 7, 11, 23, 59, 55)
    lines = "".join(
        f"{(start + timedelta(seconds=float(t))).isoformat()},{m:.6f},{a:.6f}\n"
        for t, m, a in zip(*signals().values(), strict=True)
    )
    path.write_text("Time,Torque,Angle\n" + lines)


def write_time_of_day(path: Path) -> None:
    start = datetime(2024, 7, 11, 23, 59, 55)
    lines = "".join(
        f"{start + timedelta(seconds=float(t)):%H:%M:%S.%f};{m:.6f};{a:.6f}\n".replace(".", ",")
        for t, m, a in zip(*signals().values(), strict=True)
    )
    path.write_text("Time;Torque;Angle\n" + lines)


WRITERS: dict[str, tuple[str, Callable[[Path], None]]] = {
    "excel": ("loop.xlsx", write_excel),
    "excel-dates": ("loop.xlsx", write_excel_with_dates),
    "excel-97": ("loop.xls", write_excel_97),
    "excel-binary": ("loop.xlsb", write_excel_binary),
    "open-document": ("loop.ods", write_open_document),
    "mat5": ("loop.mat", write_mat5),
    "mat5-struct": ("loop.mat", write_mat5_struct),
    "mat5-matrix": ("loop.mat", write_mat5_matrix),
    "mat7.3": ("loop.mat", write_mat73),
    "hdf5": ("loop.h5", write_hdf5),
    "tdms": ("loop.tdms", write_tdms),
    "json": ("loop.json", write_json),
    "json-records": ("loop.json", write_json_records),
    "json-split": ("loop.json", write_json_split),
    "json-lines": ("loop.jsonl", write_json_lines),
    "labview": ("loop.lvm", write_lvm),
    "labview-no-x": ("loop.lvm", write_lvm_without_x),
    "savetxt": ("loop.txt", write_savetxt),
    "blanks": ("loop.dat", write_blanks),
    "german": ("loop.csv", write_german),
    "swiss": ("loop.csv", write_swiss),
    "english": ("loop.tsv", write_english),
    "quoted": ("loop.csv", write_quoted),
    "iso": ("loop.csv", write_iso),
    "time-of-day": ("loop.csv", write_time_of_day),
}


@pytest.mark.parametrize("kind", WRITERS)
def test_files_of_laboratory_programs(tmp_path: Path, kind: str) -> None:
    name, write = WRITERS[kind]
    write(tmp_path / name)
    meta = META.replace('"Time"', '"X_Value"') if name.endswith("lvm") else META
    recording = read(tmp_path / name, meta)
    assert_is_the_loop(recording)
    assert recording.name == "loop"


@pytest.mark.parametrize(
    "kind", ["excel", "mat5-struct", "hdf5", "tdms", "json", "labview", "german"]
)
def test_a_unit_that_the_file_states_is_converted_and_said(tmp_path: Path, kind: str) -> None:
    name, write = WRITERS[kind]
    write(tmp_path / name)
    meta = '[columns]\ntime_s = "Time"\ntorque_nm = "Torque"\nangle_deg = "Angle"\n'
    if kind == "labview":
        meta = meta.replace("Time", "X_Value")
    recording = read(tmp_path / name, meta)
    assert_is_the_loop(recording)
    assert any("lbf in" in note and "0.112985" in note for note in recording.notes)
    scaled = meta.replace('"Torque"', '{ column = "Torque", scale = 2.0 }')
    np.testing.assert_allclose(
        read(tmp_path / name, scaled).torque_nm, 2.0 * TORQUE / LBF_IN, rtol=1e-5, atol=1e-4
    )


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("loop.xlsx", b"PK\x03\x04 no workbook", ["not a readable workbook", "CSV"]),
        ("loop.xls", b"\xd0\xcf\x11\xe0" + bytes(600), ["not a readable workbook", "CSV"]),
        ("loop.xlsb", b"Time,Torque\n0,1\n", ["not a readable workbook", "CSV"]),
        ("loop.ods", b"Time;Torque\n0;1\n", ["not a readable workbook", "CSV"]),
        ("loop.mat", b"MATLAB 5.0 MAT-file" + bytes(200), ["MATLAB"]),
        ("loop.mat", b"\x89HDF\r\n\x1a\n" + bytes(99), ["not a readable HDF5"]),
        ("loop.tdms", b"TDSm" + bytes(60), ["TDMS"]),
        ("loop.json", b'{"torque": [1, 2', ["not valid JSON"]),
        ("loop.json", b"[[1, 2], [3, 4]]", ["without names"]),
        ("loop.json", b'{"torque": 3}', ["no array"]),
        ("loop.lvm", b"LabVIEW Measurement\nSeparator\tTab\n", ["no segment"]),
        ("loop.csv", b"Time,Torque [%],x\n1,2,3\n", ["torque_nm", "inspect"]),
    ],
)
def test_a_damaged_file_is_one_line(
    tmp_path: Path, name: str, content: bytes, words: list[str]
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(cs.InputError) as caught:
        cs.Recording.read(tmp_path / name)
    line = str(caught.value)
    assert "\n" not in line
    assert name in line
    for word in words:
        assert word in line


@pytest.mark.parametrize(
    ("module", "kind"), [("python_calamine", "excel"), ("h5py", "mat7.3"), ("nptdms", "tdms")]
)
def test_an_absent_library_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, kind: str
) -> None:
    name, write = WRITERS[kind]
    write(tmp_path / name)
    monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(cs.InputError, match=r"pip install 'cyclosweep\[formats\]'"):
        read(tmp_path / name)


@pytest.mark.parametrize(
    ("column", "values", "expected"),
    [
        ('{ column = "x", unit = "kN", lever_arm_m = 0.5 }', [0.01, 0.02], [5.0, 10.0]),
        ('{ column = "x", unit = "A", nm_per_a = 0.4 }', [1.0, -2.0], [0.4, -0.8]),
        ('{ column = "x", nm_per_a = 0.4 }', [1.0, -2.0], [0.4, -0.8]),
        ('{ column = "x", unit = "ft lbf" }', [1.0, 2.0], [1.3558179, 2.7116359]),
        ('{ column = "x", unit = "kN m", scale = -1.0 }', [1.0, 2.0], [-1000.0, -2000.0]),
        ('{ column = "x", unit = "N·mm" }', [1000.0, 2000.0], [1.0, 2.0]),
        ('{ column = "x", unit = "oz-in" }', [16.0, 32.0], [LBF_IN, 2 * LBF_IN]),
    ],
)
def test_units_of_torque(
    tmp_path: Path, column: str, values: list[float], expected: list[float]
) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("x,y\n" + "".join(f"{v},0\n" for v in values))
    recording = read(path, f"[columns]\ntorque_nm = {column}\n")
    np.testing.assert_allclose(recording.torque_nm, expected, rtol=1e-6)


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ('unit = "arcmin"', 1 / 60),
        ('unit = "arcsec"', 1 / 3600),
        ('unit = "rad"', 57.29577951),
        ('unit = "turns"', 360.0),
        ('unit = "counts", counts_per_turn = 4096', 360 / 4096),
    ],
)
def test_units_of_angle(tmp_path: Path, unit: str, factor: float) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,x\n1,10\n2,20\n3,31\n")
    recording = read(path, f'[columns]\nangle_deg = {{ column = "x", {unit} }}\n')
    np.testing.assert_allclose(present(recording.angle_deg), factor * np.array([10, 20, 31.0]))


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ('torque_nm = { column = "x", unit = "furlong" }', ["furlong", "'N m'"]),
        ('torque_nm = { column = "x", unit = "deg" }', ["deg"]),
        ('torque_nm = { column = "x", unit = "kN" }', ["lever_arm_m"]),
        ('torque_nm = { column = "x", unit = "A" }', ["nm_per_a"]),
        ('torque_nm = "x"\nangle_deg = { column = "y", unit = "counts" }', ["counts_per_turn"]),
        ('torque_nm = "x"\ntime_s = { column = "y", nm_per_a = 2 }', ["nm_per_a", "current"]),
    ],
)
def test_a_wrong_unit_is_one_line(tmp_path: Path, column: str, words: list[str]) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("x,y\n1,2\n3,4\n")
    with pytest.raises(cs.InputError) as caught:
        read(path, f"[columns]\n{column}\n")
    line = str(caught.value)
    assert "loop.toml" in line
    assert "\n" not in line
    for word in words:
        assert word in line


def test_temperature_in_fahrenheit_and_kelvin(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,T [°F],K\n1,32,273.15\n2,212,373.15\n")
    for column in ('"T [°F]"', '{ column = "K", unit = "K" }'):
        recording = read(path, f"[columns]\ntemperature_c = {column}\n")
        np.testing.assert_allclose(present(recording.temperature_c), [0, 100], atol=1e-9)


def test_thousands_divided_only_far_below(tmp_path: Path) -> None:
    write_german_late(tmp_path / "loop.csv")
    recording = read(tmp_path / "loop.csv")
    time = present(recording.time_s)
    np.testing.assert_allclose(time[:40], TIME)
    np.testing.assert_allclose(time[40:740], np.arange(700) + 100.5)
    np.testing.assert_allclose(time[740:], np.arange(600) + 1000.5)


def test_a_bad_row_below_names_is_not_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,angle_deg,note\n0,abc,def\n1,2,x\n3,4,x\n5,6,x\n")
    with pytest.raises(cs.InputError, match="line 2, column angle_deg"):
        cs.Recording.read(path)


@pytest.mark.parametrize(
    ("header", "name", "unit"),
    [
        ("Torque [lb in]", "Torque", "lb in"),
        ("Drehmoment / Nm", "Drehmoment", "Nm"),
        ("angle (arcmin)", "angle", "arcmin"),
        ("Torque, N-m", "Torque", "N-m"),
        ("torque_ft_lbf", "torque", "ft lbf"),
        ("Q_CURRENT", "Q_CURRENT", None),
        ("test_nr", "test_nr", None),
        ("phase A", "phase A", None),
    ],
)
def test_names_are_divided_from_units(header: str, name: str, unit: str | None) -> None:
    assert split_name(header)[:2] == (name, unit)


def test_units_are_known_however_written() -> None:
    for spelling in ("lb-in", "lb.in", "in·lbf", "LBF IN", "[in lb]", "lbf*in"):
        unit = find_unit(spelling, "torque_nm")
        assert unit is not None
        assert unit.factor == pytest.approx(LBF_IN)


@pytest.mark.parametrize(("unit", "newton"), [("kg", 9.80665), ("g", 9.80665e-3)])
def test_weights_on_a_lever_are_read_as_their_mass(
    tmp_path: Path, unit: str, newton: float
) -> None:
    lines = [
        f"{torque / 0.2 / newton:.9g};{angle:.9g}"
        for torque, angle in zip(TORQUE, ANGLE, strict=True)
    ]
    path = tmp_path / "loop.csv"
    path.write_text("\n".join([f"Weight [{unit}];Angle [deg]", *lines]))
    path.with_name("loop.toml").write_text(
        'side = "output"\n[columns]\n'
        f'torque_nm = {{ column = "Weight [{unit}]", unit = "{unit}", lever_arm_m = 0.2 }}\n'
        'angle_deg = "Angle [deg]"\n'
    )
    found = cs.Recording.read(path)
    np.testing.assert_allclose(found.torque_nm, TORQUE, rtol=1e-6, atol=1e-7)
    assert find_unit(unit, "torque_nm") is not None
