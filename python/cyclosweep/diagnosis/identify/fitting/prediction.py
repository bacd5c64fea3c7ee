"""What a fitted structure predicts: twist of rows, fitted or left out."""

from dataclasses import dataclass

from cyclosweep.result import Counted
from cyclosweep.simulation.effects.history import Flags, Floats


@dataclass(frozen=True, eq=False)
class Prediction:
    """Twist that a structure predicts, and how far it is from the recording.

    Attributes
    ----------
    angle_deg : ndarray, shape (n,)
        Twist of all rows [deg].
    error_deg : float
        Root mean square of the difference on the fitted rows [deg].
    counted : str
        Which rows these are.
    """

    angle_deg: Floats
    error_deg: float
    counted: Counted


@dataclass(frozen=True, eq=False)
class LeftOutPrediction:
    """Twist of rows that were not fitted, by the baseline and by a structure.

    Attributes
    ----------
    label : str
        What was left out.
    rows : ndarray of bool, shape (n,)
        The rows that were left out.
    kept_runs : bool
        Whether they are runs kept for this purpose, rather than left out in turn.
    baseline_deg, structure_deg : ndarray, shape (n,)
        Predicted twist of all rows [deg].
    log_likelihood_ratio : float
        Log likelihood of the rows under the structure over that under a baseline fitted to them;
        NaN where the residual is error of the model and has no likelihood.
    known_flank : KnownFlankPrediction or None
        The same with the flank in contact read off the recording; None where it is so anyway.
    """

    label: str
    rows: Flags
    kept_runs: bool
    baseline_deg: Floats
    structure_deg: Floats
    log_likelihood_ratio: float
    known_flank: "KnownFlankPrediction | None" = None


@dataclass(frozen=True, eq=False)
class KnownFlankPrediction:
    """Twist by baseline and structure where the flank in contact is read off the recording.

    Attributes
    ----------
    rows : ndarray of bool, shape (n,)
        Rows in contact that were left out.
    baseline_deg, structure_deg : ndarray, shape (n,)
        Predicted twist of all rows [deg].
    """

    rows: Flags
    baseline_deg: Floats
    structure_deg: Floats
