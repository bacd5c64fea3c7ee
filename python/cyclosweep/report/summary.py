"""The answer in one or two sentences, and what to look at or to do first."""

from cyclosweep.report.look_at import LOOK_AT, LOOK_AT_SHAPE
from cyclosweep.report.wording import number
from cyclosweep.result import Answer
from cyclosweep.result.contradictions import NONE_NEEDED
from cyclosweep.result.shape_words import cause_in_words, shape_of_size, size_left
from cyclosweep.result.tolerance_words import difference_words, tolerance_words
from cyclosweep.result.words import degrees, falls, listed, readable

CHECK_FIRST, LOOK_AT_PART, RECORD_NEXT = "Check first:", "Look at", "Record next:"
NOTHING_TO_DO = "Nothing:"
LEADS = (CHECK_FIRST, LOOK_AT_PART, RECORD_NEXT, NOTHING_TO_DO)
"""Words with which what is to be done now begins, set in bold on the page."""
NOTHING_TOLD = (
    "The model misses something that no listed effect explains within the noise; its shape and "
    "place do not show."
)
"""Sentence where the error is too large for the noise and no test says why."""
SHOWN_BY_LOOPS = frozenset(
    {
        "friction_hysteresis",
        "load_dependent_friction",
        "contact_stiffening",
        "clearance_takeup",
        "overload_softening",
    }
)
"""Effects that a loop of many readings shows, and other programmes may not."""
HALF = 0.5
"""Share of the mismatch that named effects explain, below which what has no name is most of it."""
NEARLY_ALL = 0.995
"""Share of the mismatch that would be written as all of it, though something is left."""


def summary_of(answer: Answer) -> str:
    """Say in one or two sentences what was found and how much it explains.

    Parameters
    ----------
    answer : Answer
        The whole answer.

    Returns
    -------
    str

    Examples
    --------
    >>> summary_of(Answer(verdict="DATA_FAULT", statement="loop: Time runs backwards."))
    'loop: Time runs backwards.'
    """
    if answer.summary:
        return answer.summary
    match answer.verdict:
        case "NOTHING_MISSING":
            return (
                "The calibrated model and the recording agree within the noise of "
                f"{degrees(answer.noise.sigma_deg)}."
            )
        case "INSUFFICIENT_DATA":
            return _open(answer)
        case "AMBIGUOUS":
            return f"Something is missing, and this recording cannot say which: {_options(answer)}."
        case "DATA_FAULT":
            return answer.statement
    if answer.verdict == "UNKNOWN_PHYSICS" and answer.mismatch.p_value is None:
        return answer.statement  # refused before anything was fitted
    return f"{_named(answer)}{tolerance_words(answer)}{_rest(answer)}"


def do_now(answer: Answer) -> str:
    """Say what to look at on the drive or what to do first; empty where nothing is known.

    Parameters
    ----------
    answer : Answer
        The whole answer.

    Returns
    -------
    str
    """
    if answer.do_now:
        return answer.do_now
    if answer.plausibility:
        text = answer.plausibility[0].text
        return f"{CHECK_FIRST} {text}."
    if answer.verdict == "NOTHING_MISSING":
        if hidden := not_shown(answer):
            return (
                f"Nothing that this recording can show. It cannot show {listed(hidden)}: record "
                "loading and unloading in many steps."
            )
        return f"{NOTHING_TO_DO} the calibrated model describes this drive."
    if place := _look_at(answer):
        return f"{LOOK_AT_PART} {place}"
    plan = answer.next_experiment
    if plan is None or not plan.program or plan.program == NONE_NEEDED:
        return ""
    return f"{RECORD_NEXT} {plan.program}."


def _look_at(answer: Answer) -> str:
    """Where to look for what makes up most of the mismatch; empty where that is not known."""
    if answer.change is not None:
        return ""
    share = answer.explained.share
    if answer.unknown is not None and share is not None and share < HALF:
        if answer.drift is not None:
            return ""
        unnamed = [each.behaviour for each in answer.classes if not each.laws]
        told = [name for name in (answer.unknown.shape, *unnamed) if name in LOOK_AT_SHAPE]
        return LOOK_AT_SHAPE[told[0]] if told else ""
    largest = max(answer.effects, key=lambda effect: effect.size_deg.estimate, default=None)
    return "" if largest is None else LOOK_AT.get(largest.name, "")


