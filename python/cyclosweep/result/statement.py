"""The answer in sentences that a test engineer can act on."""

import math
from collections.abc import Sequence

from cyclosweep.result.answer import Answer
from cyclosweep.result.calibration import Thinning
from cyclosweep.result.calibration_words import (
    HIDDEN_BY_FRICTION,
    calibration_words,
    change_words,
    follows_temperature,
    has_friction,
    is_hidden_by_friction,
    play_words,
)
from cyclosweep.result.effects import Explanation, Remainder
from cyclosweep.result.plausibility import Doubt
from cyclosweep.result.proof import HeldOutBlock
from cyclosweep.result.shape_words import cause_in_words, shape_of_size, size_left
from cyclosweep.result.stand_in_words import removed
from cyclosweep.result.tolerance_words import difference_words, tolerance_words
from cyclosweep.result.words import (
    degrees,
    falls,
    listed,
    place_of,
    readable,
    telling_digits,
    with_article,
)

SPREAD = 3
"""Classes of behaviour from which something belongs to none of them."""
MOST = 0.5
"""Share of the mismatch from which a model removes most of it."""
WORTH_SAYING = 0.02
"""Share that a law misses inside its class from which the statement says so."""


def statement_of(answer: Answer) -> str:
    """Compose the statement of a diagnosis.

    Parameters
    ----------
    answer : Answer
        The answer with all its parts but the statement.

    Returns
    -------
    str
        One paragraph.
    """
    said = doubt_sentences(answer.plausibility) + _verdict_sentences(answer)
    said += _forecast_sentences(answer.repaired.blocks)
    return said if answer.thinning is None else f"{said} {thinning_words(answer.thinning)}"


def doubt_sentences(doubts: Sequence[Doubt]) -> str:
    """Say before anything else what is far from the drive file, and what it may mean."""
    if not doubts:
        return ""
    return "Check first: " + "; ".join(doubt.text for doubt in doubts) + ". "


def _verdict_sentences(answer: Answer) -> str:
    """Say what the verdict means for this recording."""
    match answer.verdict:
        case "NOTHING_MISSING":
            return _nothing_missing(answer)
        case "INSUFFICIENT_DATA":
            return _insufficient(answer)
        case "IDENTIFIED":
            return _identified(answer)
        case "AMBIGUOUS":
            return _ambiguous(answer)
        case "MOSTLY_EXPLAINED":
            return _mostly_explained(answer)
    return _unknown(answer)


def _nothing_missing(answer: Answer) -> str:
    """Say that simulation and recording agree."""
    return (
        "Nothing is missing: simulation and recording agree within the noise of "
        f"{degrees(answer.noise.sigma_deg)}, and every effect this recording can show is below "
        f"{degrees(_largest_bound(answer))} (tolerance {degrees(answer.tolerance_deg)}). "
        + _calibration(answer)
    )


def _insufficient(answer: Answer) -> str:
    """Say which effects could still be too large, or that few readings fit several laws."""
    if answer.classes:
        options = " or ".join(_option(explanation) for explanation in answer.explanation_set)
        return (
            "Something is missing, and so few readings cannot tell which law it follows. It may be "
            f"{options}.{_classes(answer)} It shows most at "
            f"{place_of(answer.mismatch.regions)}. {_calibration(answer)}"
        )
    open_effects = sorted(answer.undecided, key=lambda bound: -bound.upper95_deg)
    names = listed([bound.name for bound in open_effects[:4]]) if open_effects else "no effect"
    return (
        f"{difference_words(answer)}, but the recording is too poor to rule out what matters: "
        f"{names} could be as large as {degrees(_largest_bound(answer))}, above the "
        f"tolerance of {degrees(answer.tolerance_deg)}. " + _calibration(answer)
    )


def _identified(answer: Answer) -> str:
    """Name what is missing."""
    names = listed([effect.name for effect in answer.effects])
    return (
        f"Missing physics: {names}{_others(answer.explanation_set)}. Size after "
        f"re-calibration: {_sizes(answer)}.{tolerance_words(answer)} It shows most at "
        f"{place_of(answer.mismatch.regions)}.{_improvement(answer)} {_calibration(answer)}"
    )


def _ambiguous(answer: Answer) -> str:
    """List what may be missing."""
    options = " or ".join(_option(explanation) for explanation in answer.explanation_set)
    return (
        f"Something is missing, and this recording cannot say which: {options}. It shows most "
        f"at {place_of(answer.mismatch.regions)}.{_improvement(answer)} "
        f"{_calibration(answer)}"
    )


