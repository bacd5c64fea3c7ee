"""Units that rigs write: what they measure, and their factor to the canonical unit."""

import math
import re
from dataclasses import dataclass
from typing import Literal

__all__ = [
    "CANONICAL_UNITS",
    "MEANINGS",
    "QUANTITIES",
    "UNIT_EXAMPLES",
    "Kind",
    "Unit",
    "factor_of",
    "find_unit",
    "split_name",
    "unknown_unit",
]

Kind = Literal["torque", "force", "current", "angle", "counts", "time", "temperature"]

INCH_M = 0.0254
"""One inch [m], by definition."""
POUND_FORCE_N = 4.4482216152605
"""One pound-force [N]: 0.45359237 kg times standard gravity of 9.80665 m/s2, by definition."""
KILOPOND_N = 9.80665
"""One kilogram-force [N], by definition."""

QUANTITIES: dict[str, tuple[Kind, ...]] = {
    "torque_nm": ("torque", "force", "current"),
    "angle_deg": ("angle", "counts"),
    "time_s": ("time",),
    "run": (),
    "crank_deg": ("angle", "counts"),
    "temperature_c": ("temperature",),
}
"""What each canonical column may be computed from, first what it is itself."""

CANONICAL_UNITS = {
    "torque_nm": "N m",
    "angle_deg": "deg",
    "time_s": "s",
    "crank_deg": "deg",
    "temperature_c": "degC",
}
"""Unit of each canonical column that has one."""

MEANINGS = {
    "torque_nm": "the torque",
    "angle_deg": "the angle",
    "time_s": "the clock",
    "run": "the run",
    "crank_deg": "the position of the mesh",
    "temperature_c": "the temperature",
}
"""Canonical columns in words, for messages."""

UNIT_EXAMPLES = {
    "torque_nm": "'N m', 'lbf in', 'kN', 'kg' or 'g' with lever_arm_m, 'A' with nm_per_a",
    "angle_deg": "'deg', 'mrad', 'arcmin', 'turns', 'counts' with counts_per_turn",
    "time_s": "'s', 'ms', 'min'",
    "crank_deg": "'deg', 'turns', 'counts' with counts_per_turn",
    "temperature_c": "'degC', 'K', 'degF'",
}
"""Units for messages."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit and its way to the canonical one.

    Attributes
    ----------
    kind : str
        What it measures.
    factor : float
        Canonical units in one of it: N m, N, A, deg, counts, s or degC.
    offset : float
        Added after multiplying, as for degF [degC].
    """

    kind: Kind
    factor: float
    offset: float = 0.0


