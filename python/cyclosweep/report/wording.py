"""Numbers and names as a test engineer reads them."""

import re
from collections.abc import Sequence
from typing import NamedTuple

from cyclosweep.result import Answer, Verdict
from cyclosweep.result.part import NORMAL_95
from cyclosweep.result.words import readable

NOTHING = "–"
"""What is printed where there is no number."""


ARCMIN = 60.0
"""Minutes of arc in a degree."""


class Tone(NamedTuple):
    """Colour of a verdict on the page and in the terminal."""

    page: str
    terminal: str


FOUND, OPEN = Tone("#0b6e4f", "green"), Tone("#8a5a00", "yellow")
UNKNOWN, FAULTY = Tone("#8a2be2", "magenta"), Tone("#a61b1b", "red")
VERDICTS: dict[Verdict, tuple[str, Tone]] = {
    "IDENTIFIED": ("Cause identified", FOUND),
    "AMBIGUOUS": ("More than one cause fits", OPEN),
    "MOSTLY_EXPLAINED": ("Causes found that explain most of it", FOUND),
    "UNKNOWN_PHYSICS": ("Cause outside the known effects", UNKNOWN),
    "NOTHING_MISSING": ("Nothing is missing from the model", FOUND),
    "INSUFFICIENT_DATA": ("The recording cannot tell", OPEN),
    "DATA_FAULT": ("The recording is faulty", FAULTY),
}
"""Verdict in plain words, and its colours."""
KNOWN_AND_MORE = "Known effects found, and something without a name"
"""The same where effects are named and something remains that has none."""


def words_of(verdict: Verdict, *, has_effects: bool) -> str:
    """Plain words of a verdict.

    Parameters
    ----------
    verdict : Verdict
    has_effects : bool
        Whether effects are named.

    Returns
    -------
    str
    """
    if verdict == "UNKNOWN_PHYSICS" and has_effects:
        return KNOWN_AND_MORE
    return VERDICTS[verdict][0]


def verdict_words(result: Answer) -> tuple[Verdict, str, Tone]:
    """Return verdict, its plain words and its colours."""
    words = words_of(result.verdict, has_effects=bool(result.effects))
    tone = VERDICTS[result.verdict][1]
    if result.verdict == "IDENTIFIED" and len(result.explanation_set) > 1:
        words = f"Most probable cause ({100 * result.explanation_set[0].probability:.0f} %)"
    return result.verdict, words, tone


_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float | None, digits: int = 3) -> str:
    """Write a number with so many significant digits and a true minus sign.

    Parameters
    ----------
    value : float or None
        The number; None and NaN are written as a dash.
    digits : int
        Significant digits.

    Examples
    --------
    >>> number(0.012345), number(-1234.5), number(0), number(None)
    ('0.0123', '−1234', '0', '–')
    >>> number(158_300.0), number(1.2e-7)
    ('158 000', '1.20×10⁻⁷')
    """
    if value is None:
        return NOTHING
    if value != value:
        return NOTHING
    if value in (float("inf"), float("-inf")):
        return "∞" if value > 0 else "−∞"
    if value == 0:
        return "0"
    magnitude = abs(value)
    if magnitude >= 1e7 or magnitude < 1e-4:
        mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
        return f"{mantissa}×10{str(int(power)).translate(_SUPERSCRIPT)}".replace("-", "−")
    if magnitude >= 10 ** (digits - 1):
        rounded = float(f"{value:.{digits}g}") if magnitude >= 1e5 else value
        grouped = f"{rounded:,.0f}" if magnitude >= 1e4 else f"{rounded:.0f}"
        return grouped.replace(",", " ").replace("-", "−")
    return f"{value:.{digits}g}".replace("-", "−")


def angle(value_deg: float | None, digits: int = 3) -> str:
    """Write an angle in deg and arcmin.

    Parameters
    ----------
    value_deg : float or None
        The angle [deg].
    digits : int
        Significant digits.

    Examples
    --------
    >>> angle(0.5)
    '0.5 deg (30 arcmin)'
    """
    if value_deg is None:
        return NOTHING
    return f"{number(value_deg, digits)} deg ({number(value_deg * ARCMIN, digits)} arcmin)"


def interval(ends: Sequence[float] | None, digits: int = 3) -> str:
    """Write an interval.

    Parameters
    ----------
    ends : sequence of two floats, or None
        Lower and upper end.
    digits : int
        Significant digits.

    Examples
    --------
    >>> interval([0.8, 1.0])
    '0.8 … 1'
    """
    if ends is None:
        return NOTHING
    return f"{number(ends[0], digits)} … {number(ends[1], digits)}"


def probability(value: float | None) -> str:
    """Write a p-value or a probability.

    Examples
    --------
    >>> probability(0.00001), probability(0.034)
    ('< 0.001', '0.034')
    >>> probability(1.0)
    '> 0.999'
    """
    if value is None:
        return NOTHING
    if 0 <= value < 0.001:
        return "< 0.001"
    return "> 0.999" if 0.999 < value <= 1 else number(value, 2)


def without_unit(name: str) -> str:
    """Write the name of a parameter in words, without its unit.

    Examples
    --------
    >>> without_unit("free_play_deg")
    'free play'
    """
    return readable(re.sub(r"_(deg|nm|s|c|nm_s_per_deg|deg_per_nm)$", "", name))


POOR = 3.0
"""Half width of an interval, over the estimate, beyond which a value is poorly determined."""


def with_error(estimate: float, std_error: float | None) -> str:
    """Write an estimate and the half width of its 95 % interval, as everywhere in a report.

    Parameters
    ----------
    estimate : float
        The estimate.
    std_error : float or None
        Its standard error; None where it is not known.

    Examples
    --------
    >>> with_error(1.04, 0.001), with_error(0.1, 3.0), with_error(2.0, None)
    ('1.04 ± 0.002', '0.1 (poorly determined)', '2')
    """
    if not std_error:
        return number(estimate, 4)
    text = number(estimate, 3 if NORMAL_95 * std_error > 0.01 * abs(estimate) else 4)
    if NORMAL_95 * std_error > POOR * abs(estimate) > 0:
        return f"{text} (poorly determined)"
    return f"{text} ± {number(NORMAL_95 * std_error, 2)}"
