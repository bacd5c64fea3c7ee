"""List of the cases of a challenge; any number of them is a balanced sample of all strata."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np

from cyclosweep_challenge.rig.aliens import ALIENS
from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.rig.specimen import VOCABULARY
from cyclosweep_challenge.trial.case import Case, make_case
from cyclosweep_challenge.trial.concealment import ConcealmentError
from cyclosweep_challenge.trial.tiers import LOUD_TIERS, Stratum

ATTEMPTS = 8


class Weighted(Protocol):
    """A stratum of any generator."""

    @property
    def weight(self) -> int:
        """Cases of this stratum among those of one full turn of the plan."""
        ...


S = TypeVar("S", bound=Weighted)

SMOOTH_AND_ABSORBED = (
    "contact_stiffening",
    "clearance_takeup",
    "overload_softening",
    "dial_eccentricity",
)

ALIAS_MENU = (
    ("rig_compliance", "rich"),
    ("torque_offset", "rich"),
    ("rig_compliance", "poor"),
    ("torque_offset", "poor"),
    ("transmission_error", "poor"),
    ("phase_dependent_compliance", "poor"),
)
"""Exact aliases: the first four of the calibration anywhere, the others at a single position."""

FRICTIONS = ("friction_hysteresis", "load_dependent_friction")
"""Dominant causes of loud recordings, in turn; what acts beside them is drawn."""
SIGMA_DEG, LOUD_SIGMA_DEG = 0.2, 0.05
"""Noise of one reading, smaller where the effects would be too large otherwise [deg]."""

ALIAS_AMPLITUDE = {"transmission_error": 0.5, "phase_dependent_compliance": 0.05}


def nothing_missing() -> list[Stratum]:
    """Strata of C6: every noise family, half on rich programmes and the rest on lesser ones."""
    return [
        Stratum("C6", programme, noise, (), weight)
        for noise in NOISES
        for programme, weight in (("rich", 4), ("middle", 1), ("poor", 2), ("oneway", 1))
    ]


def in_the_open() -> list[Stratum]:
    """Strata of C0: single effects over the range of visibility, on rich and poor programmes."""
    return [
        Stratum("C0", programme, "white", (d,), 6)
        for programme in ("rich", "poor")
        for d in (3.0, 4.0, 5.0, 6.0, 10.0, 20.0)
    ]


def concealed() -> list[Stratum]:
    """Strata of the tiers C1 to C5 and C7."""
    return [
        Stratum("C1", "rich", "white", (10.0,), 4),
        Stratum("C1", "poor", "white", (10.0,), 2),
        Stratum("C2", "rich", "white", (10.0,), 4),
        Stratum("C2", "poor", "white", (10.0,), 2),
        Stratum("C3", "rich", "white", (100.0, 10.0), 6),
        Stratum("C3", "rich", "white", (200.0, 20.0), 6),
        Stratum("C4", "rich", "white", (15.0, 15.0), 4),
        Stratum("C4", "rich", "white", (20.0, 20.0, 20.0), 2),
        Stratum("C5-alien", "rich", "white", (12.0,), 4),
        Stratum("C5-alien", "rich", "white", (20.0,), 4),
        Stratum("C5-removed", "rich", "white", (20.0,), 6),
        Stratum("C7", "rich", "white", (), 2),
    ]


def contest() -> list[Stratum]:
    """Strata on which opponents are compared: many with nothing missing, to tune them on."""
    nulls = [Stratum("C6", programme, "white", (), 18) for programme in ("rich", "poor")]
    return nulls + in_the_open()


def tuning() -> list[Stratum]:
    """Strata that add to those of C6 what the opponents' thresholds need."""
    return [
        Stratum("C6", programme, "white", (), weight)
        for programme, weight in (("rich", 2), ("poor", 5))
    ]


MIXES = {
    "contest": contest,
    "tuning": tuning,
    "all": lambda: nothing_missing() + in_the_open() + concealed(),
    "null": nothing_missing,
    "open": in_the_open,
    "concealed": concealed,
}
"""Mixes of strata that a challenge can be made of."""


@dataclass(frozen=True)
class Entry:
    """One case of a plan, not yet made.

    Attributes
    ----------
    number : int
        Place in the plan.
    stratum : Stratum
        Kind of the case.
    turn : int
        Number that rises by one from case to case of a stratum; causes take turns by it.
    seed : int
        Seed of the challenge.
    samples : int
        Readings wanted.
    """

    number: int
    stratum: Stratum
    turn: int
    seed: int
    samples: int = 3000

    @property
    def key(self) -> str:
        """Name of the case's folder; it says nothing about the case."""
        return f"case-{self.number:06d}"

    def case_seed(self, attempt: int) -> int:
        """Seed of the case at one attempt: unlike any of a small development seed."""
        state = np.random.SeedSequence([self.seed, self.number, attempt]).generate_state(2)
        return int(state[0]) << 31 | int(state[1]) >> 1


