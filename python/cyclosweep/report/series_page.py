"""The page across the recordings of a series: trends, means by condition, a row for each."""

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from cyclosweep.atomic import write_text
from cyclosweep.page import bullets, document
from cyclosweep.report.charts import AFTER, BEFORE, Figure, Line, Panel, Placed, Points, Series
from cyclosweep.report.svg import figure_svg
from cyclosweep.report.wording import interval, number, words_of
from cyclosweep.result.series import MEASURES, StepsInCommon, Trend, as_shown
from cyclosweep.result.words import readable

Row = Mapping[str, Any]

UNITS = {
    "friction_nm": "N m",
    "play_deg": "deg",
    "lost_motion_deg": "deg",
    "loop_compliance_deg_per_nm": "deg/(N m)",
}
"""Unit of each measure."""


def write_series_page(
    path: str | Path,
    rows: Sequence[Row],
    conditions: Sequence[str],
    trends: Sequence[Trend],
    steps: StepsInCommon | None = None,
) -> None:
    """Write the page across the recordings of a series.

    Parameters
    ----------
    path : path
        File to write, beside the folders of the recordings.
    rows : sequence of mappings
        Rows of the table.
    conditions : sequence of str
        Columns that are conditions.
    trends : sequence of Trend
        What rises or falls with which condition.
    steps : StepsInCommon, optional
        Order that the steps of the torque share.
    """
    done = sum(row["status"] == "ok" for row in rows)
    body = [
        '<header class="top"><h1>Series of recordings</h1><div class="meta">Torque–twist '
        f"diagnosis<br>{done} of {len(rows)} diagnosed</div></header>",
        _trends(rows, trends),
        _steps(steps),
        _by_side(rows, conditions, Path(path).parent),
        _check_first(rows),
        _not_read(rows),
        _failed(rows),
        '<p class="soft">Friction, play and compliance are read by straight lines through the '
        "middle of each loop, between 20 and 80 % of the largest torque, with 95 % intervals by "
        "Student's t over the runs of a recording, or over the recordings at one value of a "
        "condition; friction is half the width of the loop in torque. Sizes of the effects are "
        'those of the diagnosis. All columns: <a href="table.csv">table.csv</a>.</p>',
    ]
    write_text(path, document("Series of recordings", "".join(filter(None, body))))


def _by_side(rows: Sequence[Row], conditions: Sequence[str], folder: Path) -> str:
    """Tables of the recordings, those measured at the input apart from those at the output.

    Parameters
    ----------
    rows : sequence of mappings
        Rows of the table.
    conditions : sequence of str
        Columns that are conditions.
    folder : Path
        Where the page is written.

    Returns
    -------
    str
    """
    sides = sorted({str(row["side"]) for row in rows if row.get("side")}, reverse=True)
    if len(sides) < 2:
        return f"<section><h2>Every recording</h2>{_table(rows, conditions, folder)}</section>"
    # Those without a diagnosis are listed below, with the reason.
    return "".join(
        f"<section><h2>Measured at the {escape(side)} shaft</h2>{_table(part, conditions, folder)}"
        "</section>"
        for side in sides
        for part in [[row for row in rows if row.get("side") == side]]
    )


def _check_first(rows: Sequence[Row]) -> str:
    """What is far from the drive file, by recording."""
    return bullets(
        "Check first",
        [f"{row['recording']}: {row['remarks']}" for row in rows if row.get("remarks")],
    )


def _not_read(rows: Sequence[Row]) -> str:
    """Why values are missing or read in another way, by recording."""
    items = [
        f"{row['recording']}: a value is missing because {row['not_read']}"
        for row in rows
        if row.get("not_read")
    ]
    items += [
        f"{row['recording']}: play and compliance are those of the calibrated model, with the "
        "effects that were found, as the readings are too few or too coarse for lines through the "
        "branches, and for a friction"
        for row in rows
        if row.get("read_by") == "calibrated model"
    ]
    return bullets("How values were read", items)


