"""What a series of recordings shows: means at each value of a condition, trends, and steps."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import factorial

MEASURES = {
    "friction_nm": "friction",
    "play_deg": "play",
    "lost_motion_deg": "lost motion",
    "loop_compliance_deg_per_nm": "compliance",
}
"""What is read of every recording without a model, by column of the table."""
FEWEST = 6
"""Fewest recordings from which a trend is tested: of fewer, chance alone gives any order too
often."""
CERTAIN = 0.05
"""Largest probability, corrected for the number of trends looked at, at which a trend is stated."""


def as_shown(measure: str, value: float) -> float:
    """Value of a measure as it is shown: a play below zero, where lines overlap, is none.

    The table keeps the value as it was read, and means are of such values.

    Parameters
    ----------
    measure : str
        Column of the table, or the one of an end of its interval.
    value : float
        Value, mean, or end of an interval.

    Returns
    -------
    float

    Examples
    --------
    >>> as_shown("play_deg", -0.02), as_shown("play_deg", 0.2), as_shown("friction_nm", -0.02)
    (0.0, 0.2, -0.02)
    """
    return max(value, 0.0) if measure == "play_deg" else value


@dataclass(frozen=True, slots=True, kw_only=True)
class Level:
    """Mean of a measure over the recordings at one value of a condition.

    Attributes
    ----------
    value : float
        Value of the condition.
    recordings : int
        How many recordings.
    mean : float
        Mean of the measure.
    ci95 : (float, float) or None
        Interval of the mean by Student's t over recordings; None for a single one.
    """

    value: float
    recordings: int
    mean: float
    ci95: tuple[float, float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Trend:
    """Whether a measure rises or falls with a condition.

    Attributes
    ----------
    condition, measure : str
        Columns of the table.
    pairs, rising : int
        Pairs of recordings that differ in this condition and agree in all others, and how many
        of them rise.
    p_value : float
        Probability of so uneven a count if the condition did nothing, both directions, after
        Holm's correction for all trends of the series.
    levels : tuple of Level
        Means at each value.
    recordings : int
        Recordings that have both.
    apart : bool or None
        Of few recordings, whether the intervals of the first and the last value lie apart; None
        where one of them has none.
    """

    condition: str
    measure: str
    pairs: int
    rising: int
    p_value: float
    levels: tuple[Level, ...]
    recordings: int = FEWEST
    apart: bool | None = None

    @property
    def text(self) -> str:
        """The trend in one sentence."""
        falling = self.pairs - self.rising
        what = MEASURES.get(self.measure, self.measure.replace("_", " "))
        condition = self.condition.replace("_", " ")
        counted = (
            f"{max(self.rising, falling)} of {self.pairs} pairs of recordings that differ in it "
            f"alone (p = {max(self.p_value, 1e-4):.2g})"
        )
        if self.recordings < FEWEST:
            return self._of_few(what, condition)
        if self.p_value > CERTAIN:
            return f"No trend of {what} with {condition} can be stated: in one order are {counted}."
        verb = "rises" if self.rising > falling else "falls"
        return f"{what.capitalize()} {verb} with {condition}: in this order are {counted}."

    def _of_few(self, what: str, condition: str) -> str:
        """Say what three to five recordings show: their order, and whether the ends differ."""
        first, last = (
            as_shown(self.measure, level.mean) for level in (self.levels[0], self.levels[-1])
        )
        falling = self.pairs - self.rising
        # Every order of n recordings is equally likely by chance; two of them are monotone.
        chance = 2.0 / factorial(self.recordings)
        if max(self.rising, falling) == self.pairs and self.pairs:
            verb = "rises" if self.rising else "falls"
            order = (
                f"{verb} with {condition} from each recording to the next, "
                f"{first:.3g} to {last:.3g} (chance alone would order {self.recordings} "
                f"recordings so in {100 * chance:.2g} % of cases)"
            )
        else:
            order = f"neither rises nor falls throughout with {condition}"
        ends = {
            None: "there are no intervals to compare the first and the last with",
            True: "the 95 % intervals of the first and the last lie apart",
            False: "the 95 % intervals of the first and the last overlap",
        }[self.apart]
        return (
            f"{what.capitalize()} {order}; {ends}. {self.recordings} recordings are too few to "
            f"state a trend: {FEWEST} or more are needed."
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnOrder:
    """Order of the steps of one recording of a series.

    Attributes
    ----------
    order : float
        Its clearest order, in cycles a turn of the input [-].
    chance : float
        Share of random staircases of which some order is at least as clear.
    order_of_others : float
        Clearest order of all other recordings together [-].
    chance_of_others : float
        Share of random staircases in which that order is at least as clear as in this recording.
    """

    order: float
    chance: float
    order_of_others: float
    chance_of_others: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StepsInCommon:
    """Order of the steps that recordings of one rig share.

    Attributes
    ----------
    order : float
        Cycles a turn of the input at which, and at whose multiples, the torque at equal angle
        stands out, all recordings together [-].
    apart : float
        By how much another order must differ to be told from it in one recording [-].
    chance : float
        Share of random staircases, passed by all recordings, of which some order is at least as
        clear.
    certain : bool
        Whether that is so small that the order is stated.
    own : mapping of str to OwnOrder
        The order of each recording that was looked at, by its name.
    left_out : tuple of str
        Names of the recordings whose legs are too long or too short to be compared.
    """

    order: float
    apart: float
    chance: float
    certain: bool
    own: Mapping[str, OwnOrder]
    left_out: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """What the recordings share, in one or two sentences."""
        count = len(self.own)
        beside = len(self.left_out)
        those = f"{count} recordings" + (
            f" ({beside} more have legs of another length and are left out)" if beside else ""
        )
        chance = f"at most {100 * self.chance:.2g} % of random staircases show as clear an order"
        if not self.certain:
            return (
                f"Steps of the torque repeat in {those}, and have no order in common that can be "
                f"stated: {chance}."
            )
        near = sum(abs(each.order - self.order) <= self.apart for each in self.own.values())
        return (
            f"Steps of the torque repeat in {those} and come, all together, at order "
            f"{self.order:.3g} of a turn of the input and its multiples, as from the poles of a "
            f"motor or the teeth of a mesh: {chance}. In {near} of the {count} recordings it is "
            f"the clearest order, within {self.apart:.2g}."
        )
