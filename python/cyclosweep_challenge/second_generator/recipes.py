"""What each tier asks of a case: causes, visibility, programme, columns and sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cyclosweep_challenge.second_generator.laws import strangers
from cyclosweep_challenge.second_generator.laws.catalogue import (
    LIBRARY_LIKE,
    VOCABULARY,
    laws_of,
)
from cyclosweep_challenge.second_generator.laws.law import Law
from cyclosweep_challenge.second_generator.sensor import Sensor

TIERS = {
    "nothing": "nothing missing, noise correlated up to 0.99",
    "single": "one effect at a stated visibility",
    "C8": "loud: visibility 100 to 3,000, one to four effects, friction at real sizes",
    "C9": "few readings by hand on a dial of half a degree, no clock",
    "stranger": "a cause outside the vocabulary, loud or faint",
    "deleted": "an effect whose entry is to be taken out of the library, loud or faint",
}
FRICTIONS = ("friction_hysteresis", "load_dependent_friction")
HAS = {
    "rich": frozenset({"clock", "runs", "crank", "temperature", "input"}),
    "poor": frozenset({"clock", "runs", "input"}),
    "weights": frozenset({"input"}),
}
"""What a programme has by which laws can be told; the measured shaft may take ``input`` away."""
SINGLE_D = (10.0, 20.0, 60.0)
AUTOCORRELATIONS = (0.0, 0.5, 0.9, 0.95, 0.97, 0.99)
OTHER_DRIVE = 0.15
"""Part of the cases on the drive that has a drive file and is measured at its output."""

LOUD = (100.0, 3000.0)
"""Visibility of the dominant cause of a loud case [-]."""
LOUD_PER_SHARE = 6000.0
"""Least visibility over the share of friction: below, noise beyond half a degree."""
PLAY_READINGS = 0.15
"""Part of the cases whose bench records readings within the play too."""


@dataclass(frozen=True)
class Recipe:
    """One case before it is made.

    Attributes
    ----------
    tier : str
        One of ``TIERS``.
    laws : tuple of Law
        Laws at work, the dominant one first.
    d : tuple of float
        Wanted visibility of each [-].
    share : float
        Share of the largest torque that a dominant friction takes; zero where the visibility is
        reached by size and not by noise [-].
    programme : str
        Kind of load programme.
    rows : int
        Readings wanted.
    columns : frozenset of str
        Optional columns to keep: clock, crank, temperature.
    sensor : Sensor
        Noise; its standard deviation is changed where a ``share`` is given.
    other_drive : bool
        Whether the drive is the one with a drive file.
    play_readings : bool
        Whether the bench also records readings within the play.
    removed : str
        Effect to be taken out of the library before the diagnosis; empty for none.
    """

    tier: str
    laws: tuple[Law, ...]
    d: tuple[float, ...]
    share: float
    programme: str
    rows: int
    columns: frozenset[str]
    sensor: Sensor
    other_drive: bool
    play_readings: bool = False
    removed: str = ""

    @property
    def stratum(self) -> str:
        """Name of the kind of case in tables."""
        if not self.laws:
            return f"{self.tier}/{self.programme}/rho={self.sensor.autocorrelation:g}"
        if self.tier == "C8":
            family = self.family or "no friction"
            return f"C8/{family}/effects={len(self.laws)}"
        loud = "loud" if self.d[0] >= 100.0 else "faint"
        label = f"d={self.d[0]:g}" if self.tier == "single" else loud
        label += "+friction" if len(self.laws) > 1 else ""
        return f"{self.tier}/{self.programme}/{label}"

    @property
    def family(self) -> str:
        """Family of a dominant friction: the library's, another, or empty for none."""
        if not self.laws or self.laws[0].effect not in FRICTIONS:
            return ""
        return "library" if self.laws[0].name in LIBRARY_LIKE else "other"


def _law(rng: np.random.Generator, effect: str, has: frozenset[str], turn: int = -1) -> Law | None:
    """A law of an effect that the programme can show; in turn, or by chance where turn is -1."""
    menu = [law for law in laws_of(effect) if law.needs <= has]
    if not menu:
        return None
    return menu[turn % len(menu)] if turn >= 0 else menu[int(rng.integers(len(menu)))]


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _columns(rng: np.random.Generator, programme: str, laws: tuple[Law, ...]) -> frozenset[str]:
    """Columns a recording keeps: all that its laws need, others by chance."""
    needed = frozenset().union(*(law.needs for law in laws)) if laws else frozenset[str]()
    if programme == "weights":
        return frozenset()
    offered = {"clock", "crank", "temperature"} if programme == "rich" else {"clock"}
    return frozenset(c for c in sorted(offered) if c in needed or rng.uniform() < 0.75)


def _sensor(rng: np.random.Generator, scale: float, correlation: float = 0.0) -> Sensor:
    """A bench's sensor: noise in parts of the twist at the rated torque.

    A quarter have heavy tails, a fifth a dial whose division is half to three times the noise,
    and a fifth drift by a twentieth of the noise, which nobody can see.
    """
    tails = float(rng.choice([0.0, 0.0, 0.0, 4.0]))
    sigma = scale * _log_uniform(rng, 0.002, 0.015)
    division = float(f"{sigma * rng.uniform(0.5, 3.0):.1g}") if rng.uniform() < 0.2 else 0.0
    drift = 0.05 * sigma * float(rng.choice([-1.0, 1.0])) if rng.uniform() < 0.2 else 0.0
    return Sensor(sigma, correlation, tails, division, drift)


