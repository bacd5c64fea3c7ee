"""Rows of the real scoreboard that stand beside a campaign."""

from __future__ import annotations

import json
import math
from pathlib import Path
from statistics import median
from typing import Any

from cyclosweep_challenge.scoreboard.lines import all_lines, all_summaries, shared_recordings
from cyclosweep_challenge.scoreboard.page import HEADS, marks, rows, summary_rows
from cyclosweep_challenge.scoreboard.run import Board
from cyclosweep_challenge.scoring.criterion import Criterion, criterion
from cyclosweep_challenge.scoring.intervals import Estimate

FLOOR = "over_floor"
"""Forecast of the other ramp over the replicate floor, among the figures of a measured loop."""
MEDIAN, LARGEST = 1.1, 1.6
"""Targets of that ratio: its median, and its largest value [-]."""


def real_board(file: Path) -> dict[str, Any]:
    """Read a scoreboard as tables; nothing where it was not made.

    Parameters
    ----------
    file : pathlib.Path
        ``scoreboard.json`` or ``quick.json`` of a scoreboard's folder.
    """
    if not file.is_file():
        return {}
    content = json.loads(file.read_text())
    board = Board.open(file, content["code"])
    lines = all_lines(shared_recordings())
    groups = dict.fromkeys(line.group for line in lines)
    right, judged = marks(lines, board)
    return {
        "code": content["code"],
        "date": content.get("date", ""),
        "right": right,
        "judged": judged,
        "heads": list(HEADS),
        "groups": {
            group: [list(row) for row in rows([m for m in lines if m.group == group], board)]
            for group in groups
        },
        "over_several": [list(row) for row in summary_rows(all_summaries(), board)],
        FLOOR: [
            float(outcome.figures[FLOOR])
            for outcome in board.outcomes.values()
            if FLOOR in outcome.figures
        ],
    }


def real_figures(board: dict[str, Any]) -> list[Criterion]:
    """Figures of the measured loops that have a target.

    Parameters
    ----------
    board : dict
        What `real_board` gives.
    """
    ratios = board.get(FLOOR, [])
    count = len(ratios)
    middle = median(ratios) if ratios else math.nan
    largest = max(ratios, default=math.nan)
    start = "measured loops: forecast of the other ramp over the replicate floor"
    return [
        criterion(f"{start}, median", _alone(middle, count), at_most=MEDIAN),
        criterion(f"{start}, largest", _alone(largest, count), at_most=LARGEST),
    ]


def _alone(value: float, count: int) -> Estimate:
    """Figure of all loops there are, without an interval."""
    return Estimate(value, value, value, count)
