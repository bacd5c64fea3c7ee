"""Clocks as files write them: dates in either order, minutes and seconds, counts since a date."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import present
from tests.unit.test_inspect import inspected, loop, write


def clock(tmp_path: Path, cells: list[str], name: str = "Zeit") -> tuple[cs.Recording, str]:
    """Read a recording with a clock as inspect proposes, and what it says of the clock."""
    _, torque, angle, _ = loop()
    path = tmp_path / "loop.csv"
    rows = zip(cells, torque, angle, strict=False)
    path.write_text(
        f"{name},Torque [N m],Angle [deg]\n" + "".join(f"{c},{t:g},{a:g}\n" for c, t, a in rows)
    )
    found = inspected(path, "--out", str(tmp_path / "loop.toml"), "--force")
    return cs.Recording.read(path), " ".join([*found["notes"], *found["assumed"]])


@pytest.mark.parametrize(
    ("cells", "said"),
    [
        (["07/11/2024 11:59:59.5 PM", "07/12/2024 12:00:00.0 AM", "07/12/2024 12:00:00.5 AM"],
         "the month first:"),
        (["07/11/2024 23:59:59.5", "07/12/2024 00:00:00.0", "07/12/2024 00:00:00.5"],
         "the month first, so"),
        (["11/07/2024 23:59:59.5", "12/07/2024 00:00:00.0", "12/07/2024 00:00:00.5"],
         "the day first, so"),
        (["07/31/2024 23:59:59.5", "08/01/2024 00:00:00.0", "08/01/2024 00:00:00.5"],
         "the month first:"),
        (["31/07/2024 23:59:59.5", "01/08/2024 00:00:00.0", "01/08/2024 00:00:00.5"],
         "times of day:"),
        (["59:59.5", "00:00.0", "00:00.5"], "times of day:"),
        (["23:59:59.5", "00:00:00.0", "00:00:00.5"], "times of day:"),
    ],
)  # fmt: skip
def test_seconds_since_the_first(tmp_path: Path, cells: list[str], said: str) -> None:
    last = cells[-1]
    cells = [*cells, *(last.replace("00.5", f"{1 + k / 2:04.1f}") for k in range(20))]
    recording, text = clock(tmp_path, cells)
    np.testing.assert_allclose(present(recording.time_s), np.arange(len(cells)) / 2, atol=1e-6)
    assert said in text


@pytest.mark.parametrize(
    ("start", "step", "unit"),
    [
        (45484.900005787, 0.5 / 86400, "d"),
        (1.72e12, 500.0, "ms"),
        (1.72e15, 5e5, "us"),
        (1.72e9, 0.5, None),
        (4000.0, 0.5, None),
    ],
)
def test_a_count_since_a_date_is_not_in_seconds(
    tmp_path: Path, start: float, step: float, unit: str | None
) -> None:
    recording, text = clock(tmp_path, [f"{start + k * step:.9f}" for k in range(60)])
    np.testing.assert_allclose(np.diff(present(recording.time_s)), 0.5, atol=1e-3)
    assert f"Unit of Zeit not stated: {unit or 'seconds'}" in text


def test_a_clock_that_is_not_understood_is_remarked_on(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    _, torque, angle, _ = loop()
    samples = enumerate(zip(torque, angle, strict=True))
    rows = "".join(f"at {k},{t:g},{a:g}\n" for k, (t, a) in samples)
    path.write_text("Zeit,torque_nm,angle_deg\n" + rows)
    assert [fault.kind for fault in cs.Recording.read(path).faults] == ["column_unread"]


@pytest.mark.parametrize("is_rounded", [True, False])
def test_rows_of_a_tick_are_averaged_only_where_the_torque_stands(
    tmp_path: Path, is_rounded: bool
) -> None:
    time, torque, angle, _ = loop()
    rows = np.arange(len(time)) if is_rounded else np.arange(len(time)) // 4 * 4
    path = write(tmp_path / "loop.csv", "time_s,torque_nm,angle_deg", np.floor(time), torque[rows],
                 angle[rows])  # fmt: skip
    found = inspected(path)
    assert ("merge" in found["metadata"]) is not is_rounded
    assert any("The clock is rounded" in text for text in found["assumed"]) is is_rounded


@pytest.mark.parametrize(
    ("name", "first", "clock"),
    [
        ("Date", "2024-07-11T15:47:{:02d}", True),
        ("Datum", "11.07.2024 15:47:{:02d}", True),
        ("Messdatum", "15:47:{:02d}", True),
        ("Date", "2024-07-{:02d}", False),
        ("Datum", "11.07.2024", False),
        ("Batch", "2024-07-11T15:47:{:02d}", False),
    ],
)
def test_a_date_with_times_is_the_clock(tmp_path: Path, name: str, first: str, clock: bool) -> None:
    path = tmp_path / "loop.csv"
    rows = [f"{first.format(k + 1)};{k % 7};{28 + 2.7 * (k % 7)}" for k in range(24)]
    path.write_text("\n".join([f"{name};Torque [N m];Angle [deg]", *rows]) + "\n")
    found = inspected(path)
    assert found["metadata"]["columns"].get("time_s") == (name if clock else None)
    if clock:
        assert "23 s long" in found["facts"]["clock"]


def test_a_column_called_time_is_the_clock_before_a_date(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    rows = [f"2024-07-11 15:47:{k:02d};{k};{k % 7};{28 + 2.7 * (k % 7)}" for k in range(24)]
    path.write_text("\n".join(["Date;Time [s];Torque [N m];Angle [deg]", *rows]) + "\n")
    assert inspected(path)["metadata"]["columns"]["time_s"]["column"] == "Time [s]"
