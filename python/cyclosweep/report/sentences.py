"""What a report says in lists and sentences, shared by the page and the terminal."""

from collections.abc import Mapping

import numpy as np

from cyclosweep.recording.unbroken_runs import ONE_HISTORY, UNBROKEN
from cyclosweep.report.data import ReportData
from cyclosweep.report.look_at import LOOK_AT
from cyclosweep.report.summary import not_shown
from cyclosweep.report.wording import (
    angle,
    interval,
    number,
    probability,
    with_error,
    without_unit,
)
from cyclosweep.result import EffectParameter, FoundEffect, Region
from cyclosweep.result.contradictions import NONE_NEEDED
from cyclosweep.result.shape_words import cause_in_words, shape_of_size, with_measure
from cyclosweep.result.stand_in_words import removed_by_stand_ins, stand_in_words
from cyclosweep.result.tolerance_words import below_tolerance
from cyclosweep.result.words import readable, telling_digits

FIT = "Explanations that fit"
"""Heading of the explanations."""
FIT_BEST = "Explanations that fit best of those compared"
"""The same where something is left that has no name."""
LEAST_BACKWARDS = 0.01
"""Friction below zero, over the largest torque, from which a loop runs the wrong way round."""
BACKWARDS = (
    "loop: it runs the wrong way round, as if the drive gave out work (friction below zero), which "
    "no passive drive does. Check whether the torque is filtered or read later than the angle, the "
    "order of the rows, and the signs."
)


def effect_cards(data: ReportData) -> list[tuple[str, str, str, str, str]]:
    """Name, size, evidence, physics and what to look at of every accepted effect."""
    return [
        (
            readable(effect.name),
            _size(effect, data.result.tolerance_deg),
            _evidence(effect),
            effect.physics,
            LOOK_AT.get(effect.name, ""),
        )
        for effect in data.result.effects
    ]


def look_at(data: ReportData) -> list[str]:
    """What to look at on the drive, by effect."""
    return [
        f"{readable(effect.name)}: {LOOK_AT[effect.name]}"
        for effect in data.result.effects
        if effect.name in LOOK_AT
    ]


def _size(effect: FoundEffect, tolerance_deg: float | None) -> str:
    """Size of an effect with its interval, the load of the same twist, and whether it matters.

    Parameters
    ----------
    effect : FoundEffect
    tolerance_deg : float or None
        Size below which an effect does not matter [deg].
    """
    size = effect.size_deg
    digits = telling_digits(size.estimate, size.ci95)
    text = f"{angle(size.estimate, digits)}, 95 % interval {interval(size.ci95, digits)} deg"
    if effect.size_nm is not None:
        text += f"; the twist of {number(effect.size_nm)} N m of load"
    below = below_tolerance(effect, tolerance_deg)
    return f"{text}; {below}" if below else text


def _evidence(effect: FoundEffect) -> str:
    """Evidence for an effect, and its parameters."""
    text = (
        f"p {probability(effect.p_value)}, detectability {number(effect.detectability, 3)}; "
        f"e-value of all effects together {number(effect.e_value, 2)}"
    )
    if effect.size_deg.ci95[0] <= 0.0:
        text += ". By itself it may be nothing: the other effects can take its place"
    parameters = _parameters(effect.parameters)
    return text + (f". {parameters[:1].upper()}{parameters[1:]} (± 95 %)" if parameters else "")


def _parameters(parameters: Mapping[str, EffectParameter]) -> str:
    """Parameters with their errors and units."""
    return "; ".join(
        f"{without_unit(name)} {with_error(value.estimate, value.std_error)} {value.unit}".strip()
        for name, value in parameters.items()
    )


LOOPS = "way through the play included"
"""What errors of whole loops count that others do not."""