def _trends(rows: Sequence[Row], trends: Sequence[Trend]) -> str:
    """Sentences, pictures and means of all trends."""
    parts = []
    for condition in dict.fromkeys(trend.condition for trend in trends):
        own = [trend for trend in trends if trend.condition == condition]
        said = "".join(f"<li>{escape(trend.text)}</li>" for trend in own)
        panels = tuple(
            Placed(panel=_panel(rows, trend), row=0, column=k) for k, trend in enumerate(own)
        )
        figure = Figure(
            key=f"trend-{condition}",
            title=f"By {readable(condition)}",
            caption="",
            panels=panels,
            columns=len(panels),
            row_height=300,
        )
        head = "".join(f"<th>{escape(heading(trend.measure))}</th>" for trend in own)
        lines = []
        for level in own[0].levels:
            cells = "".join(_mean(trend, level.value) for trend in own)
            lines.append(f"<tr><td>{number(level.value)}</td>{cells}</tr>")
        parts.append(
            f"<section><h2>By {escape(readable(condition))}</h2><ul>{said}</ul>"
            f"<figure>{figure_svg(figure)}<figcaption>Rings: recordings. Line and bars: mean of "
            "each value with its 95 % interval.</figcaption></figure>"
            f'<div class="scroll"><table><thead><tr><th>{escape(readable(condition))}</th>{head}'
            f"</tr></thead><tbody>{''.join(lines)}</tbody></table></div></section>"
        )
    return "".join(parts)


def _steps(steps: StepsInCommon | None) -> str:
    """Order that the steps share, and that of each recording."""
    if steps is None:
        return ""
    head = (
        "recording",
        "clearest order",
        "random staircases with as clear an order",
        "order of the other recordings",
        "random staircases in which that one is as clear",
    )
    lines = "".join(
        f"<tr><td>{escape(name)}</td><td>{number(own.order)}</td>"
        f"<td>{_percent(own.chance)}</td><td>{number(own.order_of_others)}</td>"
        f"<td>{_percent(own.chance_of_others)}</td></tr>"
        for name, own in steps.own.items()
    )
    return (
        f"<section><h2>Steps of the torque</h2><p>{escape(steps.text)}</p>"
        f'<div class="scroll"><table><thead><tr>{"".join(f"<th>{escape(h)}</th>" for h in head)}'
        f"</tr></thead><tbody>{lines}</tbody></table></div></section>"
    )


def _percent(share: float) -> str:
    """Share in percent."""
    return f"{100 * share:.2g} %"


def _mean(trend: Trend, value: float) -> str:
    """Cell with the mean at one value of the condition."""
    level = next((each for each in trend.levels if each.value == value), None)
    if level is None:
        return "<td>–</td>"
    return f"<td>{escape(_shown(trend.measure, level.mean, level.ci95))}</td>"


def heading(measure: str) -> str:
    """Measure with its unit."""
    unit = UNITS.get(measure)
    name = MEASURES.get(measure, readable(measure))
    return f"{name} ({unit})" if unit else name


def _panel(rows: Sequence[Row], trend: Trend) -> Panel:
    """One measure over one condition."""
    known = [
        row
        for row in rows
        if isinstance(row.get(trend.condition), float) and row.get(trend.measure) is not None
    ]
    x = np.array([row[trend.condition] for row in known], dtype=np.float64)
    y = np.array([row[trend.measure] for row in known], dtype=np.float64)
    at = np.array([level.value for level in trend.levels])
    mean = np.array([level.mean for level in trend.levels])
    bars_x, bars_y = [], []
    for level in trend.levels:
        if level.ci95 is not None:
            bars_x += [level.value, level.value, np.nan]
            bars_y += [*level.ci95, np.nan]
    series: list[Series] = [
        Points(x, y, "recording", BEFORE, 3.6, hollow=True),
        Line(at, mean, "mean", AFTER, 1.8),
    ]
    if bars_x:
        series.append(Line(np.array(bars_x), np.array(bars_y), "95 % interval", AFTER, 1.2))
    return Panel(
        title=MEASURES.get(trend.measure, readable(trend.measure)).capitalize(),
        x_label=readable(trend.condition),
        y_label=heading(trend.measure),
        series=tuple(series),
        x_names=tuple((float(value), number(float(value))) for value in at),
    )


