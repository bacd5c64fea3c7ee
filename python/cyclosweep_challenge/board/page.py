"""The score as one self-contained HTML page."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
import polars as pl

from cyclosweep_challenge.board.curves import power_chart, power_series
from cyclosweep_challenge.board.gallery import Exhibit
from cyclosweep_challenge.board.svg import Series, chart
from cyclosweep_challenge.board.terminal import as_text, within_reach
from cyclosweep_challenge.scoring.criterion import Criterion
from cyclosweep_challenge.scoring.power import PROGRAMMES
from cyclosweep_challenge.scoring.score import Score
from cyclosweep_challenge.trial.tiers import TIERS

STYLE = """
body{font:15px/1.45 system-ui,sans-serif;max-width:1080px;margin:2rem auto;padding:0 1rem;
color:#1a1a1a;background:#fff}
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2.2rem}
table{border-collapse:collapse;font-size:.88rem}td,th{padding:.22rem .55rem;text-align:left;
border-bottom:1px solid #e3e3e3;vertical-align:top}
td.n{text-align:right;font-variant-numeric:tabular-nums}
.ok{color:#15803d}.part{color:#a16207}.no{color:#b91c1c}.row{display:flex;flex-wrap:wrap;gap:1rem}
.row>div{flex:1 1 440px;min-width:0}svg{width:100%;max-width:540px;height:auto;font-size:10px}
svg .title{font-size:12px;font-weight:600}svg .grid{stroke:#e6e6e6}
.legend{font-size:.8rem}.legend span{margin-right:.9rem;white-space:nowrap}
.legend i{display:inline-block;width:.7rem;height:.7rem;margin-right:.3rem}
.matrix td,.matrix th{font-size:.72rem;padding:.15rem .3rem;text-align:center}
.matrix th.side{text-align:right}.wide{overflow-x:auto}code{word-break:break-all}
@media(prefers-color-scheme:dark){body{background:#141414;color:#e6e6e6}svg text{fill:#e6e6e6}
td,th{border-color:#333}svg .grid{stroke:#333}}
"""


def _state(criterion: Criterion) -> str:
    """Cell that says whether a figure is reached."""
    if criterion.met is None:
        return "<td></td>" if criterion.target == "none" else "<td>too few cases</td>"
    if criterion.met:
        return '<td class="ok">reached</td>'
    if criterion.met_required:
        return '<td class="part">required only</td>'
    return '<td class="no">missed</td>'


def _criteria(score: Score) -> str:
    """Table of all figures."""
    rows = "".join(
        f"<tr><td>{escape(f.name)}</td><td class=n>{as_text(f.estimate)}</td>"
        f"<td class=n>{f.estimate.count}</td>"
        f"<td>{'' if f.target == 'none' else escape(f.target)}</td>"
        f"<td>{escape(f.required)}</td>{_state(f)}</tr>"
        for f in score.criteria
    )
    head = "<th>figure<th>reached [95 %]<th>cases<th>target<th>required<th>"
    return f"<table><tr>{head}</tr>{rows}</table>"


def _power(score: Score, programme: str, noise: str) -> str:
    """Power curves of the diagnosis, the knowing test and the opponents."""
    curves = [c for c in score.curves if (c.programme, c.noise) == (programme, noise)]
    rivals = [o for o in score.opponents if (o.programme, o.noise) == (programme, noise)]
    named = [(c.who, c.points) for c in curves]
    named += [(f"{o.who} at 1 %", o.own.power) for o in rivals]
    series = power_series(
        [(who, [(d, e.value, e.low, e.high) for d, e in points]) for who, points in named]
    )
    return power_chart(f"{programme} programme, {noise} noise", series)


def _opponents(score: Score) -> str:
    """Table of the d that the diagnosis and each opponent need, on the same recordings."""
    rows = "".join(
        f"<tr><td>{escape(c.who)}</td><td>{c.programme}</td><td>{c.noise}</td><td></td>"
        f"<td class=n>{within_reach(c.needed)}</td></tr>"
        for c in score.curves
        if c.needed.count
    )
    rows += "".join(
        f"<tr><td>{escape(o.who)}</td><td>{o.programme}</td><td>{o.noise}</td>"
        f"<td class=n>{as_text(o.default_alarms)}</td>"
        f"<td class=n>{within_reach(o.own.needed)}</td></tr>"
        for o in score.opponents
    )
    head = "<th>who<th>programme<th>noise<th>false alarms at defaults<th>d for 90 % power at 1 %"
    return f"<table><tr>{head}</tr>{rows}</table>"


def _calibration(score: Score) -> str:
    """Stated probabilities against frequencies."""
    bins = score.calibration
    explanations = Series(
        "explanations",
        [b.stated for b in bins],
        [b.frequency.value for b in bins],
        [b.frequency.low for b in bins],
        [b.frequency.high for b in bins],
    )
    honest = Series("as stated", [0.0, 1.0], [0.0, 1.0], colour="#999999")
    return chart(
        "Stated probabilities",
        "stated probability",
        "share that was true",
        [honest, explanations],
        x_range=(0.0, 1.0),
        y_range=(0.0, 1.0),
    )


def _matrix(table: pl.DataFrame) -> str:
    """Confusion matrix, darker where there are more cases."""
    if table.is_empty():
        return "<p>No cases.</p>"
    names = [c for c in table.columns if c != "cause"]
    head = "".join(f"<th>{escape(n.replace('_', ' '))}</th>" for n in names)
    rows = []
    for row in table.iter_rows(named=True):
        total = sum(row[n] for n in names)
        cells = "".join(
            f'<td style="background:rgba(11,95,165,{row[n] / total:.2f})">{row[n] or ""}</td>'
            for n in names
        )
        side = escape(row["cause"].replace("_", " "))
        rows.append(f'<tr><th class="side">{side}</th>{cells}</tr>')
    body = "".join(rows)
    return f'<div class=wide><table class="matrix"><tr><th></th>{head}</tr>{body}</table></div>'


def _exhibit(item: Exhibit) -> str:
    """One example case: residual before beside after the repair, on the same scale."""
    outcome = item.outcome
    span = float(np.quantile(np.abs(item.before_deg), 0.998)) * 1.2
    reach = float(np.abs(item.torque_nm).max()) * 1.04
    panels = []
    for words, left in (("calibrated only", item.before_deg), ("repaired", item.after_deg)):
        if left is None:
            panels.append("<div><p>No repaired model.</p></div>")
            continue
        cloud = Series("", item.torque_nm.tolist(), left.tolist(), line=False)
        panels.append(
            "<div>"
            + chart(
                words,
                "torque [N m]",
                "left over [deg]",
                [cloud],
                x_range=(-reach, reach),
                y_range=(-span, span),
            )
            + "</div>"
        )
    true = ", ".join(outcome.causes).replace("_", " ")
    mark = "ok" if outcome.named_right or outcome.recognised else "no"
    return (
        f"<h3>{escape(outcome.tier)}: {escape(TIERS[outcome.tier])}</h3>"
        f"<p>At work: <b>{escape(true)}</b> (d = {outcome.d:.1f}). Said: "
        f'<b class="{mark}">{escape(outcome.verdict)} {escape(", ".join(outcome.named))}</b>. '
        f'{escape(item.statement)}</p><div class="row">{"".join(panels)}</div>'
    )


def write_page(score: Score, exhibits: Sequence[Exhibit], path: Path) -> None:
    """Write the page.

    Parameters
    ----------
    score : Score
        What the challenge found.
    exhibits : sequence of Exhibit
        Cases of the gallery.
    path : pathlib.Path
        File to write.
    """
    about = score.about
    noises = dict.fromkeys(["white", *(c.noise for c in score.curves)])
    powers = [_power(score, p, noise) for noise in noises for p in PROGRAMMES]
    charts = "".join(f"<div>{part}</div>" for part in (*powers, _calibration(score)))
    matrices = "".join(
        f"<h3>{escape(programme)} programme</h3>{_matrix(table)}"
        for programme, table in score.confusion.items()
    )
    gallery = "".join(_exhibit(item) for item in exhibits)
    path.write_text(
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width">'
        f"<title>Challenge, seed {about['seed']}</title><style>{STYLE}</style></head><body>"
        f"<h1>Challenge: {about['cases']} concealed recordings</h1>"
        f"<p>Seed {about['seed']}, mix {escape(str(about['mix']))}. The hashes of the answers were "
        f"published before any diagnosis ran; SHA-256 over them: <code>{about['root']}</code></p>"
        f"<h2>Figures and targets</h2>{_criteria(score)}"
        f'<h2>Power, naming, probabilities</h2><div class="row">{charts}</div>'
        f"<h2>Opponents on the same recordings</h2>{_opponents(score)}"
        f"<h2>Who is taken for whom (d above 9)</h2>{matrices}"
        f"<h2>Gallery</h2><p>The first cases of every tier, not the best ones.</p>{gallery}"
        "</body></html>",
        encoding="utf-8",
    )