def not_shown(answer: Answer) -> list[str]:
    """Usual effects that a recording with nothing missing cannot show.

    Parameters
    ----------
    answer : Answer
        The whole answer.

    Returns
    -------
    list of str
    """
    if answer.verdict != "NOTHING_MISSING":
        return []
    return [row.name for row in answer.not_testable if row.name in SHOWN_BY_LOOPS]


def _named(answer: Answer) -> str:
    """Say which effects explain how much; empty where none is named."""
    if not answer.effects:
        return ""
    names = listed([effect.name for effect in answer.effects])
    verb = "explains" if len(answer.effects) == 1 else "explain"
    what = "of what the calibrated model misses"
    share = answer.explained.share
    if share is None or answer.verdict == "IDENTIFIED":
        verb = "is" if len(answer.effects) == 1 else "are"
        rivals = answer.explanation_set
        sure = f" ({100 * rivals[0].probability:.0f} %)" if len(rivals) > 1 else ""
        text = f"{names} {verb} missing from the model{sure}: "
        text += f"{_errors(answer)}."
    else:
        ends = answer.explained.ci95
        of = "" if ends is None else f" (95 %: {100 * ends[0]:.0f} to {100 * ends[1]:.0f})"
        part = f"{100 * share:.0f} %{of}" if share < NEARLY_ALL else f"over {100 * NEARLY_ALL:g} %"
        text = f"{names} {verb} {part} {what}."
    return text[:1].upper() + text[1:]


def _errors(answer: Answer) -> str:
    """Errors before and after, on data that were not used where there are such."""
    before, after, on = answer.baseline.rmse_deg, answer.repaired.rmse_deg, ""
    if answer.baseline.holdout_rmse_deg:
        before, after = answer.baseline.holdout_rmse_deg, answer.repaired.holdout_rmse_deg
        on = " on data not used"
    them = "it" if len(answer.effects) == 1 else "them"
    if not falls(before, after):
        return f"with {them} the error{on} is {number(after)} deg, without {number(before)}"
    return f"with {them} the error{on} falls from {number(before)} to {number(after)} deg"


def _rest(answer: Answer) -> str:
    """Say what remains without a name; empty where nothing does."""
    space = " " if answer.effects else ""
    if answer.drift is not None and answer.change is None:
        return f"{space}The drive is not the same in all runs: no stiffness can be read from them."
    if answer.change is not None:
        change = answer.change
        went = "rose" if change.share > 0 else "fell"
        return (
            f"{space}The drive changed while it was tested: its compliance {went} by "
            f"{100 * abs(change.share):.2g} %."
        )
    rest = answer.unknown
    if rest is None:
        return "" if answer.effects else NOTHING_TOLD
    named = {effect.name for effect in answer.effects}
    if rest.shape in named:
        return (
            f"{space}What is left, {size_left(rest)}, is what the law of "
            f"{readable(rest.shape)} misses."
        )
    what = shape_of_size(rest.shape, size_left(rest))
    others = [law for law in answer.repaired.stand_ins if law not in named]
    if answer.effects and others:
        return (
            f"{space}What is left, {what}, behaves like {listed(others)}, but follows none of the "
            "listed laws within the noise."
        )
    if answer.effects:
        return f"{space}What is left, {what}, no listed effect explains within the noise."
    text = f"The model misses something that no listed effect explains within the noise: {what}."
    laws = answer.repaired.stand_ins
    if not laws:
        return text
    return f"{text} It behaves most like {listed(laws)}, whose law was not found to hold."


def _open(answer: Answer) -> str:
    """Say what may be missing, or how large it could be."""
    if answer.classes and answer.explanation_set:
        return (
            f"Something is missing, most likely {_options(answer)}, but the readings are too few "
            "to tell."
        )
    bounds = sorted(answer.undecided, key=lambda bound: -bound.upper95_deg)
    if not bounds:
        return answer.statement
    return (
        f"{difference_words(answer)}, but {readable(bounds[0].name)} could be as large as "
        f"{degrees(bounds[0].upper95_deg)}, above the tolerance of {degrees(answer.tolerance_deg)}."
    )


def _options(answer: Answer) -> str:
    """Explanations with their probabilities."""
    return " or ".join(
        f"{' + '.join(map(cause_in_words, (*each.effects, *each.without_name)))} "
        f"({100 * each.probability:.0f} %)"
        for each in answer.explanation_set
    )
