"""Columns whose names say what a diagnosis looks for are not passed over in silence."""

from pathlib import Path

import pytest

import cyclosweep as cs

ROWS = "\n".join(f"{k % 7},{2 * (k % 7)},{k},{30 * (k % 5)},x{k}" for k in range(40))


def read(folder: Path, third: str, fourth: str, settings: str = "") -> cs.Recording:
    """Read a file of torque, angle and three other columns, the last of them text."""
    path = folder / "loop.csv"
    path.write_text(f"torque_nm,angle_deg,{third},{fourth},oil temperature\n{ROWS}\n")
    if settings:
        path.with_suffix(".toml").write_text(settings)
    return cs.Recording.read(path)


def unread(recording: cs.Recording) -> list[str]:
    """Sentences on columns that could be read."""
    return [fault.reason for fault in recording.faults if fault.kind == "column_unread"]


def test_a_mesh_position_of_another_name_is_remarked_on(tmp_path: Path) -> None:
    recording = read(tmp_path, "time_s", "crank_angle_deg", 'drive = "reference-87"\n')
    assert recording.crank_deg is None
    (reason,) = unread(recording)
    assert "'crank_angle_deg' is not read, and could be crank_deg" in reason
    found = cs.diagnose(recording, full=False)
    assert found.statement.startswith("Check first: column 'crank_angle_deg' is not read")


@pytest.mark.parametrize(
    ("third", "fourth", "count"),
    [
        ("time_s", "crank_deg", 0),
        ("time_s", "humidity", 0),
        ("Time [s]", "oil_temp_c", 2),
        ("time_s", "Trial", 1),
        ("time_s", "temperature setpoint", 0),
    ],
)
def test_what_is_read_or_means_something_else_is_not(
    tmp_path: Path, third: str, fourth: str, count: int
) -> None:
    # The last column reads as a temperature, too, but holds no numbers.
    assert len(unread(read(tmp_path, third, fourth))) == count


def test_settings_that_name_columns_leave_the_others_out_on_purpose(tmp_path: Path) -> None:
    named = '[columns]\ntime_s = "Time [s]"\n'
    assert unread(read(tmp_path, "Time [s]", "crank_angle_deg", named)) == []
