"""Shapes without a name in words; docs/diagnosis.md explains each."""

from cyclosweep.result.effects import Remainder
from cyclosweep.result.words import readable, with_article

PHRASES = {
    "torque and direction": "a misfit that depends on torque and direction of loading",
    "smooth odd curve": "a smooth curve of the torque that is alike both ways",
    "even curve": "a curve of the torque by which one way is unlike the other",
    "hysteresis": "a loop between loading and unloading",
    "loop by rate": "a loop that opens with the rate",
    "relaxation": "a slow change at holds and after reversals",
    "saturation at the end of the range": "a twist that stops growing at the end of the range",
    "bump at a load": "a bump at one load",
    "step of the angle": "a step of the angle",
    "slip within a run": "a step of the angle that lasts to the end of its run",
    "change of play": "a play that changes during the recording",
    "change of compliance": "a compliance that changes during the recording",
    "slow drift": "a slow drift of the zero",
    "drift within runs": "a drift of the zero that begins anew with each run",
    "wandering of the zero": "a zero that wanders",
    "one run apart": "one run that stands apart",
    "run offsets": "offsets from run to run",
    "compliance by run": "a compliance that changes from run to run",
    "position": "a misfit that goes with the position of the mesh",
    "position offsets": "offsets from position to position",
    "compliance by position": "a compliance that changes from position to position",
    "dial": "a misfit that goes with the angle on the dial",
    "hum": "a wave in time",
    "hum in proportion to torque": "a wave in time that grows with the torque",
    "ripple along the twist": "a wave along the twist",
}
"""What a shape looks like on a rig, by its name in ``diagnosis.json``."""


def shape_in_words(shape: str) -> str:
    """A shape without a name in a sentence; where it has that of an effect, what it is like.

    Examples
    --------
    >>> shape_in_words("loop by rate"), shape_in_words("viscous_drag")
    ('a loop that opens with the rate', 'something like viscous drag')
    """
    if shape in PHRASES:
        return PHRASES[shape]
    return f"something like {readable(shape)}" if "_" in shape else with_article(shape)


def shape_of_size(shape: str, size: str) -> str:
    """A shape without a name with its size, in a sentence.

    Parameters
    ----------
    shape : str
        Its name in ``diagnosis.json``.
    size : str
        How large it is, in words.

    Returns
    -------
    str

    Examples
    --------
    >>> shape_of_size("step of the angle", "1 deg"), shape_of_size("loop by rate", "1 deg")
    ('a step of the angle of 1 deg', 'a loop that opens with the rate, 1 deg')
    """
    words = shape_in_words(shape)
    return f"{words}{',' if {'that', 'which'} & set(words.split()) else ' of'} {size}"


def with_measure(rest: Remainder, size: str) -> str:
    """Size of what is left with the name of its measure.

    Parameters
    ----------
    rest : Remainder
        What is left.
    size : str
        Its size, in words.

    Returns
    -------
    str

    Examples
    --------
    >>> with_measure(Remainder(shape="hum", size_deg=1.0, measure="root mean square"), "1 deg")
    '1 deg rms'
    """
    if rest.measure == "root mean square":
        return f"{size} rms"
    return f"up to {size}" if rest.measure == "largest twist" else size


def size_left(rest: Remainder) -> str:
    """Size of what is left, as summary and statement give it."""
    return with_measure(rest, f"{rest.size_deg:.3g} deg")


def cause_in_words(name: str) -> str:
    """Name of an effect, or words for a shape without a name, as lists put it.

    Examples
    --------
    >>> cause_in_words("viscous_drag"), cause_in_words("hysteresis")
    ('viscous drag', 'a loop between loading and unloading')
    """
    return PHRASES.get(name, readable(name))