def make_plan(cases: int, seed: int, mix: str = "all", samples: int = 3000) -> list[Entry]:
    """Lay out a challenge.

    Parameters
    ----------
    cases : int
        Number of cases.
    seed : int
        Seed of the challenge; shuffles the strata within every turn of the plan.
    mix : {"all", "null", "open", "concealed", "contest", "tuning"}
        Which strata take part.
    samples : int
        Readings of each recording.

    Returns
    -------
    list of Entry
        A longer plan of the same seed and mix begins with the shorter one.

    Raises
    ------
    ValueError
        If the mix is unknown or the number is negative.
    """
    if mix not in MIXES:
        raise ValueError(f"mix: found {mix!r}, expected one of {', '.join(MIXES)}")
    if cases < 0:
        raise ValueError(f"cases: found {cases}, expected a whole number not below zero")
    return [
        Entry(number, stratum, turn, seed, samples)
        for number, (stratum, turn) in enumerate(laid_out(MIXES[mix](), cases, seed))
    ]


def laid_out(strata: Sequence[S], cases: int, seed: int) -> list[tuple[S, int]]:
    """Strata of a number of cases in shuffled turns, each with its number within the stratum.

    Parameters
    ----------
    strata : sequence
        Strata, each as often in one turn as its ``weight`` says.
    cases : int
        Number of cases.
    seed : int
        Seed of the order within every turn.

    Returns
    -------
    list of (stratum, int)
        A longer list of the same strata and seed begins with the shorter one.
    """
    one_turn = [k for k, stratum in enumerate(strata) for _ in range(stratum.weight)]
    # Each stratum begins with another cause, so that a short plan sees many of them.
    seen = [5 * k for k in range(len(strata))]
    found: list[tuple[S, int]] = []
    cycle = 0
    while len(found) < cases:
        order = np.random.default_rng([seed, 7, cycle]).permutation(one_turn)
        for k in order[: cases - len(found)]:
            found.append((strata[k], seen[k]))
            seen[k] += 1
        cycle += 1
    return found


def _candidates(entry: Entry) -> Sequence[str]:
    """Causes that take turns as the first cause of a stratum."""
    if entry.stratum.tier == "C1":
        return SMOOTH_AND_ABSORBED
    if entry.stratum.tier == "C5-alien":
        return ALIENS
    if entry.stratum.tier == "C8":
        return FRICTIONS
    return VOCABULARY


def _alias_case(entry: Entry) -> Case:
    """Make a case of C7."""
    name, programme = ALIAS_MENU[entry.turn % len(ALIAS_MENU)]
    fixed = {name: ALIAS_AMPLITUDE[name]} if name in ALIAS_AMPLITUDE else None
    return make_case(
        entry.case_seed(0),
        () if fixed else (name,),
        programme=programme,
        noise=entry.stratum.noise,
        samples=entry.samples,
        fixed_amplitudes=fixed,
        tier="C7",
    )


def _attempt(entry: Entry, attempt: int) -> Case:
    """Try to make the case with one draw of seed and causes."""
    stratum = entry.stratum
    seed = entry.case_seed(attempt)
    rng = np.random.default_rng([seed, 11])
    menu = _candidates(entry)
    # A cause that this programme cannot show gives way to the next after a few specimens.
    # The stride spreads those turns over the others instead of giving them all to one.
    first = menu[(entry.turn + 5 * (attempt // 3)) % len(menu)]
    others = [n for n in VOCABULARY if n != first]
    names = [first, *rng.choice(others, len(stratum.d) - 1, replace=False)]
    if stratum.tier == "C3":
        # The turn goes to the small effect; the large one is drawn.
        names.reverse()
    signs = [float(s) for s in rng.choice([-1.0, 1.0], len(names))]
    case = make_case(
        seed,
        [str(n) for n in names],
        stratum.d,
        stratum.programme,
        stratum.noise,
        samples=entry.samples,
        sigma_deg=LOUD_SIGMA_DEG if stratum.tier in LOUD_TIERS else SIGMA_DEG,
        resolution_deg=0.5 if stratum.tier == "C2" else 0.0,
        signs=signs,
        rivals=stratum.tier == "C0",
        pulling_apart=stratum.tier == "C4" and entry.turn % 2 == 0,
        tier=stratum.tier,
    )
    if stratum.tier == "C1" and case.truth["causes"][0]["absorbed"] < 0.7:
        raise ConcealmentError("the calibration hides less than seven tenths here")
    return case


def make_entry(entry: Entry) -> Case:
    """Make the case of one entry, drawing again where a cause cannot be had.

    Raises
    ------
    ConcealmentError
        If no draw can be concealed as the stratum wants.
    """
    stratum = entry.stratum
    if stratum.tier == "C7":
        case = _alias_case(entry)
    elif not stratum.d:
        case = make_case(
            entry.case_seed(0),
            (),
            programme=stratum.programme,
            noise=stratum.noise,
            samples=entry.samples,
            tier="C6",
        )
    else:
        case = _first_possible(entry)
    case.truth["stratum"] = stratum.name
    case.truth["key"] = entry.key
    if stratum.tier == "C5-removed":
        case.truth["removed"] = case.truth["effects"][0]
    return case


def _first_possible(entry: Entry) -> Case:
    """Return the first draw that can be concealed."""
    last: ConcealmentError | None = None
    for attempt in range(3 * ATTEMPTS):
        try:
            return _attempt(entry, attempt)
        except ConcealmentError as error:
            last = error
    raise ConcealmentError(f"{entry.key} ({entry.stratum.name}): {last}")
