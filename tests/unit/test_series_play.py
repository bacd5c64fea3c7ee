"""A play below zero in the tables and sentences of a folder."""

import re
from pathlib import Path

import polars as pl
import pytest
from rich.console import Console

import cyclosweep as cs
from cyclosweep.cli.diagnose import _folder_table
from cyclosweep.diagnosis.series import trends
from cyclosweep.report.series_page import write_series_page
from cyclosweep.result.series import Level, Trend


def test_no_table_of_a_folder_shows_a_play_below_zero(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Neither a recording, nor the mean of some, nor an end of an interval."""
    plays = {1: (-0.06, -0.02), 2: (0.05, 0.11), 3: (0.2, 0.3)}
    rows = [
        {
            "recording": f"dose{dose}_{k}", "status": "ok", "verdict": "NOTHING_MISSING",
            "effects": "", "dose": float(dose), "friction_nm": 0.5 + 0.1 * dose + 0.01 * k,
            "play_deg": play, "play_deg_low": play - 0.1, "play_deg_high": play + 0.1,
        }
        for dose, pair in plays.items()
        for k, play in enumerate(pair)
    ]  # fmt: skip
    found = trends(rows, ["dose"])
    assert any(trend.measure == "play_deg" for trend in found)
    write_series_page(tmp_path / "index.html", rows, ["dose"], found)
    page = re.sub(r"<svg.*?</svg>", "", (tmp_path / "index.html").read_text(), flags=re.S)
    assert "0 (0 … " in page
    assert not re.search(r"[−-]0\.\d", page)
    series = cs.Series(table=pl.DataFrame(rows), conditions=("dose",), trends=tuple(found))
    Console(width=120).print(_folder_table(series))
    assert not re.search(r"[−-]0\.\d", capsys.readouterr().out)
    few = Trend(
        condition="dose", measure="play_deg", pairs=3, rising=3, p_value=1.0, recordings=3,
        levels=tuple(
            Level(value=float(dose), recordings=1, mean=pair[0], ci95=None)
            for dose, pair in plays.items()
        ),
    )  # fmt: skip
    assert "0 to 0.2 (chance" in few.text
