"""Points and commas that divide thousands or are decimal signs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import present
from tests.unit.test_inspect import inspected

TORQUE = np.array([0, 3333, 6667, 10000, 150000, 200000])


def rows(decimal: str, group: str, separator: str = ";") -> str:
    """Table with whole torques in groups of three digits and other numbers with a fraction."""
    quote = '"' if separator == "," else ""
    return f"Zeit [s]{separator}Drehmoment [mNm]{separator}Winkel [deg]\n" + "".join(
        separator.join(
            f"{quote}{cell}{quote}"
            for cell in (
                f"{k / 2:.1f}".replace(".", decimal),
                f"{torque:,}".replace(",", group),
                f"{torque * 1e-6:.5f}".replace(".", decimal),
            )
        )
        + "\n"
        for k, torque in enumerate(TORQUE.tolist())
    )


@pytest.mark.parametrize(
    ("decimal", "group", "separator"), [(",", ".", ";"), (".", ",", ";"), (".", ",", ",")]
)
def test_whole_thousands_beside_fractions(
    tmp_path: Path, decimal: str, group: str, separator: str
) -> None:
    path, out = tmp_path / "loop.csv", tmp_path / "loop.toml"
    path.write_text(rows(decimal, group, separator))
    found = inspected(path, "--out", str(out))
    assert any(f"Thousands divided by {group!r}" in note for note in found["notes"])
    recording = cs.Recording.read(path)
    np.testing.assert_allclose(recording.torque_nm, TORQUE * 1e-3)
    np.testing.assert_allclose(present(recording.time_s), np.arange(6) / 2)


def test_fractions_with_either_sign_stay_fractions(tmp_path: Path) -> None:
    path, out = tmp_path / "loop.csv", tmp_path / "loop.toml"
    names = "Zeit [s];Drehmoment [Nm];Winkel [deg]\n"
    path.write_text(names + "".join(f"{k},5;{k}.125;0.{k}72\n" for k in range(1, 9)))
    inspected(path, "--out", str(out))
    np.testing.assert_allclose(cs.Recording.read(path).torque_nm, np.arange(1, 9) + 0.125)


def test_millions_beside_them(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm;angle_deg\n0.5;1\n3,333;2\n1,234,567;3\n")
    np.testing.assert_allclose(cs.Recording.read(path).torque_nm, [0.5, 3333, 1234567])
