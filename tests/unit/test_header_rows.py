"""Row of the names and sheet, where the user says: in force, or refused."""

from __future__ import annotations

from pathlib import Path

import pytest

import cyclosweep as cs
from tests.unit.test_inspect import inspected, loop, run, write

NAMES = "time_s,torque_nm,angle_deg"


@pytest.mark.parametrize(
    ("options", "key", "found"),
    [
        (("--header-row", "5"), "table.header_row", "in line 5"),
        (("--header-row", "2"), "table.header_row", "found '' in line 2"),
        (("--header-row", "9999"), "table.header_row", "9999 in a text of 483 lines"),
        (("--sheet", "Messung"), "table.sheet", "'Messung'"),
    ],
)
def test_what_is_not_there_is_refused(
    tmp_path: Path, options: tuple[str, ...], key: str, found: str
) -> None:
    path = write(tmp_path / "loop.csv", NAMES, *loop()[:3], lines="Rig 3\n\n")
    out = tmp_path / "loop.toml"
    result = run("inspect", str(path), *options, "--out", str(out))
    assert result.returncode == 2
    [line] = result.stderr.splitlines()
    assert f"{path}, key {key}" in line
    assert found in line
    assert not out.exists()


def test_a_row_far_below_is_in_force(tmp_path: Path) -> None:
    time, torque, angle, _ = loop()
    preamble = "".join(f"{k},{k},{k}\n" for k in range(600))
    path = write(tmp_path / "loop.csv", NAMES, time, torque, angle, lines=preamble)
    inspected(path, "--header-row", "601", "--out", str(tmp_path / "loop.toml"))
    assert len(cs.Recording.read(path)) == len(torque)


def test_a_parquet_file_has_neither(tmp_path: Path) -> None:
    pl = pytest.importorskip("polars")
    path = tmp_path / "loop.parquet"
    pl.DataFrame(dict(zip(NAMES.split(","), loop()[:3], strict=True))).write_parquet(path)
    (tmp_path / "loop.toml").write_text("[table]\nheader_row = 1\n")
    with pytest.raises(cs.InputError, match=r"key table\.header_row: found 1"):
        cs.Recording.read(path)


@pytest.mark.parametrize(
    ("head", "separator"),
    [
        ("time_s,torque_nm,angle_deg\n", ","),
        ('"time_s";"torque_nm";"angle_deg"\r\n', ";"),
        ("Rig 3\n\ntime_s;torque_nm;angle_deg\ns;Nm;deg\n", ";"),
        ("time_s   torque_nm angle_deg\n", "  "),
        ("time_s\ttorque_nm\tangle_deg\n", "\t"),
    ],
)
def test_names_that_stand_again_in_appended_files_are_passed_over(
    tmp_path: Path, head: str, separator: str
) -> None:
    end = "\r\n" if "\r" in head else "\n"
    rows = [f"{k}.5{separator}{k % 7}.25{separator}{0.3 * k:.2f}{end}" for k in range(40)]
    again = head.rpartition("\n\n")[2]  # without what stands above the names
    path = tmp_path / "loop.csv"
    path.write_bytes("".join([head, *rows[:20], again, *rows[20:], again]).encode())
    recording = cs.Recording.read(path)
    assert len(recording) == 40
    assert recording.torque_nm[20] == 6.25
    (note,) = [note for note in recording.notes if "stand again" in note]
    first = head.count("\n") + 21
    assert f"lines {first}, " in note


def test_a_bad_cell_below_repeated_names_is_named_by_its_line_in_the_file(tmp_path: Path) -> None:
    lines = [NAMES, *["1.0,2.0,3.0"] * 3, NAMES, "4.0,bad,3.0"]
    path = tmp_path / "loop.csv"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(cs.InputError, match="line 6, column torque_nm: found 'bad'"):
        cs.Recording.read(path)