def headline(data: ReportData) -> list[tuple[str, str, str]]:
    """Figures beside the verdict: value, what it is, remark."""
    base, repaired = data.result.baseline, data.result.repaired
    rows = []
    for before, after, label in (
        (base.holdout_rmse_deg, repaired.holdout_rmse_deg, "held-out error"),
        (base.rmse_deg, repaired.rmse_deg, "fit error"),
    ):
        if before is None and after is None:
            continue
        if base.counted == "whole loops":
            label += f", {LOOPS}"
        if not before and not after:  # as with --quick: no error is exactly zero
            rows.append(("–", label, "not computed"))
            continue
        if data.is_repaired and after is not None:
            names = stand_in_words(data.result)
            remark = f"before → after, {names}" if names else "before → after"
            rows.append((f"{number(before)} → {number(after)} deg", label, remark))
        else:
            rows.append((f"{number(before)} deg", label, "calibrated model"))
    if data.result.noise.sigma_deg is not None:
        rows.append((f"{number(data.result.noise.sigma_deg)} deg", "noise", "standard deviation"))
    return rows


def possible(data: ReportData) -> list[str]:
    """Upper bounds of the effects that may be the cause."""
    named = _possible(data)
    return [
        f"{readable(bound.name)}: at most {angle(bound.upper95_deg)}"
        for bound in data.result.undecided
        if bound.name in named
    ]


def _possible(data: ReportData) -> set[str]:
    """Effects that some explanation holds."""
    return {name for each in data.result.explanation_set for name in each.effects}


def bounds(data: ReportData) -> list[str]:
    """Upper bounds of what was not found, those above the tolerance first."""
    causes = _possible(data)
    undecided = [bound for bound in data.result.undecided if bound.name not in causes]
    tolerance = data.result.tolerance_deg or 0.0
    above = [bound for bound in undecided if bound.upper95_deg >= tolerance]
    below = [bound for bound in undecided if bound not in above] + list(data.result.ruled_out)
    return [
        f"{readable(bound.name)}: could be as large as {angle(bound.upper95_deg)}, "
        "above the tolerance"
        for bound in above
    ] + [f"{readable(bound.name)}: at most {angle(bound.upper95_deg)}" for bound in below]


def unknown(data: ReportData) -> str:
    """Shape, place and size of what has no name, in one sentence."""
    rest = data.result.unknown
    if rest is None:
        return removed_by_stand_ins(data.result)
    place = f", {rest.place}" if rest.place else ""
    size = with_measure(rest, angle(rest.size_deg))
    if rest.shape in {effect.name for effect in data.result.effects}:
        said = f"What the law of {readable(rest.shape)} misses, {size}{place}."
    else:
        what = shape_of_size(rest.shape, size).removeprefix("a ")
        said = (
            f"{what[:1].upper()}{what[1:]}{place}. No listed effect explains it within the noise."
        )
    return f"{said} {removed_by_stand_ins(data.result)}".rstrip()


def findings(data: ReportData) -> list[str]:
    """What the loop shows, in the words of a gear test."""
    backwards = [BACKWARDS] if runs_backwards(data) else []
    return backwards + [f"{finding.topic}: {finding.text}" for finding in data.result.findings]


def runs_backwards(data: ReportData) -> bool:
    """Whether a loop takes less torque on the way up than on the way down, error allowed for."""
    read = data.result.play_and_stiffness
    if read is None or read.friction_nm is None:
        return False
    highest = read.friction_nm.ci95[1] if read.friction_nm.ci95 else read.friction_nm.estimate
    return highest < -LEAST_BACKWARDS * float(np.abs(data.recording.torque_nm).max())


def untestable(data: ReportData) -> list[str]:
    """What this recording cannot show, why, and what would show it."""
    rows = []
    for row in data.result.not_testable:
        needs = f" Needs: {row.needs}." if row.needs else ""
        rows.append(f"{readable(row.name)}: {row.reason.rstrip('.')}.{needs}")
    return rows


def asked(data: ReportData) -> list[str]:
    """What the diagnosis asks about the recording because its file does not say it."""
    return [note for note in data.result.notes if note in (ONE_HISTORY, UNBROKEN)]


def explanations_heading(data: ReportData) -> str:
    """Heading of the explanations; where something is left without a name, they only fit best."""
    return FIT if data.result.unknown is None else FIT_BEST


