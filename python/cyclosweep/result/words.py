"""Angles, places and names in words."""

from collections.abc import Sequence

from cyclosweep.result.mismatch import Region

FALLEN = 0.95
"""Error over the one before, below which it has fallen."""


def place_of(regions: Sequence[Region]) -> str:
    """Where the strongest region lies, in words."""
    if not regions:
        return "no single place"
    region = regions[0]
    parts = []
    if region.torque_nm is not None:
        parts.append(f"{region.torque_nm[0]:.3g} to {region.torque_nm[1]:.3g} N m")
    if region.direction is not None:
        parts.append(region.direction)
    if region.run is not None:
        first, last = region.run
        parts.append(f"run {first}" if first == last else f"runs {first} to {last}")
    if region.readings is not None:
        parts.append(f"readings {region.readings[0]} to {region.readings[1]}")
    if region.time_s is not None:
        parts.append(f"t = {region.time_s[0]:.5g} to {region.time_s[1]:.5g} s")
    if region.crank_deg is not None:
        first_deg, last_deg = (f"{place:.4g}" for place in region.crank_deg)
        one = first_deg == last_deg
        where = f"position {first_deg}" if one else f"positions {first_deg} to {last_deg}"
        parts.append(f"mesh {where} deg")
    return ", ".join(parts) or "everywhere"


MOST_DIGITS = 6
"""Significant digits that are not exceeded, however narrow an interval is."""


def telling_digits(estimate: float, ends: Sequence[float] | None, least: int = 3) -> int:
    """Significant digits with which an estimate and the ends of its interval are told apart.

    Parameters
    ----------
    estimate : float
        The estimate.
    ends : sequence of two floats, or None
        Lower and upper end; None where there is no interval.
    least : int
        Digits that are always written.

    Returns
    -------
    int

    Examples
    --------
    >>> telling_digits(1.6538, (1.6502, 1.6573)), telling_digits(0.9, (0.8, 1.0))
    (4, 3)
    """
    if ends is None or ends[0] == ends[1]:
        return least
    values = {estimate, *ends}
    for digits in range(least, MOST_DIGITS):
        if len({f"{value:.{digits}g}" for value in values}) == len(values):
            return digits
    return MOST_DIGITS


def degrees(value: float | None, digits: int = 3) -> str:
    """Write an angle in deg and, where small, in arcmin.

    Parameters
    ----------
    value : float or None
        The angle [deg]; None where it is not known.
    digits : int
        Significant digits; in arcmin one less.
    """
    if value is None:
        return "an unknown angle"
    small = f" ({60 * value:.{digits - 1}g} arcmin)" if abs(value) < 1.0 else ""
    return f"{value:.{digits}g} deg{small}"


def falls(before: float | None, after: float | None) -> bool:
    """Whether an error falls by so much that one may say so; not known counts as falling.

    Parameters
    ----------
    before, after : float or None
        Errors [deg].
    """
    return before is None or after is None or after < FALLEN * before


def readable(name: str) -> str:
    """Name of an effect, or of another entry of a table, in words.

    Examples
    --------
    >>> readable("overload_softening")
    'overload softening'
    """
    return name.replace("_", " ")


def with_article(words: str) -> str:
    """Put "a" or "an" before some words."""
    return f"{'an' if words[:1] in 'aeiou' else 'a'} {words}"


def listed(names: Sequence[str]) -> str:
    """Names in a row."""
    words = [readable(n) for n in names]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]
