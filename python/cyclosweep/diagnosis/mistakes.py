"""Mistakes of units and sides, and what each makes of compliance and play."""

from dataclasses import dataclass
from math import log

from cyclosweep.recording.units import factor_of

NEAR = log(1.3)
"""How far (logarithm of the factor) a compliance may be from what a mistake gives."""
NEAR_PLAY = log(1.6)
"""The same of a free play, which differs more between specimens of one drive."""
RARER = log(1.1)
"""Disadvantage of a conversion made twice or the wrong way against a unit that was overlooked."""
RIVAL = log(1.12)
"""How much worse than the best a mistake may fit and still be named beside it."""


@dataclass(frozen=True)
class Mistake:
    """A mistake of reading and what it does.

    Attributes
    ----------
    text : str
        In words, with the factor.
    compliance, play : float
        Factors by which compliance and free play then come out.
    rare : bool
        Whether it is a conversion made twice or the wrong way.
    """

    text: str
    compliance: float
    play: float
    rare: bool = False


ANGLE_UNITS = {"arcmin": "60", "arcsec": "3600", "mrad": "17.45", "rad": "57.3", "turns": "360"}
"""Units that are read as degrees, with the factor in words."""
TORQUE_UNITS = {
    "lbf in": "8.85",
    "lbf ft": "1.356",
    "kgf m": "9.81",
    "kgf cm": "10.2",
    "N cm": "100",
    "N mm": "1000",
    "kN m": "1000",
}
"""Units that are read as newton metres, with the factor in words."""
TWICE = {"angle": ("rad", "turns"), "torque": ("lbf in", "lbf ft", "N mm")}
"""Units that are converted by mistake where a file is in deg and N m already."""


def mistakes(ratio: float) -> tuple[Mistake, ...]:
    """List the mistakes of units and sides that recordings have had.

    Parameters
    ----------
    ratio : float
        Ratio of the drive.

    Returns
    -------
    tuple of Mistake
    """
    degrees = {unit: factor_of(unit, "angle_deg") for unit in ANGLE_UNITS}
    newton_metres = {unit: factor_of(unit, "torque_nm") for unit in TORQUE_UNITS}
    found = [
        Mistake(
            f"the angle is in {unit} and was read as deg (factor {text})",
            1.0 / degrees[unit],
            1.0 / degrees[unit],
        )
        for unit, text in ANGLE_UNITS.items()
    ]
    found += [
        Mistake(
            f"the torque is in {unit} and was read as N m (factor {text})", newton_metres[unit], 1.0
        )
        for unit, text in TORQUE_UNITS.items()
    ]
    twice = "the {} was converted from {} and did not need it (factor {})"
    found += [
        Mistake(twice.format("angle", unit, ANGLE_UNITS[unit]), degrees[unit], degrees[unit], True)
        for unit in TWICE["angle"]
    ]
    found += [
        Mistake(
            twice.format("torque", unit, TORQUE_UNITS[unit]), 1.0 / newton_metres[unit], 1.0, True
        )
        for unit in TWICE["torque"]
    ]
    at = f"the ratio, {ratio:g}"
    found += [
        Mistake(f"measured at the output, and side says input (the ratio squared, {ratio**2:g})",
                ratio**-2, 1.0 / ratio),
        Mistake(f"measured at the input, and side says output (the ratio squared, {ratio**2:g})",
                ratio**2, ratio),
        Mistake(f"the angle was taken at the output and the torque at the input ({at})",
                1.0 / ratio, 1.0 / ratio),
        Mistake(f"the angle was taken at the input and the torque at the output ({at})",
                ratio, ratio),
        Mistake(f"the torque was taken at the output and the angle at the input ({at})",
                1.0 / ratio, 1.0),
        Mistake(f"the torque was taken at the input and the angle at the output ({at})",
                ratio, 1.0),
    ]  # fmt: skip
    return tuple(found)


def likely_mistakes(
    compliance: float, play: float | None, ratio: float, near: float = NEAR
) -> tuple[str, ...]:
    """Choose the mistakes by which compliance and, independently, play come near nominal.

    Parameters
    ----------
    compliance : float
        Measured compliance over the nominal one, above zero.
    play : float or None
        The same of the free play; None where the recording or the drive file does not tell it.
    ratio : float
        Ratio of the drive.
    near : float
        How far the compliance may be from what a mistake gives, as a logarithm.

    Returns
    -------
    tuple of str
        The likeliest first, with those that fit about as well; empty where none does.

    Examples
    --------
    >>> likely_mistakes(1 / 8.9, 1.02, 87.0)
    ('the torque is in lbf in and was read as N m (factor 8.85)',)
    >>> likely_mistakes(1.8, 9.0, 87.0)
    ()
    """
    ranked = []
    for mistake in mistakes(ratio):
        distance = abs(log(compliance / mistake.compliance))
        if distance > near:
            continue
        if play is not None and play > 0:
            apart = abs(log(play / mistake.play))
            if apart > NEAR_PLAY:
                continue
            distance = max(distance, 0.3 * apart)
        ranked.append((distance + (RARER if mistake.rare else 0.0), mistake.text))
    ranked.sort()
    return tuple(text for far, text in ranked if far <= ranked[0][0] + RIVAL)[:2]


def with_others(likely: tuple[str, ...], others: tuple[str, ...]) -> tuple[str, ...]:
    """Mistakes by two readings of a compliance of which either may be the right one.

    Parameters
    ----------
    likely, others : tuple of str
        Mistakes by each reading, the likelier first.

    Returns
    -------
    tuple of str
        The likeliest of each first, and two at most.

    Examples
    --------
    >>> with_others(("a", "b"), ("c",))
    ('a', 'c')
    """
    ranked = (*likely[:1], *others[:1], *likely[1:], *others[1:])
    return tuple(dict.fromkeys(ranked))[:2]
