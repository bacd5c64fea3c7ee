"""What a joint fit in progress hands on: where it stands, and its slopes there."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.noise import orthonormal
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


class Linearisation:
    """Slopes of a structure at its solution, measured when they are first asked for.

    Most structures that a search fits are no better than those it has, and nobody asks.

    Parameters
    ----------
    target : ndarray, shape (fitted,)
        White residual of unit variance, as it is.
    slopes : callable
        Returns the sensitivity.
    """

    def __init__(self, target: Floats, slopes: Callable[[], Floats]) -> None:
        self.target = target
        self._slopes: Callable[[], Floats] | None = slopes

    @cached_property
    def sensitivity(self) -> Floats:
        """Whitened derivative by every parameter, shape (fitted, p): linear ones first."""
        assert self._slopes is not None
        found = self._slopes()
        # What it was measured with, all columns of a fit, is needed no longer.
        self._slopes = None
        return found

    @cached_property
    def tangent(self) -> Floats:
        """Orthonormal basis of the tangent space in the whitened metric, shape (fitted, q)."""
        return orthonormal(self.sensitivity, 1e-6)

    @cached_property
    def residual(self) -> Floats:
        """White residual less what lies in the tangent space, shape (fitted,)."""
        return np.asarray(self.target - self.tangent @ (self.tangent.T @ self.target))