def _mostly_explained(answer: Answer) -> str:
    names = listed([effect.name for effect in answer.effects])
    share = "most"
    if answer.explained.share is not None:
        ends = answer.explained.ci95
        digits = telling_digits(answer.explained.share, ends)
        share = f"{100 * answer.explained.share:.{digits}g} %"
        if ends is not None:
            share += f" (95 %: {100 * ends[0]:.{digits}g} to {100 * ends[1]:.{digits}g})"
    remains = "something without a name"
    if answer.unknown is not None:
        remains = _remains(answer.unknown, answer)
    return (
        f"Missing physics: {names}{_others(answer.explanation_set)}. It explains {share} of the "
        f"mismatch; what is left {_beside_noise(answer)} and has no name of its own: {remains}."
        f"{_missed(answer)}{_classes(answer)} Size after re-calibration: {_sizes(answer)}."
        f"{tolerance_words(answer)}{_shows_most(answer)}"
        f"{_improvement(answer)} {_calibration(answer)}"
    )


def _unknown(answer: Answer) -> str:
    """Describe what is missing and has no name."""
    known = ""
    if answer.effects:
        names = listed([effect.name for effect in answer.effects])
        known = f" Beside {names} ({_sizes(answer)}),"
    remains = ""
    if answer.unknown is not None:
        remains = f": {_remains(answer.unknown, answer)}"
    calibration = _calibration(answer)
    if answer.drift is not None and answer.change is None:
        remains = ": a drift from run to run"
        calibration = (
            "The recording is not stationary: a model of some runs misses others by "
            f"{degrees(answer.drift.other_deg)} against {degrees(answer.drift.own_deg)} on its "
            "own. It is unfit for a stiffness; warm-up, wear or creep have to settle first."
        )
    return (
        f"Unknown physics:{known} something without a name in the vocabulary remains{remains}."
        f"{_classes(answer)}{_stand_ins(answer)}{tolerance_words(answer)}{_shows_most(answer)} "
        f"{calibration}"
    )


def _shows_most(answer: Answer) -> str:
    """Say where what is left shows most, or the mismatch before the repair where that is known."""
    regions, place = answer.mismatch.regions, place_of(answer.mismatch.regions)
    is_repaired = answer.effects or answer.repaired.stand_ins
    if regions and is_repaired and not regions[0].repaired:
        return f" Before the repair the model missed most at {place}."
    return f" It shows most at {place}."


def _remains(rest: Remainder, answer: Answer) -> str:
    """Say what is left without a name.

    Parameters
    ----------
    rest : Remainder
        What is left.
    answer : Answer
        The answer; what has the shape of an effect that it names is left by the law of that one.

    Returns
    -------
    str
    """
    if rest.shape in {effect.name for effect in answer.effects}:
        return f"what the law of {readable(rest.shape)} misses, {size_left(rest)}, {rest.place}"
    return f"{shape_of_size(rest.shape, size_left(rest))}, {rest.place}"


def _stand_ins(answer: Answer) -> str:
    """Say what a repair removes whose laws may not be named, where that is most of the mismatch."""
    laws, found = answer.repaired.stand_ins, removed(answer)
    if not laws or found is None or found.share < MOST:
        return ""
    others = [effect.name for effect in answer.effects if effect.name not in laws]
    beside = f" beside {listed(others)}" if others else ""
    stand_in = "a stand-in" if len(laws) == 1 else "stand-ins"
    return (
        f" It behaves like {listed(laws)}, whose law is not decided: the repaired model, with "
        f"{stand_in} of that name{beside}, {found.in_words}; what a stand-in removes does not "
        "count as explained."
    )


def _classes(answer: Answer) -> str:
    """Say of which class of behaviour that is for which no law stands.

    What a named law misses inside its class is said of that law.
    """
    named = {each.behaviour for each in answer.classes if each.laws}
    shown = [each for each in answer.classes if not each.laws and each.behaviour not in named]
    if not shown:
        return ""
    if len(shown) >= SPREAD:
        names = listed([each.behaviour for each in shown])
        return f" It is spread over several classes of behaviour ({names}), as no listed effect is."
    words = []
    for each in shown:
        text = with_article(each.behaviour)
        if answer.verdict == "INSUFFICIENT_DATA":
            words.append(text)
            continue
        others = [name for name in each.candidates if name not in each.stand_ins]
        notes = [f"listed effects of this class: {listed(others)}"] if others else []
        if each.stand_ins:
            stands = "stands" if len(each.stand_ins) == 1 else "stand"
            notes.append(f"{listed(each.stand_ins)} only {stands} in for it")
        words.append(f"{text} ({'; '.join(notes)})" if notes else text)
    kinds = "Its class of behaviour is" if len(words) == 1 else "Its classes of behaviour are"
    law = ", its law is not" if answer.verdict != "INSUFFICIENT_DATA" else ""
    return f" {kinds} clear{law}: {', and '.join(words)}."


def _missed(answer: Answer) -> str:
    """Say what named laws miss inside their classes, where it is worth a word."""
    words = [
        f" Inside its class, {with_article(each.behaviour)}, the law of {listed(each.laws)} misses "
        f"{100 * each.missed_share:.2g} %."
        for each in answer.classes
        if each.laws and each.missed_share is not None and each.missed_share >= WORTH_SAYING
    ]
    return "".join(words)


