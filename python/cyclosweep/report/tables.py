"""The tables of a report as plain rows, shared by the page and the terminal."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cyclosweep.report.data import ReportData
from cyclosweep.report.loops import LoopFigures, loop_figures
from cyclosweep.report.wording import ARCMIN, angle, interval, number, plain, probability


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under a heading.

    Attributes
    ----------
    title, note : str
        Heading, and what a reader should know about it.
    columns : tuple of str
        Column headings with their units.
    rows : tuple of tuple of str
        Cells.
    words : frozenset of int
        Columns that hold text rather than numbers, besides the first.
    lead : frozenset of int
        Rows that matter most.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    words: frozenset[int] = frozenset()
    lead: frozenset[int] = frozenset()


def loop_table(data: ReportData) -> Table | None:
    """Lost motion, hysteresis loss, stiffness and energy: measured, before, after."""
    measured = data.recording.angle_deg
    if measured is None or len(data.recording) < 2:
        return None
    sources = [("measured", measured), ("before", data.before_deg), ("after", data.after_deg)]
    columns = [(name, loop_figures(data.recording, a, data.rated_torque_nm))
               for name, a in sources if a is not None]  # fmt: skip
    figures = [f for _, f in columns]
    side, rated = data.recording.side, data.rated_torque_nm
    of = "rated" if rated else "the largest"
    extended = " (extended)" if figures[0].extrapolated else ""
    rows = [
        (
            f"lost motion at ±3 % of {of} torque{extended}",
            *(angle(f.lost_motion_deg) for f in figures),
        ),
        (f"hysteresis loss{extended}", *(angle(f.hysteresis_loss_deg) for f in figures)),
        (f"stiffness at the {side}", *(_stiffness(f.stiffness_nm_per_deg) for f in figures)),
    ]
    if side == "input" and data.ratio:
        ratio = data.ratio
        rows += [
            ("stiffness at the output", *(_at_output(f, ratio) for f in figures)),
            ("lost motion at the output", *(_divided(f.lost_motion_deg, ratio) for f in figures)),
            (
                "hysteresis loss at the output",
                *(_divided(f.hysteresis_loss_deg, ratio) for f in figures),
            ),
        ]
    rows.append(("energy lost in one cycle, mean", *(_mean_energy(f) for f in figures)))
    note = f"Stiffness is the slope of the loading branches between 50 % and 100 % of {of} torque."
    lost, gap = figures[0].lost_motion_deg, figures[0].hysteresis_loss_deg
    if lost is not None and gap is not None and gap > lost:
        note += (
            " Friction holds the shaft inside its play here: the play shows as hysteresis loss "
            "rather than as lost motion."
        )
    if figures[0].extrapolated:
        note += (
            " No sample lies within ±3 % of that torque: lost motion and hysteresis loss are "
            "straight-line extensions of the nearest samples."
        )
    return Table("Loop figures", ("", *(n for n, _ in columns)), tuple(rows), note)


def parameter_table(data: ReportData) -> Table | None:
    """Baseline parameters before and after the repair, with the shift in standard errors."""
    before = _section(data.result, "baseline").get("parameters") or {}
    after = _section(data.result, "repaired").get("parameters") or {}
    if not before:
        return None
    rows = []
    for name, value in before.items():
        fitted = after.get(name) or {}
        rows.append(
            (
                _without_unit(name),
                str(value.get("unit") or "–"),
                number(value.get("nominal"), 4),
                _with_error(value),
                _with_error(fitted) if fitted else "–",
                _shift(value, fitted),
            )
        )
    rows += [
        (_without_unit(name), str(value.get("unit") or "–"), "–", "–", _with_error(value), "–")
        for name, value in after.items()
        if name not in before and isinstance(value, Mapping)
    ]
    return Table(
        "Parameters",
        ("parameter", "unit", "nominal", "before", "after", "shift (standard errors)"),
        tuple(rows),
        "A stiffness, free play or datum that differs from nominal is calibration, not missing "
        "physics. The shift is how far the repair moved a parameter, in standard errors of the "
        "fit before.",
        frozenset({1}),
    )


def hypothesis_table(data: ReportData) -> Table | None:
    """Every effect of the library: hidden share, size, interval, evidence, smallest detectable."""
    rows: list[tuple[str, ...]] = []
    lead: set[int] = set()
    for row in data.hypotheses:
        if row.outcome == "accepted":
            lead.add(len(rows))
        rows.append(
            (
                plain(row.name),
                row.outcome,
                "–" if row.absorbed_share is None else f"{100 * row.absorbed_share:.0f} %",
                number(row.size_deg),
                interval(row.ci95_deg),
                probability(row.p_value),
                number(row.e_value, 2),
                number(row.smallest_detectable_deg),
            )
        )
    if not rows:
        return None
    return Table(
        "Every effect that was tried",
        (
            "effect", "outcome", "hidden by calibration", "size (deg)", "95 % interval (deg)",
            "p", "e", "smallest detectable (deg)",
        ),
        tuple(rows),
        "Hidden by calibration: share of the effect that a refit of stiffness, free play and datum "
        "absorbs. p: chance of so large a signal with nothing missing, each effect by itself, all "
        "of them searched; what an accepted effect explains as well is ruled out all the same. "
        "e: evidence from data not used for the choice; 100 is strong.",
        frozenset({1}),
        frozenset(lead),
    )  # fmt: skip


def held_out_table(data: ReportData) -> Table | None:
    """Errors on data that was not used."""
    if not data.held_out:
        return None
    rows = tuple(
        (
            row.block,
            str(row.samples),
            number(row.rmse_before_deg),
            number(row.rmse_after_deg),
            number(row.floor_deg),
        )
        for row in data.held_out
    )
    if any(row.told_after_deg is not None for row in data.held_out):
        return _forecast_table(data)
    return Table(
        "Held-out errors",
        ("block", "samples", "before (deg rms)", "after (deg rms)", "floor (deg rms)"),
        rows,
        "The floor is what noise, or one replicate against another, leaves.",
    )


def _forecast_table(data: ReportData) -> Table:
    """Errors of forecasts, three ways, beside the error of another run as the prediction."""
    rows = []
    for row in data.held_out:
        for how, before, after, floor in (
            ("free forecast, all samples", row.rmse_before_deg, row.rmse_after_deg, row.floor_deg),
            ("told the flank, samples in contact", row.told_before_deg, row.told_after_deg, None),
            ("distance to the curve", row.near_before_deg, row.near_after_deg, None),
        ):
            rows.append(
                (row.block, how, str(row.samples), number(before), number(after), number(floor))
            )
    return Table(
        "Held-out errors",
        (
            "block", "judged by", "samples", "before (deg rms)", "after (deg rms)",
            "replicate floor (deg rms)",
        ),
        tuple(rows),
        "A free forecast is what `cyclosweep simulate model.json` gives: it has to find for itself "
        "when the shaft leaves a flank, and a crossing of the dead zone that comes a moment early "
        "or late costs the whole play for that moment. Told the flank, the same model is asked "
        "only for the twist on it. The distance to the curve forgives early and late alike. The "
        "floor is what an earlier run leaves as the prediction of this one.",
        frozenset({1}),
        frozenset(range(0, len(rows), 3)),
    )  # fmt: skip


def self_check_table(data: ReportData) -> Table | None:
    """Say what the diagnosis does on synthetic twins of this recording."""
    check = _section(data.result, "self_check")
    if not check:
        return None
    rows = [
        ("false alarms with nothing missing", _percent(check.get("false_alarm"))),
        ("found, when the named effect is there", _percent(check.get("power"))),
    ]
    confusion = check.get("confusion") or {}
    if isinstance(confusion, Mapping):
        for name, value in confusion.items():
            if isinstance(value, Mapping):
                text = ", ".join(f"{plain(str(k))} {_percent(v)}" for k, v in value.items())
            else:
                text = _percent(value)
            rows.append((f"twin with {plain(str(name))} is called", text))
    return Table(
        "Self-check on synthetic twins of this recording",
        ("", "share of twins"),
        tuple(rows),
        "Twins have the same load history, noise and resolution, and known causes.",
        frozenset({1}) if confusion else frozenset(),
    )


def effect_cards(data: ReportData) -> list[tuple[str, str, str, str]]:
    """Name, size, evidence and physics of every accepted effect."""
    cards = []
    for effect in data.result.get("effects") or []:
        size = effect.get("size_deg") or {}
        estimate, ci = size.get("estimate"), size.get("ci95")
        text = angle(estimate)
        if ci:
            text += f", 95 % interval {interval(ci)} deg"
        if isinstance(estimate, int | float) and data.compliance_deg_per_nm:
            text += f"; worth {number(abs(estimate / data.compliance_deg_per_nm))} N m"
        evidence = (
            f"p {probability(effect.get('p_value'))}, e-value {number(effect.get('e_value'), 2)}, "
            f"detectability {number(effect.get('detectability'), 3)}"
        )
        parameters = "; ".join(
            f"{_without_unit(name)} {_with_error(value)} {value.get('unit') or ''}".strip()
            for name, value in (effect.get("parameters") or {}).items()
        )
        evidence += f". {parameters[:1].upper()}{parameters[1:]}" if parameters else ""
        cards.append(
            (plain(str(effect.get("name"))), text, evidence, str(effect.get("physics") or ""))
        )
    return cards


def headline(data: ReportData) -> list[tuple[str, str, str]]:
    """Figures beside the verdict: value, what it is, remark."""
    base, repaired = _section(data.result, "baseline"), _section(data.result, "repaired")
    noise = _section(data.result, "noise")
    rows = []
    for key, label in (("holdout_rmse_deg", "held-out error"), ("rmse_deg", "fit error")):
        before, after = base.get(key), repaired.get(key)
        if before is None and after is None:
            continue
        if data.is_repaired and after is not None:
            rows.append((f"{number(before)} → {number(after)} deg", label, "before → after"))
        else:
            rows.append((f"{number(before)} deg", label, "calibrated model"))
    if noise.get("sigma_deg") is not None:
        rows.append((f"{number(noise['sigma_deg'])} deg", "noise", "standard deviation"))
    return rows


def bounds(data: ReportData) -> list[str]:
    """Upper bounds of what was not found, those above the tolerance first."""
    undecided = [
        f"{plain(str(row.get('name')))}: could be as large as {angle(row.get('upper95_deg'))}, "
        "above the tolerance"
        for row in data.result.get("undecided") or []
    ]
    ruled_out = [
        f"{plain(str(row.get('name')))}: at most {angle(row.get('upper95_deg'))}"
        for row in data.result.get("ruled_out") or []
    ]
    return undecided + ruled_out


def unknown(data: ReportData) -> str:
    """Shape, place and size of what has no name, in one sentence."""
    rest = _section(data.result, "unknown")
    if not rest:
        return ""
    place = f", {rest['place']}" if rest.get("place") else ""
    return (
        f"{plain(str(rest.get('shape') or 'something')).capitalize()} of "
        f"{angle(rest.get('size_deg'))}{place}. No effect of the vocabulary explains it."
    )


def findings(data: ReportData) -> list[str]:
    """What the loop shows, in the words of a gear test."""
    return [f"{row.get('topic')}: {row.get('text')}" for row in data.result.get("findings") or []]


def untestable(data: ReportData) -> list[str]:
    """Say what this recording cannot show, why, and what would."""
    rows = []
    for row in data.result.get("not_testable") or []:
        needs = f" Needs: {row['needs']}." if row.get("needs") else ""
        reason = str(row.get("reason") or "").rstrip(".")
        rows.append(f"{plain(str(row.get('name')))}: {reason}.{needs}")
    return rows


def explanations(data: ReportData) -> list[str]:
    """Structures that fit about as well as the best."""
    rows = []
    for row in data.result.get("explanation_set") or []:
        names = [*(row.get("effects") or []), *(row.get("without_name") or [])]
        text = " + ".join(plain(str(name)) for name in names) or "nothing missing"
        rows.append(f"{text}: probability {probability(row.get('probability'))}")
    return rows


def next_experiment(data: ReportData) -> str:
    """Load programme that would tell most, in one sentence or two."""
    plan = data.result.get("next_experiment")
    if not plan:
        return ""
    text = str(plan.get("program") or "").rstrip(".") + "."
    text = text[:1].upper() + text[1:]
    if plan.get("separates"):
        names = [plain(str(name)) for name in plan["separates"]]
        text += f" It would {'show or rule out' if len(names) == 1 else 'separate'} "
        text += " from ".join(names) + "."
    if plan.get("detectability"):
        text += f" Expected detectability {number(plan['detectability'], 2)} noise units."
    if plan.get("minutes"):
        text += f" Takes about {number(plan['minutes'], 2)} minutes."
    return text


def regions(data: ReportData) -> list[str]:
    """Where simulation and recording differ, in words."""
    texts = []
    for region in _section(data.result, "mismatch").get("regions") or []:
        where = []
        if region.get("torque_nm"):
            where.append(f"{_range(region['torque_nm'])} N m")
        if region.get("direction") not in (None, "both"):
            where.append(str(region["direction"]))
        if region.get("run"):
            first, last = region["run"][0], region["run"][-1]
            where.append(f"run {first}" if first == last else f"runs {first} to {last}")
        for key, unit in (("time_s", "s"), ("crank_deg", "deg of crank"), ("temperature_c", "°C")):
            if region.get(key):
                where.append(f"{_range(region[key])} {unit}")
        size = angle(region.get("mean_residual_deg"))
        share = region.get("share_of_excess")
        part = "" if share is None else f", {100 * share:.0f} % of the excess"
        texts.append(
            f"{', '.join(where) or 'everywhere'}: mean residual {size}{part}, "
            f"p {probability(region.get('p_value'))}"
        )
    return texts


def _section(result: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """Part of the result, empty where there is none."""
    part = result.get(key)
    return part if isinstance(part, Mapping) else {}


def _without_unit(name: str) -> str:
    """Name of a parameter in words; its unit stands beside it."""
    return plain(re.sub(r"_(deg|nm|s|c|nm_s_per_deg|deg_per_nm)$", "", name))


def _range(ends: Any) -> str:
    """Write two ends of a range."""
    return f"{number(ends[0])} to {number(ends[1])}"


def _with_error(value: Mapping[str, Any]) -> str:
    """Estimate and standard error."""
    text = number(value.get("estimate"), 4)
    error, estimate = value.get("std_error"), value.get("estimate")
    if not error:
        return text
    if isinstance(estimate, int | float) and error > 10 * abs(estimate) > 0:
        return f"{text} (poorly determined)"
    return f"{text} ± {number(error, 2)}"


def _shift(before: Mapping[str, Any], after: Mapping[str, Any]) -> str:
    """How far the repair moved a parameter, in standard errors."""
    a, b, error = before.get("estimate"), after.get("estimate"), before.get("std_error")
    if a is None or b is None or not error:
        return "–"
    shift = (b - a) / error
    return f"{shift:+.1f}".replace("-", "−")


def _stiffness(nm_per_deg: float | None) -> str:
    """Stiffness in N m/arcmin and N m/rad."""
    if nm_per_deg is None:
        return "–"
    return f"{number(nm_per_deg / ARCMIN)} N m/arcmin ({number(np.degrees(nm_per_deg))} N m/rad)"


def _at_output(figures: LoopFigures, ratio: float) -> str:
    """Stiffness of the input shaft as seen from the output shaft."""
    k = figures.stiffness_nm_per_deg
    return _stiffness(None if k is None else k * ratio**2)


def _divided(value_deg: float | None, ratio: float) -> str:
    """Angle of the input shaft as seen from the output shaft."""
    return angle(None if value_deg is None else value_deg / ratio)


def _mean_energy(figures: LoopFigures) -> str:
    """Mean energy of the cycles."""
    energy = list(figures.energy_j.values())
    return f"{number(float(np.mean(energy)))} J" if energy else "–"


def _percent(value: Any) -> str:
    """Write a share in percent."""
    return f"{100 * value:.3g} %" if isinstance(value, int | float) else str(value)
