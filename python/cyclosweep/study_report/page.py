"""The report of a study as one HTML page."""

from __future__ import annotations

import math
from html import escape
from importlib.resources import files

from cyclosweep.choose.budget import BudgetItem
from cyclosweep.choose.comparison import DriveFigures
from cyclosweep.design.units import quantity
from cyclosweep.errors import DesignError, InputError
from cyclosweep.page import Table, broken, bullets, definitions, document, section, table_html
from cyclosweep.study_report.gather import FRONT_ROWS, StudyFacts
from cyclosweep.study_report.pictures import effect_svg, feasible_svg, figure_image, scatter_svg
from cyclosweep.study_report.words import (
    NOTHING,
    label,
    limit_words,
    method_words,
    number,
    summary,
    why_not_robust,
    wish,
)

__all__ = ["study_page"]

PRINTED_ROWS = 40
"""Rows of the front on paper, evenly spread: one page."""
RANK_WORDS = "sorted by the first objective; choose a row with the arrow keys, or click a point"
EFFECT_AXES = 6
"""Inputs whose effect is drawn for each objective: those that matter most."""


def study_page(facts: StudyFacts) -> str:
    """Whole page.

    Parameters
    ----------
    facts : StudyFacts
        What it says.

    Returns
    -------
    str
        HTML without any other file.
    """
    here = files("cyclosweep.study_report")
    body = "".join(
        [
            _top(facts),
            _summary(facts),
            section("Chosen variants", _cards(facts)),
            section(_front_title(facts), _front(facts)),
            section("Chosen variants side by side", _side_by_side(facts)),
            section("Robust candidates", _robust(facts)),
            section("What drives what", _drivers(facts)),
            section("Which variants can be built", _feasibility(facts)),
            section("Ranges of the results", _ranges(facts)),
            section("The drive, and where its numbers come from", _drive(facts)),
            section("Provenance", _provenance(facts)),
        ]
    )
    return document(
        f"Study of {facts.study.drive.name}",
        body,
        style=here.joinpath("style.css").read_text(encoding="utf-8"),
        script=here.joinpath("script.js").read_text(encoding="utf-8"),
    )


def _top(facts: StudyFacts) -> str:
    study = facts.study
    about = f"{study.rows:,} variants · {method_words(facts)} · study {study.hash[:12]}"
    return (
        f'<header class="top"><h1>Study of {escape(study.drive.name)}</h1>'
        f'<div class="meta">{escape(about)}</div></header>'
    )


def _summary(facts: StudyFacts) -> str:
    share = facts.aggregate.feasible / max(facts.aggregate.rows, 1)
    headline = [
        (f"{facts.aggregate.rows:,}", "variants"),
        (f"{share:.1%}", "feasible"),
        (f"{facts.front_size:,}", "on the front" if len(facts.objectives) > 1 else "listed"),
    ]
    figures = "".join(
        f'<div class="figure-value"><b>{escape(value)}</b><span>{escape(name)}</span></div>'
        for value, name in headline
    )
    sentences = "".join(f"<li>{escape(text)}</li>" for text in summary(facts))
    warnings = _warnings(facts)
    return (
        f'<section class="verdict" style="--tone:#0b6e4f"><ul>{sentences}</ul>'
        f'<div class="figures">{figures}</div></section>{bullets("Be careful", warnings)}'
    )


def _warnings(facts: StudyFacts) -> list[str]:
    """Warnings that all chosen variants share are said once."""
    if facts.comparison is None:
        return []
    found: dict[str, list[str]] = {}
    for each in facts.comparison.figures:
        for remark in each.remarks:
            if remark.level != "note":
                found.setdefault(remark.text, []).append(each.label)
    whole = len(facts.comparison.figures)
    lines = [
        text if len(labels) == whole else f"{', '.join(labels)}: {text}"
        for text, labels in found.items()
    ]
    if facts.study.definition.get("model") != "components":
        lines.append(
            "this is the published model: shaft and pins alone yield, contacts and clearances do "
            "not; Eq. (13) multiplies the compliance by the torque transfer efficiency"
        )
    return lines


