"""The table of noise and model error in docs/diagnosis.md is what the diagnosis counts against."""

from pathlib import Path

import pytest

from cyclosweep.diagnosis.identify.stages.stage import error_factor

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis.md"


def test_table_of_noise_and_model_error() -> None:
    rows = [line.strip("| \n").split(" | ") for line in PAGE.read_text("utf-8").splitlines()]
    (left,) = (row[1:] for row in rows if row[0] == "what is left to explain, d")
    (over,) = (row[1:] for row in rows if row[0].startswith("noise and model error together"))
    assert len(left) == len(over) == 5
    for d, factor in zip(left, over, strict=True):
        assert error_factor(float(d)) == pytest.approx(float(factor), abs=0.05)