def explanations(data: ReportData) -> list[str]:
    """Structures that fit about as well as the best; laws that were not found to hold, marked."""
    named = {effect.name for effect in data.result.effects}
    unsure = set(data.result.repaired.stand_ins) - named
    rows = []
    for explanation in data.result.explanation_set:
        effects = [
            f"{readable(name)} (a stand-in, whose law was not found to hold)"
            if name in unsure
            else readable(name)
            for name in explanation.effects
        ]
        names = [*effects, *map(cause_in_words, explanation.without_name)]
        text = " + ".join(names) or "nothing missing"
        rows.append(f"{text}: probability {probability(explanation.probability)}")
    return rows


def next_experiment(data: ReportData) -> str:
    """Load programme that would tell most, in one sentence or two."""
    plan = data.result.next_experiment
    if plan is None or (plan.program == NONE_NEEDED and not_shown(data.result)):
        return ""
    text = plan.program.rstrip(".") + "."
    text = text[:1].upper() + text[1:]
    if plan.loads_nm:
        text += f" Loads in order: {', '.join(number(load) for load in plan.loads_nm)} N m."
        text += _beyond_rated(max(map(abs, plan.loads_nm)), data.rated_torque_nm)
    if plan.rig_programme:
        text += (
            f" Programme to start from: examples/rigs/{plan.rig_programme}.csv (docs/rigs.md)"
            + (", with these loads." if plan.loads_nm else ".")
        )
    if plan.separates:
        text += f" It would {'show or rule out' if len(plan.separates) == 1 else 'separate'} "
        text += " from ".join(map(readable, plan.separates)) + "."
    if plan.detectability:
        text += f" It would show at {number(plan.detectability, 2)} times the noise."
    if plan.minutes:
        text += f" Takes about {number(plan.minutes, 2)} minutes."
    return text


def _beyond_rated(largest_nm: float, rated_nm: float | None) -> str:
    """Sentence on loads beyond the rated torque [N m]; empty where they are not, or none is known.

    Parameters
    ----------
    largest_nm : float
        Largest load of a programme [N m].
    rated_nm : float or None
        Rated torque at the same shaft [N m].

    Returns
    -------
    str
    """
    if not rated_nm or largest_nm <= 1.01 * rated_nm:
        return ""
    times = number(largest_nm / rated_nm)
    return f" The largest is {times} times the rated torque: less, where the drive may not bear it."


def regions(data: ReportData) -> list[str]:
    """Where simulation and recording differ, in words."""
    texts = []
    for region in data.result.mismatch.regions:
        size = angle(region.mean_residual_deg)
        share = region.share_of_excess
        when = ""
        if data.is_repaired:
            when = " after the repair" if region.repaired else " before the repair"
        part = "" if share is None else f", {_percent(share)} of the misfit"
        texts.append(
            f"{_place(region)}: mean residual {size}{when}{part}, p {probability(region.p_value)}"
        )
    return texts


def _place(region: Region) -> str:
    """Limits of a region in words."""
    where = []
    if region.torque_nm:
        where.append(f"{_range(region.torque_nm)} N m")
    if region.direction not in (None, "both"):
        where.append(str(region.direction))
    if region.run:
        first, last = region.run
        where.append(f"run {first}" if first == last else f"runs {first} to {last}")
    if region.readings:
        where.append(f"readings {region.readings[0]} to {region.readings[1]}")
    for ends, unit in (
        (region.time_s, "s"),
        (region.crank_deg, "deg of crank"),
        (region.temperature_c, "°C"),
    ):
        if ends:
            where.append(f"{_range(ends)} {unit}")
    return ", ".join(where) or "everywhere"


def _percent(share: float) -> str:
    """Write a share in percent."""
    return "less than 1 %" if share < 0.01 else f"{100 * share:.0f} %"


def _range(ends: tuple[float, float]) -> str:
    """Write two ends of a range, or the one place that both are."""
    first, last = map(number, ends)
    return first if ends[0] == ends[1] else f"{first} to {last}"