def _cards(facts: StudyFacts) -> str:
    if facts.comparison is None:
        return ""
    cards = []
    for (variant, why), each in zip(facts.chosen.items(), facts.comparison.figures, strict=True):
        row = facts.study.row(variant)
        names = [o.column for o in facts.objectives if o.column in row] + list(facts.study.axes)
        listed = definitions((label(name), number(row[name])) for name in dict.fromkeys(names))
        command = f"cyclosweep pick {facts.study.folder.name} {variant} --out drive.toml"
        cards.append(
            f'<div class="card" id="variant-{variant}"><h3>Variant {variant}</h3>'
            f'<p class="soft">{escape(why)}</p>{_drawing(each)}{listed}'
            f"{_budget(each)}<p><code>{escape(command)}</code></p></div>"
        )
    return f'<div class="cards">{"".join(cards)}</div>'


def _drawing(each: DriveFigures) -> str:
    """Disc of a drive; a sentence where it cannot be drawn."""
    try:
        from cyclosweep.figures.disc import disc_figure

        return figure_image(disc_figure(each.drive), f"disc of {each.label}")
    except (DesignError, InputError) as error:
        return f'<p class="soft">No drawing: {escape(str(error))}</p>'


def _budget(each: DriveFigures) -> str:
    """Bars of the compliance by parts, of the richer model that there is."""
    items, words = (
        (each.components, "component model at rated torque")
        if each.components
        else (each.published, "published model")
    )
    if not items:
        return ""
    whole = sum(item.compliance_arcmin_per_nm for item in items)
    rows = "".join(_budget_row(item) for item in sorted(items, key=lambda item: -item.share))
    return (
        f'<table class="budget"><caption>Compliance by parts, {words}: '
        f"{number(1 / whole)} N m/arcmin in all</caption><thead><tr><th>part</th>"
        f"<th>N m/arcmin</th><th>share</th></tr></thead><tbody>{rows}</tbody></table>"
    )


def _budget_row(item: BudgetItem) -> str:
    stiffness = item.stiffness_nm_per_arcmin
    words = "rigid" if stiffness is None else number(stiffness)
    width = max(min(100 * item.share, 100.0), 0.0)
    return (
        f"<tr><td>{escape(item.part)}</td><td>{words}</td>"
        f'<td class="share" style="--share:{width:.1f}%">{item.share:.1%}</td></tr>'
    )


def _front_title(facts: StudyFacts) -> str:
    if len(facts.objectives) > 1:
        return "Pareto front"
    return f"Best variants: {wish(facts.objectives[0])}"


