"""Units and names that a file states against what the settings say of its columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import present
from tests.unit.test_inspect import run

TABLE = "Drehmoment;Winkel\nlb in;arcmin\n" + "".join(f"{t};{3 * t}\n" for t in range(1, 30))


def written(folder: Path, settings: str, table: str = TABLE) -> Path:
    """A file of readings and its settings beside it."""
    path = folder / "loop.csv"
    path.write_text(table, "utf-8")
    path.with_suffix(".toml").write_text(settings, "utf-8")
    return path


def complaint(path: Path) -> str:
    """The one line with which reading is refused."""
    with pytest.raises(cs.InputError) as caught:
        cs.Recording.read(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (
            "torque_nm = { column = 'Drehmoment', unit = 'N m' }",
            ["columns.torque_nm", "'lb in' by the file", "'N m' by this key", "instead_of"],
        ),
        (
            "torque_nm = 'Drehmoment'\nangle_deg = { column = 'Winkel', unit = 'deg' }",
            ["columns.angle_deg", "'arcmin'", "'deg'", "instead_of"],
        ),
        (
            "torque_nm = { column = 'Winkel', unit = 'lb in' }\n"
            "angle_deg = { column = 'Drehmoment', unit = 'arcmin' }",
            ["columns.torque_nm", "'Winkel'", "'arcmin'", "unit of angle"],
        ),
        ("torque_nm = 'Winkel'\nangle_deg = 'Drehmoment'", ["'Winkel'", "'arcmin'"]),
        (
            "torque_nm = { column = 'Drehmoment', unit = 'N m', instead_of = 'ft lb' }",
            ["instead_of", "'ft lb'", "'lb in'"],
        ),
        (
            "torque_nm = { column = 'Drehmoment', unit = 'N', lever_arm_m = 0.2 }",
            ["'lb in'", "'N'"],
        ),
    ],
)
def test_settings_against_the_unit_row_are_refused(
    tmp_path: Path, settings: str, words: list[str]
) -> None:
    text = complaint(written(tmp_path, "[columns]\n" + settings))
    assert "loop.toml" in text
    for word in words:
        assert word in text


def test_a_unit_in_brackets_counts_as_one_in_a_row(tmp_path: Path) -> None:
    table = TABLE.replace("lb in;arcmin\n", "").replace("Drehmoment", "Drehmoment [lb in]")
    settings = "[columns]\nangle_deg = 'Winkel'\n"
    text = complaint(
        written(tmp_path, settings + "torque_nm = {column='Drehmoment [lb in]', unit='N m'}", table)
    )
    assert "'lb in' by the file" in text


@pytest.mark.parametrize(
    ("torque", "factor"),
    [
        ("unit = 'lbf-in'", 0.1129848),
        ("unit = 'N m', instead_of = 'lb in'", 1.0),
        ("unit = 'N m', scale = 0.113", 0.113),
        ("scale = 2.0", 2.0),
    ],
)
def test_the_same_unit_or_a_way_round_is_read(tmp_path: Path, torque: str, factor: float) -> None:
    settings = f"[columns]\nangle_deg = 'Winkel'\ntorque_nm = {{column = 'Drehmoment', {torque}}}"
    recording = cs.Recording.read(written(tmp_path, settings))
    np.testing.assert_allclose(recording.torque_nm, factor * np.arange(1, 30), rtol=1e-6)
    np.testing.assert_allclose(present(recording.angle_deg), np.arange(1, 30) / 20)


def test_swapped_names_without_units_are_a_remark(tmp_path: Path) -> None:
    table = TABLE.replace("lb in;arcmin\n", "")
    swapped = "[columns]\ntorque_nm = 'Winkel'\nangle_deg = 'Drehmoment'"
    faults = cs.Recording.read(written(tmp_path, swapped, table)).faults
    assert [f.kind for f in faults if "swapped" in f.reason] == ["columns_swapped"]
    right = "[columns]\ntorque_nm = 'Drehmoment'\nangle_deg = 'Winkel'"
    assert not cs.Recording.read(written(tmp_path, right, table)).faults


def test_a_unit_that_only_ends_a_name_is_a_remark(tmp_path: Path) -> None:
    table = TABLE.replace("lb in;arcmin\n", "").replace("Winkel", "twist_mrad")
    settings = (
        "[columns]\ntorque_nm='Drehmoment'\nangle_deg = {column = 'twist_mrad', unit = 'deg'}"
    )
    recording = cs.Recording.read(written(tmp_path, settings, table))
    assert "unit_contradicted" in [fault.kind for fault in recording.faults]
    np.testing.assert_allclose(present(recording.angle_deg), 3.0 * np.arange(1, 30))


def test_texts_that_the_settings_name_are_passed_over(tmp_path: Path) -> None:
    table = TABLE.replace("12;36", "OVERLOAD;36").replace("\n20;60", "\n20;---")
    path = written(tmp_path, "[columns]\ntorque_nm = 'Drehmoment'\nangle_deg = 'Winkel'", table)
    text = complaint(path)
    for word in ("line 14", "Drehmoment", "'OVERLOAD'", "missing = ['OVERLOAD']"):
        assert word in text
    settings = path.with_suffix(".toml")
    settings.write_text(settings.read_text() + "\n[table]\nmissing = ['OVERLOAD']\n")
    recording = cs.Recording.read(path)
    assert len(recording) == 27
    assert any("2 of 29 samples without a finite value" in note for note in recording.notes)


@pytest.mark.parametrize(
    "title",
    [
        "Lever test gearbox 13:1, 23.11.2026, arm 200 mm, output bolted",
        "Lever, 23.11.2026, arm 200 mm, bolted",
    ],
)
def test_a_title_with_commas_is_not_the_names(tmp_path: Path, title: str) -> None:
    rows = "".join(f"{t},{t},{3 * t},\n" for t in range(1, 30))
    for names in ("No.,Weight (kg),Angle (deg),remark", "No.,M,Angle,remark"):
        path = tmp_path / "lever.csv"
        path.write_text(f"{title}\n{names}\n{rows}")
        columns = names.split(",")
        path.with_suffix(".toml").write_text("")
        with pytest.raises(cs.InputError, match="no column torque_nm, found No"):
            cs.Recording.read(path)
        assert columns[2].startswith("Angle")


def test_swapped_names_are_in_the_verdict_line(tmp_path: Path) -> None:
    line = cs.Drive.reference_87().nominal_line("input")
    torque = 12 * np.sin(np.linspace(0.1, 9, 200))
    angle = line.free_play_deg * np.sign(torque) + line.compliance_deg_per_nm * torque
    rows = "".join(f"{t:.6f};{a:.6f}\n" for t, a in zip(torque, angle, strict=True))
    swapped = "[columns]\ntorque_nm = 'Winkel'\nangle_deg = 'Moment'"
    path = written(tmp_path, swapped, "Winkel;Moment\n" + rows)
    found = cs.diagnose(cs.Recording.read(path), cs.Drive.reference_87())
    assert [doubt.quantity for doubt in found.answer.plausibility] == ["columns"]
    assert "by their names they are swapped" in found.answer.statement


def test_a_file_of_names_alone_is_said_once(tmp_path: Path) -> None:
    path = tmp_path / "empty.csv"
    path.write_text("torque_nm,angle_deg\n")
    shown = run("diagnose", str(path), "--drive", "reference-87", "--out", str(tmp_path / "out"))
    assert " ".join(shown.stdout.replace("│", " ").split()).count("0 samples") == 1
    looked = run("inspect", str(path), "--drive", "reference-87")
    assert looked.returncode == 2
    assert "only the names of columns" in looked.stderr