def _measured(row: Row, measure: str) -> str:
    """Value of a measure with its interval; a play below zero is none.

    Parameters
    ----------
    row : mapping
        Row of a recording.
    measure : str
        Name of the measure.

    Returns
    -------
    str
    """
    value, low, high = (row.get(name) for name in (measure, f"{measure}_low", f"{measure}_high"))
    if value is None:
        return number(None)
    ends = None if low is None or high is None else (float(low), float(high))
    return _shown(measure, float(value), ends)


def _shown(measure: str, value: float, ends: tuple[float, float] | None) -> str:
    """Value and interval of a measure as they are shown.

    Parameters
    ----------
    measure : str
        Name of the measure.
    value : float
        Its value or mean.
    ends : (float, float) or None
        Its interval.

    Returns
    -------
    str
    """
    text = number(as_shown(measure, value))
    if ends is None:
        return text
    return f"{text} ({interval([as_shown(measure, end) for end in ends])})"


def _table(rows: Sequence[Row], conditions: Sequence[str], folder: Path) -> str:
    """Row of each recording: conditions, verdict, measures with intervals, effects with sizes.

    Parameters
    ----------
    rows : sequence of mappings
        Rows of the table.
    conditions : sequence of str
        Columns that are conditions.
    folder : Path
        Where the page is written.

    Returns
    -------
    str
    """
    measures = [name for name in MEASURES if any(row.get(name) is not None for row in rows)]
    head = ["recording", *map(readable, conditions), "verdict", *map(heading, measures), "effects"]
    words = {0, len(conditions) + 1, len(head) - 1}

    def cell(tag: str, place: int, content: str) -> str:
        name = f' data-name="{escape(head[place])}"' if tag == "td" and place else ""
        return f"<{tag}{' class=words' if place in words else ''}{name}>{content}</{tag}>"

    lines = []
    for row in rows:
        cells = [_link(row, folder), *(_value(row.get(condition)) for condition in conditions)]
        cells.append(escape(verdict_of(row)))
        for measure in measures:
            cells.append(escape(_measured(row, measure)))
        cells.append(escape("; ".join(_sizes(row))))
        lines.append(
            "<tr>" + "".join(cell("td", k, text) for k, text in enumerate(cells)) + "</tr>"
        )
    top = "".join(cell("th", k, escape(text)) for k, text in enumerate(head))
    return (
        f'<div class="scroll"><table class="stacked"><thead><tr>{top}</tr></thead>'
        f"<tbody>{''.join(lines)}</tbody></table></div>"
    )


def _link(row: Row, folder: Path) -> str:
    """Name of a recording, with a link to its report, or to its diagnosis without one.

    Parameters
    ----------
    row : mapping
        Row of the table.
    folder : Path
        Where the page is written.

    Returns
    -------
    str
    """
    name = str(row["recording"])
    for file in ("report.html", "diagnosis.json"):
        if row["status"] == "ok" and (folder / name / file).exists():
            return f'<a href="{quote(name)}/{file}">{escape(name)}</a>'
    return escape(name)


def verdict_of(row: Row) -> str:
    """Verdict of a row in words."""
    verdict = row.get("verdict")
    if verdict is None:
        return "no diagnosis"
    return words_of(verdict, has_effects=bool(row.get("effects")))


def _sizes(row: Row) -> list[str]:
    """Effects of a recording with their sizes."""
    names = str(row.get("effects") or "").split(" + ")
    return [
        f"{readable(name)} {number(row.get(f'{name}_deg'))} deg "
        f"({interval((row[f'{name}_deg_low'], row[f'{name}_deg_high']))})"
        for name in names
        if name and row.get(f"{name}_deg_low") is not None
    ]


def _value(value: object) -> str:
    """Value of a condition."""
    return (
        number(value) if isinstance(value, float) else escape("–" if value is None else str(value))
    )


def _failed(rows: Sequence[Row]) -> str:
    """Recordings without a diagnosis, with the reason."""
    items = "".join(
        f"<li>{escape(str(row['recording']))}: {escape(str(row.get('reason') or ''))}</li>"
        for row in rows
        if row["status"] != "ok"
    )
    return f"<section><h2>Not diagnosed</h2><ul>{items}</ul></section>" if items else ""