_TORQUE = {
    "n m": 1.0,
    "nm": 1.0,
    **dict.fromkeys(
        ("newton meter", "newton metre", "newton meters", "newton metres", "newtonmeter"), 1.0
    ),
    "n cm": 1e-2,
    "ncm": 1e-2,
    "n mm": 1e-3,
    "nmm": 1e-3,
    "mn m": 1e-3,
    "mnm": 1e-3,
    **dict.fromkeys(("µn m", "µnm", "μn m", "μnm", "un m", "unm"), 1e-6),
    **dict.fromkeys(("dn m", "dnm"), 1e-1),
    **dict.fromkeys(("dan m", "danm"), 10.0),
    "cn m": 1e-2,
    "cnm": 1e-2,
    "kn m": 1e3,
    "knm": 1e3,
    "kn mm": 1.0,
    "knmm": 1.0,
    **dict.fromkeys(
        ("lb in", "lbf in", "in lb", "in lbf", "lbin", "inlb", "lbs in", "in lbs", "inlbs",
         "lbfin", "inlbf", "pound inch", "inch pound", "pound inches", "inch pounds"),
        POUND_FORCE_N * INCH_M,
    ),
    **dict.fromkeys(
        ("lb ft", "lbf ft", "ft lb", "ft lbf", "lbft", "ftlb", "lbs ft", "ft lbs", "ftlbs",
         "lbfft", "ftlbf", "pound foot", "foot pound", "pound feet", "foot pounds", "foot lbs"),
        POUND_FORCE_N * 12 * INCH_M,
    ),
    **dict.fromkeys(
        ("oz in", "ozf in", "in oz", "in ozf", "ozin", "inoz"), POUND_FORCE_N * INCH_M / 16
    ),
    **dict.fromkeys(
        ("kgf m", "kp m", "kgfm", "kpm", "kg m", "kgm", "m kg", "mkg", "m kp", "mkp"), KILOPOND_N
    ),
    **dict.fromkeys(("kgf cm", "kp cm", "kgfcm", "kg cm"), KILOPOND_N / 100),
}  # fmt: skip
_FORCE = {
    "n": 1.0,
    "newton": 1.0,
    "kn": 1e3,
    "mn": 1e-3,
    **dict.fromkeys(("lbf", "lb", "lbs"), POUND_FORCE_N),
    # A weight on a lever is written down as its mass.
    **dict.fromkeys(("kgf", "kp", "kg", "kgs"), KILOPOND_N),
    **dict.fromkeys(("gf", "g"), KILOPOND_N / 1000),
}
_CURRENT = {"a": 1.0, "amp": 1.0, "amps": 1.0, "ampere": 1.0, "ma": 1e-3}
_ANGLE = {
    **dict.fromkeys(("deg", "degs", "degree", "degrees", "°", "grad", "altgrad"), 1.0),
    "mdeg": 1e-3,
    **dict.fromkeys(("rad", "radian", "radians"), math.degrees(1.0)),
    "mrad": math.degrees(1e-3),
    **dict.fromkeys(("urad", "µrad", "μrad"), math.degrees(1e-6)),
    **dict.fromkeys(
        ("arcmin", "arc min", "'", "′", "arcmins", "arcminute", "arcminutes", "arc minute",
         "arc minutes", "minutes of arc", "bogenmin", "bogenminute", "bogenminuten",
         "winkelminute", "winkelminuten"),
        1 / 60,
    ),
    **dict.fromkeys(
        ("arcsec", "arc sec", '"', "″", "arcsecs", "arcsecond", "arcseconds", "arc second",
         "arc seconds", "seconds of arc", "bogensek", "bogensekunde", "bogensekunden",
         "winkelsekunde", "winkelsekunden"),
        1 / 3600,
    ),
    **dict.fromkeys(
        ("rev", "revs", "revolution", "revolutions", "turn", "turns", "rot", "u", "umdr",
         "umdrehung", "umdrehungen"),
        360.0,
    ),
    **dict.fromkeys(("gon", "gons", "neugrad"), 0.9),
}  # fmt: skip
_COUNTS = dict.fromkeys(
    ("count", "counts", "cts", "tick", "ticks", "inc", "incs", "increments", "ink", "inkr",
     "inkremente", "qc"),
    1.0,
)  # fmt: skip
_TIME = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds", "sek", "sekunde", "sekunden"), 1.0),
    **dict.fromkeys(("ms", "msec", "millisecond", "milliseconds", "millisekunden"), 1e-3),
    **dict.fromkeys(("us", "µs", "μs", "usec"), 1e-6),
    "ns": 1e-9,
    **dict.fromkeys(("min", "mins", "minute", "minutes", "minuten"), 60.0),
    **dict.fromkeys(("h", "hr", "hour", "hours", "std", "stunde", "stunden"), 3600.0),
    **dict.fromkeys(("d", "day", "days", "tag", "tage"), 86400.0),
}
_TEMPERATURE: dict[str, tuple[float, float]] = {
    **dict.fromkeys(("c", "degc", "deg c", "°c", "° c", "℃", "celsius"), (1.0, 0.0)),
    **dict.fromkeys(("k", "kelvin"), (1.0, -273.15)),
    **dict.fromkeys(("f", "degf", "deg f", "°f", "° f", "fahrenheit"), (5 / 9, -160 / 9)),
}
_SIMPLE: dict[Kind, dict[str, float]] = {
    "torque": _TORQUE,
    "force": _FORCE,
    "current": _CURRENT,
    "angle": _ANGLE,
    "counts": _COUNTS,
    "time": _TIME,
}

OTHER_UNITS = frozenset(
    ("%", "V", "mV", "mV/V", "mm", "µm", "rpm", "U/min", "1/min", "bar", "Hz", "W", "kW")
)
"""Units of columns that a recording may have besides its own, none of a torque, angle or clock."""

_IN_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[({<](?P<unit>[^\[\](){}<>]*)[\])}>]\s*$")
_AFTER_SIGN = re.compile(r"^(?P<name>.*?)(?:\s*/\s*|,\s*|\s+in\s+)(?P<unit>[^/,]+)$")
_LAST_WORDS = re.compile(r"^(?P<name>.*?[^_\s])[_\s]+(?P<unit>[^_\s]+(?:[_\s][^_\s]+)?)$")


