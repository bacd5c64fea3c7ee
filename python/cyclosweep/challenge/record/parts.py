"""What a record is made of, and in which steps it grows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from cyclosweep.challenge.plan import Entry
from cyclosweep.challenge.runner.run import plan_of

STEPS = 25
COLOURED = "coloured"
"""Part in which the noise is correlated: for the contest alone, apart from all other figures."""


@dataclass(frozen=True)
class Part:
    """One of the challenges that make up a record.

    Attributes
    ----------
    name : str
        Name of its folder.
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
    """

    name: str
    cases: int
    offset: int
    costly: int
    mix: str = ""
    noise: str = "white"

    def plan(self, seed: int, last: int, samples: int) -> list[Entry]:
        """Cases of this part up to one, in a record of this seed and so many readings."""
        about = {
            "seed": seed + self.offset,
            "mix": self.mix or self.name,
            "samples": samples,
            "noise": self.noise,
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
    costly_nulls, costly_open : int
        Recordings of each programme with nothing missing, and of each visibility and programme,
        that the costly opponents see.
    samples : int
        Readings of each recording.
    steps : int
        Steps in which all parts grow together.
    """

    null: int = 10_000
    opened: int = 3_600
    concealed: int = 966
    tuning: int = 350
    coloured: int = 600
    costly_nulls: int = 300
    costly_open: int = 60
    samples: int = 3_000
    steps: int = STEPS

    def parts(self) -> list[Part]:
        """Parts in the order in which a step runs through them."""
        shared = self.costly_nulls * 2 // 3
        return [
            Part("null", self.null, 0, shared),
            Part("open", self.opened, 1, self.costly_open),
            Part("concealed", self.concealed, 2, 0),
            Part("tuning", self.tuning, 3, self.costly_nulls - shared),
            Part(COLOURED, self.coloured, 4, self.coloured, mix="open", noise="ar0.6"),
        ]

    def slices(self) -> Iterator[tuple[Part, int, int]]:
        """Every slice with its first case and the first one after it, all parts in turn."""
        for step in range(self.steps):
            for part in self.parts():
                first, last = part.slice(step, self.steps)
                if last > first:
                    yield part, first, last


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