def _front(facts: StudyFacts) -> str:
    if facts.front.is_empty():
        return "<p>No feasible variant lies within the limits.</p>"
    texts = [each.column for each in facts.objectives]
    picture = ""
    if len(facts.outcomes) > 1:
        across, up = facts.outcomes[:2]
        pairs = facts.front.select("variant", across, up).iter_rows()
        points = [(int(v), float(a), float(b)) for v, a, b in pairs]
        ranges = (facts.aggregate.ranges[across], facts.aggregate.ranges[up])
        svg = scatter_svg(facts.aggregate.cells, ranges, points, (label(across), label(up)))
        picture = (
            f"<figure>{svg}<figcaption>Shaded: all feasible variants, the darker the more. "
            f"Points: {'the front' if len(texts) > 1 else 'the best'}.</figcaption></figure>"
            '<p class="chosen-row" aria-live="polite">No variant chosen yet.</p>'
        )
    columns = list(dict.fromkeys(["variant", *texts, *facts.study.axes]))
    head = "".join(
        f'<th><button type="button" data-column="{place}">{broken(label(name))}</button></th>'
        for place, name in enumerate(columns)
    )
    rows = []
    every = -(-facts.front.height // PRINTED_ROWS)
    for place, row in enumerate(facts.front.select(columns).iter_rows()):
        cells = "".join(
            f'<td data-value="{_plain(v)}">{v if k == 0 else number(v)}</td>'
            for k, v in enumerate(row)
        )
        kind = "lead" if row[0] in facts.chosen else "" if place % every == 0 else "screen"
        kind = f' class="{kind}"' if kind else ""
        rows.append(f'<tr{kind} tabindex="-1" data-variant="{row[0]}">{cells}</tr>')
    size = f"{facts.front_size:,} variants"
    if facts.front_size > facts.front.height:
        size += f", of which {FRONT_ROWS} evenly spread ones are listed"
    wishes = " and ".join(map(wish, facts.objectives))
    limits = f", within {' and '.join(facts.limits)}" if facts.limits else ""
    return (
        f"<p>{escape(wishes[:1].upper() + wishes[1:] + limits)}: {size}, {RANK_WORDS}.</p>{picture}"
        f'<div class="scroll tall" tabindex="0" aria-label="variants of the front">'
        f'<table class="front"><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody>'
        "</table></div>"
    )


def _plain(value: object) -> str:
    return repr(value) if isinstance(value, (int, float)) else escape(str(value))


def _side_by_side(facts: StudyFacts) -> str:
    if facts.comparison is None:
        return ""
    labels = [each.label for each in facts.comparison.figures]
    rows = [
        (row["key"], *(number(row[name], 5) for name in labels), _unit(row["unit"]))
        for row in facts.comparison.results.iter_rows(named=True)
    ]
    table = Table("", ("", *labels, "unit"), tuple(rows), words=frozenset({len(labels) + 1}))
    return table_html(table)


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def _robust(facts: StudyFacts) -> str:
    if not facts.robust or facts.tolerances is None:
        return f'<p class="soft">{escape(why_not_robust(facts))}</p>'
    columns = ["variant"]
    for each in facts.objectives:
        columns += [f"{label(each.column)}, as drawn", "5 %", "50 %", "95 %"]
    rows = []
    for found in facts.robust:
        cells = [str(found.variant)]
        for each in facts.objectives:
            cells.append(number(found.nominal[each.column]))
            cells += [number(value) for value in found.percentiles[each.column]]
        rows.append((*cells, f"{found.usable:.1%}", found.refused))
    given = ", ".join(
        f"{name} {_deviation(held)}" for name, held in facts.tolerances.inputs.items()
    )
    note = (
        f"{'Assumed, since no tolerance file was given' if facts.are_assumed else 'Tolerances'}: "
        f"{given}. Percentiles of all pieces that can be built; usable ones keep the limits, too. "
        "The first row is the candidate whose worst pieces are best, of those of which at least "
        "99 % are usable where there is one."
    )
    return table_html(
        Table(
            "",
            (*columns, "usable", "most of the others"),
            tuple(rows),
            note,
            words=frozenset({len(columns) + 1}),
            lead=frozenset({0}),
        )
    )


def _deviation(held: object) -> str:
    low, high = getattr(held, "low", None), getattr(held, "high", None)
    if isinstance(low, float) and isinstance(high, float) and low == -high:
        return f"±{number(high, 3)}"
    return str(held)


def _drivers(facts: StudyFacts) -> str:
    axes = facts.aggregate.axes
    if not axes or facts.aggregate.feasible < 2:
        return ""
    head = "".join(f"<th>{broken(label(name))}</th>" for name in facts.outcomes)
    rows = ""
    for axis in axes:
        cells = "".join(
            f'<td class="heat" style="--heat:{axis.shares[name]:.2f}">{axis.shares[name]:.0%}</td>'
            for name in facts.outcomes
        )
        rows += f"<tr><td>{broken(axis.name)}</td>{cells}</tr>"
    rest = "".join(
        f"<td>{max(1 - sum(axis.shares[name] for axis in axes), 0.0):.0%}</td>"
        if not math.isclose(*facts.aggregate.ranges[name], rel_tol=1e-9)
        else "<td>does not vary</td>"
        for name in facts.outcomes
    )
    table = (
        f'<div class="scroll"><table><thead><tr><th>input</th>{head}</tr></thead><tbody>{rows}'
        f"<tr><td>several together</td>{rest}</tr></tbody></table></div>"
        '<p class="soft">Share of each result\'s variance among feasible variants that goes with '
        "one input alone: first-order Sobol indices where the inputs vary independently of each "
        "other. Limits tie inputs together, so that shares can then sum to more than 100 %. They "
        "hold for the ranges of this study.</p>"
    )
    pictures = ""
    for objective in facts.objectives[:2]:
        name = objective.column
        most = sorted(axes, key=lambda axis: -axis.shares[name])[:EFFECT_AXES]
        drawn = "".join(effect_svg(axis, name, (label(axis.name), label(name))) for axis in most)
        if drawn:
            pictures += (
                f'<figure><div class="small">{drawn}</div><figcaption>Mean of {escape(name)} over '
                "each input, with one standard deviation of what the other inputs do."
                "</figcaption></figure>"
            )
    return table + pictures


def _feasibility(facts: StudyFacts) -> str:
    summary_ = facts.study.summary
    rows = "".join(
        f"<tr><td>{broken(name)}</td><td>{count:,}</td>"
        f'<td class="share" style="--share:{100 * count / max(summary_.rows, 1):.1f}%">'
        f"{count / max(summary_.rows, 1):.1%}</td></tr>"
        for name, count in facts.statuses.items()
    )
    drawn = "".join(feasible_svg(axis, label(axis.name)) for axis in facts.aggregate.axes)
    return (
        "<table><thead><tr><th>status</th><th>variants</th><th>share</th></tr></thead>"
        f"<tbody>{rows}</tbody></table>"
        f'<figure><div class="small">{drawn}</div><figcaption>Share of the variants that can be '
        "built and keep the limits, over each input.</figcaption></figure>"
    )


def _ranges(facts: StudyFacts) -> str:
    rows = [
        (name, number(low, 5), number(high, 5), _unit(quantity_unit(facts, name)))
        for name, (low, high) in facts.study.summary.ranges.items()
    ]
    table = Table("", ("result", "least", "greatest", "unit"), tuple(rows), words=frozenset({3}))
    return f"<details><summary>{len(rows)} results</summary>{table_html(table)}</details>"


def quantity_unit(facts: StudyFacts, name: str) -> str:
    """Unit of a column, as the study's files say it."""
    return facts.study.columns.get(name, {}).get("unit", "1")


def _drive(facts: StudyFacts) -> str:
    drive = facts.study.drive
    values = {**drive.values(), **drive.part_values()}
    rows = []
    for name, value in values.items():
        mark = drive.provenance.get(name, "")
        if math.isnan(value):
            continue
        shown = drive.criterion if name == "criterion" else number(value, 6)
        varies = "varied here" if name in facts.study.axes else ""
        kind = mark.partition(":")[0].strip() or "unmarked"
        rows.append(
            f'<tr class="{kind}"><td>{broken(name)}</td><td>{escape(shown)}</td>'
            f'<td class="words">{_unit(quantity(name).unit)}</td>'
            f'<td class="words">{escape(mark or "no mark")}</td>'
            f'<td class="words">{varies or NOTHING}</td></tr>'
        )
    return (
        '<p class="soft">Numbers on yellow are assumed: what follows from them is no better than '
        'they are.</p><div class="scroll"><table class="drive"><thead><tr><th>input</th>'
        '<th>value</th><th class="words">unit</th><th class="words">origin</th>'
        f'<th class="words"></th></tr></thead><tbody>{"".join(rows)}</tbody></table></div>'
    )


def _provenance(facts: StudyFacts) -> str:
    study = facts.study
    limits = [limit_words(*limit) for limit in study.definition["limits"]]
    rows = [
        ("study, SHA-256", study.hash),
        ("cyclosweep", study.version),
        ("folder", str(study.folder)),
        ("method", f"{study.definition['method']}, seed {study.definition['seed']}"),
        ("variants", f"{study.rows:,} of {study.variants:,}"),
        ("inputs that vary", ", ".join(study.axes)),
        ("loads [T_N]", ", ".join(f"{load:g}" for load in study.loads_tn)),
        ("limits of the study", "; ".join(limits) or "none"),
        ("further limits of this report", "; ".join(facts.limits) or "none"),
        ("model", study.model),
    ]
    return definitions(rows)
