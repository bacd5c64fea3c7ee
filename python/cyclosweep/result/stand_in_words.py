"""What effects that only stand in for something without a name remove, in words."""

from dataclasses import dataclass

from cyclosweep.result.answer import Answer
from cyclosweep.result.words import degrees, listed


@dataclass(frozen=True, slots=True)
class Removed:
    """Errors before and after a repair.

    Attributes
    ----------
    before_deg, after_deg : float
        Error of the calibrated model and of the repaired one [deg].
    of : str
        On which data, in words.
    """

    before_deg: float
    after_deg: float
    of: str

    @property
    def share(self) -> float:
        """Share of the mean square error that the repair removes."""
        return 1.0 - (self.after_deg / self.before_deg) ** 2

    @property
    def in_words(self) -> str:
        """Share of the mean square error that goes, and both errors."""
        ends = f"{degrees(self.before_deg)} to {degrees(self.after_deg)}"
        if self.share <= 0.0:
            return f"removes nothing {self.of} ({ends})"
        return f"removes {100 * self.share:.3g} % {self.of} ({ends})"


def removed(answer: Answer) -> Removed | None:
    """Errors before and after the repair, on data that were not used where there are such.

    Parameters
    ----------
    answer : Answer
        The answer of a diagnosis.

    Returns
    -------
    Removed or None
        None where the errors are not known.
    """
    before, after, of = answer.baseline.rmse_deg, answer.repaired.rmse_deg, "of the mismatch"
    if answer.baseline.holdout_rmse_deg:
        before, after = answer.baseline.holdout_rmse_deg, answer.repaired.holdout_rmse_deg
        of = "of the mismatch on data not used"
    return None if not before or after is None else Removed(before, after, of)


def stand_in_words(answer: Answer) -> str:
    """Name the stand-ins of the repaired model; empty where it has none."""
    laws = answer.repaired.stand_ins
    if not laws:
        return ""
    return f"{listed(laws)} as {'a stand-in' if len(laws) == 1 else 'stand-ins'}"


def removed_by_stand_ins(answer: Answer) -> str:
    """Say what the repaired model with stand-ins removes, and that no share is explained by them.

    Parameters
    ----------
    answer : Answer
        The answer of a diagnosis.

    Returns
    -------
    str
        One sentence; empty where the model has no stand-in, or its errors are not known.
    """
    found, names = removed(answer), stand_in_words(answer)
    if found is None or not names:
        return ""
    effects = [effect.name for effect in answer.effects]
    model = f"{listed(effects)}, and {names}" if effects else names
    return (
        f"The repaired model, with {model}, {found.in_words}. What a stand-in removes does not "
        "count as explained."
    )