def find_unit(text: str, column: str | None = None) -> Unit | None:
    """Recognise a unit; blanks, dots, dashes and case between its parts do not matter.

    Parameters
    ----------
    text : str
        As written, for example ``"lb-in"`` or ``"[mrad]"``.
    column : str, optional
        Canonical column it belongs to; without it every kind is tried, torque first.

    Returns
    -------
    Unit or None
        None where it is no unit of such a column.

    Examples
    --------
    >>> find_unit("kN·m")
    Unit(kind='torque', factor=1000.0, offset=0.0)
    >>> find_unit("lbf", "angle_deg") is None
    True
    """
    plain = text.strip().strip("[](){}<>").strip()
    if plain.startswith("MN"):  # mega or, in capitals throughout, milli: a factor of 10^9
        return None
    tidy = " ".join(re.sub(r"[·⋅∙•*.\-_×]", " ", plain).split())
    kinds = QUANTITIES[column] if column else (*_SIMPLE, "temperature")
    for kind in kinds:
        for spelt in (tidy.casefold(), plain.casefold()):
            if kind == "temperature":
                if spelt in _TEMPERATURE:
                    return Unit(kind, *_TEMPERATURE[spelt])
            elif spelt in _SIMPLE[kind]:
                return Unit(kind, _SIMPLE[kind][spelt])
    return None


def factor_of(text: str, column: str) -> float:
    """Canonical units in one of a unit that is known.

    Parameters
    ----------
    text : str
        The unit.
    column : str
        Canonical column it belongs to.

    Returns
    -------
    float

    Raises
    ------
    KeyError
        It is no unit of such a column.

    Examples
    --------
    >>> factor_of("turns", "angle_deg")
    360.0
    """
    unit = find_unit(text, column)
    if unit is None:
        raise KeyError(text)
    return unit.factor


def split_name(header: str) -> tuple[str, str | None, bool]:
    """Divide a header such as ``Torque [lb in]`` into its name and its unit.

    Parameters
    ----------
    header : str
        Name of a column as the file has it.

    Returns
    -------
    name : str
        Without the unit.
    unit : str or None
        As written; None where none is recognised.
    explicit : bool
        Whether it stands in brackets, which nothing but a unit does.

    Examples
    --------
    >>> split_name("Torque [lb in]")
    ('Torque', 'lb in', True)
    >>> split_name("twist_mrad")
    ('twist', 'mrad', False)
    """
    if match := _IN_BRACKETS.match(header):
        # What stands in them is no part of a name: "Zeit [1/100 s]" is not in seconds.
        known = find_unit(match["unit"])
        return (match["name"], match["unit"].strip(), True) if known else (header, None, False)
    if (match := _AFTER_SIGN.match(header)) and find_unit(match["unit"]):
        return match["name"], match["unit"].strip(), False
    if match := _LAST_WORDS.match(header):
        words = re.split(r"[_\s]+", header)
        for count in (2, 1):
            unit = " ".join(words[-count:])
            if len(words) > count and (known := find_unit(unit)):
                # A bare letter after a name is an index or an axis, unless it is one of a clock.
                if len(unit) == 1 and unit.casefold() not in "sh":
                    break
                return " ".join(words[:-count]), unit, False
    return header, None, False


def unknown_unit(header: str) -> str | None:
    """Find a unit that a name states in brackets and that is not known.

    In square brackets stands a unit, a dash for none, or the number of an element; in others also
    a word about the column, as in ``Torque (filtered)``.

    Parameters
    ----------
    header : str
        Name of a column as the file has it.

    Returns
    -------
    str or None
        As written; None where none is stated, or one that is known.

    Examples
    --------
    >>> unknown_unit("Torque [10 Nm]"), unknown_unit("Torque (mV/V)")
    ('10 Nm', 'mV/V')
    >>> unknown_unit("Torque [Nm]"), unknown_unit("Torque (filtered)"), unknown_unit("Torque[2]")
    (None, None, None)
    """
    match = _IN_BRACKETS.match(header)
    if match is None:
        return None
    text = match["unit"].strip()
    if find_unit(text) or text.isdigit() or not text.strip("-– "):
        return None
    is_square = header.rstrip().endswith("]")
    return text if is_square or text in OTHER_UNITS or text[0].isdigit() else None
