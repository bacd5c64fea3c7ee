"""Whether a difference was found, and which named effects are smaller than matters, in words."""

from cyclosweep.result.answer import Answer
from cyclosweep.result.effects import FoundEffect
from cyclosweep.result.words import degrees, listed

RARE = 0.05
"""Probability by chance below which a difference cannot be said not to be there, though nothing is
named before one in a hundred."""


def difference_words(answer: Answer) -> str:
    """Say that no difference was found, or one that chance makes too often for a name.

    Parameters
    ----------
    answer : Answer
        The answer of a diagnosis in which nothing is said to be missing.

    Returns
    -------
    str
        Begin of a sentence.

    Examples
    --------
    >>> difference_words(Answer(verdict="INSUFFICIENT_DATA"))
    'No difference was found'
    """
    chance = answer.mismatch.p_value
    if chance is None or chance >= RARE:
        return "No difference was found"
    return f"What differs is no more than chance makes in {100 * chance:.2g} % of such recordings"


def below_tolerance(effect: FoundEffect, tolerance_deg: float | None) -> str:
    """Say that an effect is smaller than the tolerance; empty where it is not.

    Parameters
    ----------
    effect : FoundEffect
        The effect, with its size and interval.
    tolerance_deg : float or None
        Size below which an effect does not matter [deg]; None where there is none.

    Returns
    -------
    str
    """
    size = effect.size_deg
    if tolerance_deg is None or size.estimate >= tolerance_deg:
        return ""
    surely = "below" if size.ci95[1] < tolerance_deg else "probably below"
    return f"{surely} the tolerance of {degrees(tolerance_deg)}"


def tolerance_words(answer: Answer) -> str:
    """Say which named effects are smaller than the tolerance, and what that means.

    Parameters
    ----------
    answer : Answer
        The answer of a diagnosis.

    Returns
    -------
    str
        Sentences with a space before each; empty where all effects are larger.
    """
    groups: dict[str, list[str]] = {}
    for effect in answer.effects:
        if words := below_tolerance(effect, answer.tolerance_deg):
            groups.setdefault(words, []).append(effect.name)
    said = []
    for words, names in groups.items():
        verb = "is" if len(names) == 1 else "are"
        text = f"{listed(names)} {verb} {words}, the size below which an effect does not matter."
        said.append(f" {text[:1].upper()}{text[1:]}")
    return "".join(said)
