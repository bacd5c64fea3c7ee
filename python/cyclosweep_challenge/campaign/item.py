"""One recording of a campaign before it is made, and a part: recordings of one kind."""

from __future__ import annotations

from dataclasses import dataclass

from cyclosweep_challenge.trial.plan import laid_out
from cyclosweep_challenge.trial.tiers import Stratum

FIRST, SECOND = "first", "second"
"""The two generators: the rig with the library's kinds of law, and that of laws from elsewhere."""
RICH_OF_FOUR = 3
"""Of each four numbers of the second generator so many are rich programmes, the last is poor."""


@dataclass(frozen=True)
class Foreign:
    """What is wanted of the second generator.

    Attributes
    ----------
    tier : str
        One of its tiers.
    autocorrelation : float
        Autocorrelation of the noise in place of the tier's own; negative for the tier's own [-].
    d : float
        Visibility in place of the tier's own; zero for the tier's own [-].
    rich : bool
        Take rich programmes alone.
    weight : int
        Recordings of this kind in one turn of the part.
    torque_noise : float
        Noise of the torque reading over that of the angle reading, as elastic twist [-].
    """

    tier: str
    autocorrelation: float = -1.0
    d: float = 0.0
    rich: bool = False
    weight: int = 1
    torque_noise: float = 0.0

    def number(self, turn: int) -> int:
        """Number of the case, by which effects, laws and programmes take turns."""
        return turn + turn // RICH_OF_FOUR if self.rich else turn


@dataclass(frozen=True)
class Item:
    """One recording of a part, not yet made.

    Attributes
    ----------
    part : str
        Part of the campaign.
    number : int
        Place in the part.
    kind : Stratum or Foreign
        What is wanted of the first or of the second generator.
    turn : int
        Number that rises by one from recording to recording of a kind; causes take turns by it.
    seed : int
        Seed of the part.
    samples : int
        Readings wanted, where the kind does not draw their number.
    """

    part: str
    number: int
    kind: Stratum | Foreign
    turn: int
    seed: int
    samples: int

    @property
    def key(self) -> str:
        """Name of the recording's folder; it says nothing about the recording."""
        return f"case-{self.number:06d}"


@dataclass(frozen=True)
class Part:
    """Recordings of one kind, and what their number can decide.

    Attributes
    ----------
    name, what, decides : str
        Name of its folder, what is recorded, and what so many recordings can decide.
    cases : int
        Recordings at a scale of one.
    offset : int
        What is added to the campaign's seed.
    kinds : tuple
        Kinds of recordings, mixed by their weight.
    predicted : bool
        Whether repaired models predict a second programme.
    opponents : int
        Recordings from the first on that opponents see.
    """

    name: str
    what: str
    decides: str
    cases: int
    offset: int
    kinds: tuple[Stratum | Foreign, ...]
    predicted: bool = True
    opponents: int = 0

    @property
    def generator(self) -> str:
        """Which generator makes it."""
        return FIRST if isinstance(self.kinds[0], Stratum) else SECOND

    def plan(self, seed: int, last: int, samples: int) -> list[Item]:
        """Recordings of this part up to one.

        Parameters
        ----------
        seed : int
            Seed of the campaign.
        last : int
            Number of recordings.
        samples : int
            Readings of each.
        """
        own = seed + self.offset
        return [
            Item(self.name, number, kind, turn, own, samples)
            for number, (kind, turn) in enumerate(laid_out(self.kinds, last, own))
        ]

    def slice(self, step: int, steps: int) -> tuple[int, int]:
        """First recording of a step, and the first one after it."""
        return self.cases * step // steps, self.cases * (step + 1) // steps
