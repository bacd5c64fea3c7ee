"""Angles, places and names in words."""

from collections.abc import Sequence

from cyclosweep.result.mismatch import Region


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
        parts.append(f"mesh position {region.crank_deg[0]:.4g} deg")
    return ", ".join(parts) or "everywhere"


def degrees(value: float | None) -> str:
    """Write an angle in deg and, where small, in arcmin.

    Parameters
    ----------
    value : float or None
        The angle [deg]; None where it is not known.
    """
    if value is None:
        return "an unknown angle"
    return f"{value:.3g} deg" + (f" ({60 * value:.2g} arcmin)" if abs(value) < 1.0 else "")


def readable(name: str) -> str:
    """Name of an effect in plain words."""
    return name.replace("_", " ")


PHRASES = {
    "one run apart": "one run that stands apart",
    "run offsets": "offsets from run to run",
    "position offsets": "offsets from position to position",
}
"""Shapes without a name that take no article, as a sentence puts them."""


def with_article(words: str) -> str:
    """Put "a" or "an" before some words."""
    return f"{'an' if words[:1] in 'aeiou' else 'a'} {words}"


def shape_in_words(shape: str) -> str:
    """A shape without a name in a sentence; where it has that of an effect, what it is like."""
    if shape in PHRASES:
        return PHRASES[shape]
    return f"something like {readable(shape)}" if "_" in shape else with_article(shape)


def listed(names: Sequence[str]) -> str:
    """Names in a row."""
    words = [readable(n) for n in names]
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]
