"""Settings that leave hardly a reading to be fitted: the answer names the key, not the test."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs


def loops(folder: Path, settings: str) -> Path:
    """Three loops of a drive with a play, in a file of three runs with its settings.

    Parameters
    ----------
    folder : Path
    settings : str
        What the TOML file says beside the drive.

    Returns
    -------
    Path
    """
    up = np.linspace(0.2, 6.0, 30)
    loop = np.r_[up, up[::-1], -up, -up[::-1]]
    rng = np.random.default_rng(4)
    rows = ["run,torque_nm,angle_deg"]
    for run in range(3):
        angle = 28.0 * np.sign(loop) + 2.7 * loop + 0.05 * rng.standard_normal(len(loop))
        rows += [f"{run},{t:.4f},{a:.3f}" for t, a in zip(loop, angle, strict=True)]
    path = folder / "loops.csv"
    path.write_text("\n".join(rows) + "\n")
    (folder / "loops.toml").write_text(f'drive = "reference-87"\n{settings}\n')
    return path


@pytest.mark.parametrize(
    ("settings", "said", "key"),
    [
        ("[score]\nabs_max = { torque_nm = 0.1 }", "leaves out 360", "[score] abs_max"),
        ("holdout_runs = [0, 1, 2]", "leaves out 360", "holdout_runs"),
        ("conditioning_runs = [0, 1, 2]", "leaves out 360", "conditioning_runs"),
        (
            "conditioning_runs = [0]\nholdout_runs = [1, 2]",
            "conditioning_runs leaves out 120, holdout_runs 240",
            "conditioning_runs and holdout_runs",
        ),
    ],
)
def test_the_key_that_leaves_no_reading_is_named(
    tmp_path: Path, settings: str, said: str, key: str
) -> None:
    found = cs.diagnose(cs.Recording.read(loops(tmp_path, settings)), full=False)
    assert found.verdict == "INSUFFICIENT_DATA"
    assert said in found.answer.statement
    assert found.answer.do_now.startswith(f"Correct {key} in the settings")
    assert "repeat" not in found.answer.do_now.lower()


def test_the_settings_are_looked_at_first_where_they_leave_one_size_of_torque(
    tmp_path: Path,
) -> None:
    path = loops(tmp_path, "[score]\nabs_max = { torque_nm = 0.3 }")
    found = cs.diagnose(cs.Recording.read(path), full=False)
    assert found.verdict == "INSUFFICIENT_DATA"
    assert "[score] abs_max leaves out 348" in found.answer.statement
    assert found.answer.do_now.startswith("Look first at [score] abs_max in the settings")


def test_an_array_of_what_is_not_scored_is_called_by_its_name() -> None:
    torque = np.r_[np.linspace(0.2, 6.0, 40), np.linspace(6.0, 0.2, 40)]
    angle = 28.0 + 2.7 * torque
    recording = cs.Recording.from_arrays(torque, angle, unscored=np.ones(80), drive="reference-87")
    found = cs.diagnose(recording, full=False)
    assert found.answer.do_now.startswith("Correct unscored in the settings")


def test_limits_that_no_row_is_within_are_refused(tmp_path: Path) -> None:
    path = loops(tmp_path, "[select]\nabs_max = { torque_nm = -1 }")
    with pytest.raises(cs.InputError, match=r"key select\.abs_max\.torque_nm: found -1, which no"):
        cs.Recording.read(path)
    path = loops(tmp_path, "[select]\nrun = [1]\nabs_max = { run = 0 }")
    with pytest.raises(cs.InputError, match=r"key select: no row of .* fits all"):
        cs.Recording.read(path)


def test_a_selection_of_a_few_rows_is_at_fault_and_not_the_recording(tmp_path: Path) -> None:
    path = loops(tmp_path, "[select]\nrun = [1]\nabs_max = { torque_nm = 0.3 }")
    recording = cs.Recording.read(path)
    assert [fault.kind for fault in recording.faults if fault.verdict] == ["too_few_selected"]
    found = cs.diagnose(recording, full=False)
    assert "[select] keeps 4 of 360 rows" in found.answer.statement
    assert found.answer.do_now.startswith("Correct [select] in the settings")