def _forecast_sentences(blocks: Sequence[HeldOutBlock]) -> str:
    """Say how well whole loops are forecast; nothing where the flank was taken as recorded."""
    forecasts = [block for block in blocks if block.is_forecast]
    if not forecasts:
        return ""
    before, after, told, floor = (
        _over_all(forecasts, name)
        for name in ("before_deg", "after_deg", "told_after_deg", "floor_deg")
    )
    text = (
        " As a forecast of what was not fitted, crossings of the dead zone included, the model "
        f"errs by {degrees(after)}, before the repair by {degrees(before)}; "
        f"with the recorded flank given, by {degrees(told)}."
    )
    if floor is not None:
        text += f" Another run as the prediction leaves {degrees(floor)}."
    return text


def _over_all(blocks: Sequence[HeldOutBlock], name: str) -> float | None:
    """Root mean square of an error over all readings of the blocks that have it.

    Parameters
    ----------
    blocks : sequence of HeldOutBlock
        Blocks that were forecast.
    name : str
        Which error.

    Returns
    -------
    float or None
        In deg; None where no block has it.
    """
    given = [(block.samples or 1, getattr(block, name)) for block in blocks]
    known = [(samples, error) for samples, error in given if error is not None]
    if not known:
        return None
    total = sum(samples for samples, _ in known)
    return math.sqrt(sum(samples * error**2 for samples, error in known) / total)


def _largest_bound(answer: Answer) -> float:
    """Largest upper bound of an effect that was not found [deg]."""
    bounds = (*answer.ruled_out, *answer.undecided)
    return max((bound.upper95_deg for bound in bounds), default=0.0)


def _sizes(answer: Answer) -> str:
    """Accepted effects with their sizes and intervals."""
    words = []
    for effect in answer.effects:
        size, (low, high) = effect.size_deg.estimate, effect.size_deg.ci95
        digits = telling_digits(size, (low, high))
        words.append(
            f"{readable(effect.name)} {degrees(size, digits)} "
            f"(95 %: {low:.{digits}g} to {high:.{digits}g})"
        )
    return "; ".join(words)


def _beside_noise(answer: Answer) -> str:
    """How what is left stands to the noise: its size may be no larger, though it has a shape."""
    noise, left = answer.noise.sigma_deg, answer.repaired.rmse_deg
    if noise is not None and left is not None and left <= noise:
        return f"is on average no larger than the noise of {degrees(noise)}, but has a shape,"
    return "is above the noise"


def _improvement(answer: Answer) -> str:
    """Errors before and after the repair; those on data not used only where computed."""
    before, after = answer.baseline, answer.repaired
    text = f" With it the error falls from {degrees(before.rmse_deg)} to {degrees(after.rmse_deg)}"
    if before.holdout_rmse_deg is not None and before.holdout_rmse_deg > 0.0:
        left_out = degrees(before.holdout_rmse_deg), degrees(after.holdout_rmse_deg)
        if falls(before.holdout_rmse_deg, after.holdout_rmse_deg):
            text += f", on data not used from {left_out[0]} to {left_out[1]}"
        else:
            text += f"; on data not used it is {left_out[1]}, without {left_out[0]}"
    return f"{text}."


def _option(explanation: Explanation) -> str:
    """One explanation with its probability."""
    names = [*explanation.effects, *explanation.without_name]
    return f"{' + '.join(map(cause_in_words, names))} ({100 * explanation.probability:.0f} %)"


def _others(explanations: Sequence[Explanation]) -> str:
    """What else it may be, beside the explanation that is named."""
    if len(explanations) < 2:
        return ""
    first, *rest = explanations
    return (
        f", with a probability of {100 * first.probability:.0f} %; not ruled out: "
        + " or ".join(_option(explanation) for explanation in rest)
    )


def _calibration(answer: Answer) -> str:
    """What the calibration found; the compliance as a range where the drive changed."""
    if answer.change is None:
        warms = follows_temperature(answer)
        read = play_words(answer.play_and_stiffness, warms=warms)
        if is_hidden_by_friction(answer.findings, "play"):
            return f"{read}{HIDDEN_BY_FRICTION}"
        calibrated = calibration_words(
            answer.repaired.parameters,
            warms=warms,
            rubs=has_friction(answer),
            read=answer.play_and_stiffness,
        )
        return f"{read}{calibrated}"
    return change_words(answer.change, answer.repaired.parameters)


def thinning_words(thinning: Thinning) -> str:
    """Say how a long recording was thinned."""
    done = []
    if thinning.averaged > 1:
        done.append(f"about {thinning.averaged} neighbours averaged in each")
    if thinning.every > 1:
        done.append(f"one in {thinning.every} taken")
    words = f" ({', '.join(done)})" if done else ""
    return (
        f"For the diagnosis the {thinning.samples:,} samples were thinned to "
        f"{thinning.rows:,} rows{words}; reversals, dwells and runs were kept apart."
    )