def _loud(
    rng: np.random.Generator, turn: int, has: frozenset[str]
) -> tuple[tuple[Law, ...], float]:
    """Laws of a loud case, the dominant one first, and the share of its friction."""
    count = 1 + turn % 4
    share = 0.0
    if turn % 10 < 7:
        effect = FRICTIONS[0] if turn % 10 < 5 else FRICTIONS[1]
        first = _law(rng, effect, has)
        if turn % 10 in (0, 1, 2, 5):
            first = next(law for law in laws_of(effect) if law.name in LIBRARY_LIKE)
        share = _log_uniform(rng, 0.005, 0.25)
    else:
        rest = [e for e in VOCABULARY if e not in FRICTIONS]
        first = _law(rng, rest[(turn // 10 * 3 + turn % 10 - 7) % len(rest)], has)
    if first is None:
        first = laws_of("contact_stiffening")[0]
    # Two laws for the same motion against friction are one effect to any observer.
    left = [e for e in VOCABULARY if e != first.effect]
    laws = [first]
    for effect in rng.permutation(left):
        law = _law(rng, str(effect), has)
        if law is not None and len(laws) < count:
            laws.append(law)
    return tuple(laws), share


def draw_recipe(
    tier: str, turn: int, rng: np.random.Generator, rows: int, twist_deg: float
) -> Recipe:
    """Draw the recipe of one case.

    Parameters
    ----------
    tier : str
        One of ``TIERS``.
    turn : int
        Number of the case; effects, laws and visibilities take turns by it.
    rng : numpy.random.Generator
        Source of chance.
    rows : int
        Readings wanted; a case of few readings draws its own.
    twist_deg : float
        Elastic twist of the reference drive at its rated torque [deg].

    Raises
    ------
    ValueError
        If the tier is unknown.
    """
    if tier not in TIERS:
        raise ValueError(f"tier: found {tier!r}, expected one of {', '.join(TIERS)}")
    programme = "rich" if turn % 4 != 3 else "poor"
    other = bool(rng.uniform() < OTHER_DRIVE) and tier != "C9"
    has = HAS[programme] - ({"input"} if other else set())
    correlation, share, removed = 0.0, 0.0, ""
    laws: tuple[Law, ...] = ()
    d: tuple[float, ...] = ()
    if tier == "nothing":
        correlation = AUTOCORRELATIONS[turn % len(AUTOCORRELATIONS)]
        programme = ("rich", "poor", "rich", "weights")[turn // len(AUTOCORRELATIONS) % 4]
        rows = min(rows, 60) if programme == "weights" else rows
    elif tier == "C8":
        programme, has = "rich", HAS["rich"] - ({"input"} if other else set())
        laws, share = _loud(rng, turn, has)
        top = _log_uniform(rng, max(LOUD[0], LOUD_PER_SHARE * share), LOUD[1])
        d = (top, *(max(top * _log_uniform(rng, 0.02, 0.5), 15.0) for _ in laws[1:]))
        correlation = float(rng.choice([0.0, 0.0, 0.5, 0.9]))
    elif tier == "C9":
        programme, rows = "weights", int(rng.integers(12, 61))
        menu = [
            "friction_hysteresis",
            "load_dependent_friction",
            "contact_stiffening",
            "overload_softening",
            "load_asymmetry",
            "clearance_takeup",
        ]
        if turn % 3:
            found = _law(rng, menu[turn // 3 * 2 % 6 + turn % 3 - 1], HAS["weights"])
            laws = (found,) if found else ()
            d = (_log_uniform(rng, 4.0, 60.0),) if laws else ()
    elif tier == "stranger":
        menu_s = [law for law in strangers.LAWS if law.needs <= has]
        laws = (menu_s[turn % len(menu_s)],)
        d = (_log_uniform(rng, 150.0, 1000.0) if turn % 2 else _log_uniform(rng, 12.0, 30.0),)
        friction = _law(rng, FRICTIONS[0], has)
        if turn % 3 == 2 and friction is not None:
            laws, d = (*laws, friction), (*d, _log_uniform(rng, 30.0, 300.0))
    else:
        effect = VOCABULARY[turn % len(VOCABULARY)]
        law = _law(rng, effect, has, turn // len(VOCABULARY))
        if law is None:
            programme, has = "rich", HAS["rich"] - ({"input"} if other else set())
            law = _law(rng, effect, has, turn // len(VOCABULARY))
        if law is None:
            other, has = False, HAS["rich"]
            law = _law(rng, effect, has, turn // len(VOCABULARY)) or laws_of(effect)[0]
        laws, d = (law,), (SINGLE_D[(turn + turn // len(VOCABULARY)) % len(SINGLE_D)],)
        if tier == "deleted":
            removed = effect
            d = (_log_uniform(rng, 150.0, 1000.0) if turn % 2 else _log_uniform(rng, 15.0, 30.0),)
    sensor = _sensor(rng, twist_deg, correlation)
    if tier == "C9" or (tier == "nothing" and programme == "weights"):
        sensor = Sensor(float(rng.uniform(0.1, 0.3)), resolution_deg=0.5)
        other = False
    columns = _columns(rng, programme, laws)
    in_play = programme != "weights" and bool(rng.uniform() < PLAY_READINGS)
    return Recipe(tier, laws, d, share, programme, rows, columns, sensor, other, in_play, removed)
