"""What a joint fit in progress hands on: where it stands, and its slopes there."""

from dataclasses import dataclass

from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.simulation.effects.history import Floats, History


@dataclass(frozen=True, eq=False)
class Expansion:
    """State of a fit at a point about which the likelihood was expanded.

    Attributes
    ----------
    chi2 : float
        Sum of squares of the white residual.
    misfit : float
        Twice the log likelihood that it lacks to a perfect fit, by which two expansions compare.
    values : ndarray
        Nonlinear parameters, in the fit's own scale.
    history : History
        All rows with the path of the shaft and the elastic law.
    mean_deg : ndarray, shape (n,)
        Modelled twist of all rows [deg].
    terms : tuple of Term
        With shapes that follow from the amplitudes.
    """

    chi2: float
    misfit: float
    values: Floats
    history: History
    mean_deg: Floats
    terms: tuple[Term, ...]


@dataclass(frozen=True, eq=False)
class Linearisation:
    """A structure at its solution, linearised.

    Attributes
    ----------
    terms : tuple of Term
        With their values.
    beta : ndarray
        Linear parameters.
    target : ndarray, shape (fitted,)
        White residual of unit variance, as it is.
    sensitivity : ndarray, shape (fitted, p)
        Whitened derivative by every parameter: linear ones first, then nonlinear ones.
    """

    terms: tuple[Term, ...]
    beta: Floats
    target: Floats
    sensitivity: Floats
