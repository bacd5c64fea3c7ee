"""What a record is made of, and in which steps it grows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields

from cyclosweep_challenge.runner.run import plan_of
from cyclosweep_challenge.trial.plan import Entry

STEPS = 25
COLOURED = "coloured"
"""Part in which the noise is correlated: for the contest alone, apart from all other figures."""
CORRELATED = "ar0.6"
"""Family of noise of the parts in which it is correlated."""


@dataclass(frozen=True)
class Part:
    """One of the challenges that make up a record.

    Attributes
    ----------
    name : str
        Name of its folder.
    what : str
        What its recordings are, in words.
    cases : int
        Cases in all.
    offset : int
        What is added to the record's seed, so that no two parts share specimens.
    costly : int
        Recordings of each stratum that the costly opponents see.
    mix : str
        Strata, of ``plan.MIXES``; of its name if absent.
    noise : str
        Family of noise in place of white noise.
    programme : str
        Programme in place of those of the strata; theirs if absent.
    """

    name: str
    what: str
    cases: int
    offset: int
    costly: int
    mix: str = ""
    noise: str = "white"
    programme: str = ""

    def plan(self, seed: int, last: int, samples: int) -> list[Entry]:
        """Cases of this part up to one, in a record of this seed and so many readings."""
        about = {
            "seed": seed + self.offset,
            "mix": self.mix or self.name,
            "samples": samples,
            "noise": self.noise,
            "programme": self.programme,
        }
        return plan_of(about, last)

    def slice(self, step: int, steps: int) -> tuple[int, int]:
        """First case of a step, and the first one after it."""
        return self.cases * step // steps, self.cases * (step + 1) // steps


@dataclass(frozen=True)
class Size:
    """How large a record is.

    Attributes
    ----------
    null, opened, concealed, tuning, coloured : int
        Cases of each part.
    rich_open : int
        Further single effects in the open, all on rich programmes.
    rich_null, poor_null, coloured_rich_null, coloured_poor_null : int
        Cases with nothing missing on one programme under one noise, for the opponents'
        thresholds; a record that is more than the contest has its own in ``null`` and ``tuning``.
    costly_nulls, costly_open : int
        Recordings of each programme with nothing missing, and of each visibility and programme,
        that the costly opponents see.
    samples : int
        Readings of each recording.
    steps : int
        Steps in which all parts grow together.
    programme : str
        Programme of all single effects of the first parts, in place of both.
    """

    null: int = 10_000
    opened: int = 3_600
    concealed: int = 966
    tuning: int = 350
    coloured: int = 600
    rich_open: int = 0
    rich_null: int = 0
    poor_null: int = 0
    coloured_rich_null: int = 0
    coloured_poor_null: int = 0
    costly_nulls: int = 300
    costly_open: int = 60
    samples: int = 3_000
    steps: int = STEPS
    programme: str = ""

    @property
    def is_contest(self) -> bool:
        """Whether this is the contest alone, without the rest of the proof."""
        rest = self.null + self.concealed + self.tuning
        return rest == 0 and any(part.cases for part in self._parts_of_a_contest())

    def parts(self) -> list[Part]:
        """Parts in the order in which a step runs through them."""
        shared = self.costly_nulls * 2 // 3
        programmes = f"{self.programme or 'rich and poor'} programmes"
        return [
            Part(
                "null",
                "nothing missing, ten families of noise and nuisance",
                self.null,
                0,
                shared,
            ),
            Part(
                "open",
                f"single effects in the open, d = 3 to 20, {programmes}",
                self.opened,
                1,
                self.costly_open,
                programme=self.programme,
            ),
            Part("concealed", "the tiers C1 to C5 and C7", self.concealed, 2, 0),
            Part(
                "tuning",
                "more with nothing missing, for the opponents' thresholds",
                self.tuning,
                3,
                self.costly_nulls - shared,
            ),
            Part(
                COLOURED,
                "single effects under correlated noise, for the contest with the opponents"
                + (f", {programmes}" if self.programme else ""),
                self.coloured,
                4,
                self.coloured,
                mix="open",
                noise=CORRELATED,
                programme=self.programme,
            ),
            *self._parts_of_a_contest(),
        ]

    def _parts_of_a_contest(self) -> list[Part]:
        """Parts of one programme and noise, which only a record that is the contest alone has."""
        nulls = (
            ("rich_null", self.rich_null, "rich", "white"),
            ("poor_null", self.poor_null, "poor", "white"),
            ("coloured_rich_null", self.coloured_rich_null, "rich", CORRELATED),
            ("coloured_poor_null", self.coloured_poor_null, "poor", CORRELATED),
        )
        return [
            *(
                Part(
                    name,
                    f"nothing missing, {programme} programme, {noise} noise",
                    cases,
                    5 + k,
                    self.costly_nulls if noise == "white" else cases,
                    mix="tuning",
                    noise=noise,
                    programme=programme,
                )
                for k, (name, cases, programme, noise) in enumerate(nulls)
            ),
            Part(
                "rich_open",
                "further single effects in the open, rich programme, white noise",
                self.rich_open,
                9,
                0,
                mix="open",
                programme="rich",
            ),
        ]

    def slices(self) -> Iterator[tuple[Part, int, int]]:
        """Every slice with its first case and the first one after it, all parts in turn."""
        for step in range(self.steps):
            for part in self.parts():
                first, last = part.slice(step, self.steps)
                if last > first:
                    yield part, first, last


COUNTS = tuple(field.name for field in fields(Size) if isinstance(field.default, int))
"""What is counted of a record's size: all but the programme."""
FULL = Size()
SUBSET = Size(
    null=480,
    opened=108,
    concealed=69,
    tuning=105,
    coloured=0,
    costly_nulls=24,
    costly_open=3,
    steps=6,
)
"""About ten minutes on two cores."""
CONTEST = Size(
    null=0,
    opened=1_200,
    concealed=0,
    tuning=0,
    coloured=900,
    rich_open=1_500,
    rich_null=4_800,
    poor_null=1_200,
    coloured_rich_null=1_000,
    coloured_poor_null=600,
    costly_open=30,
    steps=10,
)
"""The contest with the opponents alone, with more recordings to set thresholds on."""
CONTEST_POOR = Size(
    null=0,
    opened=3_600,
    concealed=0,
    tuning=0,
    coloured=1_800,
    poor_null=12_000,
    coloured_poor_null=6_000,
    costly_open=30,
    steps=10,
    programme="poor",
)
"""The contest on poor programmes alone, of which ``CONTEST`` has few."""
