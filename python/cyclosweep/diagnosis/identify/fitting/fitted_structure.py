"""A fitted structure: the calibrated model with some effects, however it was fitted.

A structure is the calibrated published model with a set of terms. Two kinds are fitted:
`cyclosweep.diagnosis.identify.fitting.fit.ContactFit` to the rows in contact, the flank of each row
being read off the recording, and `cyclosweep.diagnosis.whole_loop.known_flank.WholeLoopFit` to all
rows, the flank being predicted.
"""

from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from cyclosweep.diagnosis.identify.fitting.covariance import covariance_of
from cyclosweep.diagnosis.identify.fitting.fit_parameters import FitParameter
from cyclosweep.diagnosis.identify.fitting.fit_state import Linearisation
from cyclosweep.diagnosis.identify.fitting.prediction import (
    LeftOutPrediction,
    Prediction,
)
from cyclosweep.diagnosis.identify.fitting.repetition import Repetition
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.noise import Noise, orthonormal
from cyclosweep.diagnosis.prepare.problem import COMPLIANCE, Problem
from cyclosweep.diagnosis.prepare.torque_zero import TorqueZero
from cyclosweep.result import Finding
from cyclosweep.simulation.effects.history import Flags, Floats, History
from cyclosweep.simulation.simulate import Model

LEAST_OF_SLOPE = 0.1
"""Least compliance of the line over that of the flanks, with which it is still the drive's."""
LEAST_BESIDE_SPRING = 0.01
"""What is left of it in any case beside a law that the whole drive may follow."""
LEAST_TOLD = 1e-5
"""Singular value over the largest one below which the rows tell nothing of a direction."""


@dataclass(frozen=True, eq=False)
class FittedStructure(ABC):
    """A structure fitted jointly with the calibration, and its linearisation.

    Attributes
    ----------
    problem : Problem
        The recording it was fitted to.
    noise : Noise
        Noise by which residual and sensitivities are whitened.
    terms : tuple of Term
        With refined shapes; friction carries its amplitude.
    beta : ndarray
        Linear parameters: datum [deg], compliance [deg/(N m)], free play [deg] (where both flanks
        were loaded), then the amplitudes of the linear terms in order.
    history : History
        All rows with the fitted path.
    mean_deg : ndarray, shape (n,)
        Modelled twist of all rows, with the flank read off the recording [deg].
    chi2 : float
        Sum of squares of the white residual.
    linearisation : Linearisation
        Its slopes by all parameters.
    fit_parameters : tuple of FitParameter
        The nonlinear parameters.
    """

    problem: Problem
    noise: Noise
    terms: tuple[Term, ...]
    beta: Floats
    history: History
    mean_deg: Floats
    chi2: float
    linearisation: Linearisation
    fit_parameters: tuple[FitParameter, ...]

    @property
    def residual(self) -> Floats:
        """White residual of unit variance, shape (fitted,)."""
        return self.linearisation.residual

    @property
    def tangent(self) -> Floats:
        """Orthonormal basis of the tangent space in the whitened metric, shape (fitted, q)."""
        return self.linearisation.tangent

    @property
    def sensitivity(self) -> Floats:
        """Whitened derivative by every parameter, shape (fitted, p): linear ones first."""
        return self.linearisation.sensitivity

    @property
    def loss(self) -> float:
        """Twice the log likelihood that the fit lacks to a perfect one.

        Chi-squared is no such measure under heavy tails: there it forgets what is far off.
        """
        return self.chi2

    @property
    def line_compliance_deg_per_nm(self) -> float:
        """Compliance of the line beside the effects [deg/(N m)]."""
        return float(self.beta[COMPLIANCE])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the terms."""
        return tuple(term.name for term in self.terms)

    @property
    @abstractmethod
    def prediction(self) -> Prediction:
        """Twist of all rows as the structure is meant to predict it."""

    @property
    def prediction_path(self) -> History:
        """Path of the shaft behind that prediction."""
        return self.history

    @abstractmethod
    def baseline_prediction(self, baseline: "FittedStructure") -> Prediction:
        """Twist of all rows by the baseline, predicted in the same way as by the structure.

        ``baseline`` is the calibrated published model fitted to the rows in contact.
        """

    @property
    @abstractmethod
    def independent_share(self) -> float:
        """Share of the fitted rows whose residuals are independent of the others."""

    @property
    @abstractmethod
    def line_errors(self) -> Floats:
        """Standard errors of datum [deg], compliance [deg/(N m)] and free play [deg]."""

    @property
    @abstractmethod
    def torque_zero(self) -> TorqueZero | None:
        """Torque read without load; None where it is not fitted."""

    @abstractmethod
    def follows_path(self, index: int) -> bool:
        """Whether the twist of a term is known only with the path of the shaft solved again.

        Its size then has no derivative by single parameters.
        """

    def only(self, names: Collection[str]) -> "FittedStructure | None":
        """Fit some of the terms alone, to all rows; None where rows in contact were fitted.

        Parameters
        ----------
        names : collection of str
            Names of the terms.

        Returns
        -------
        FittedStructure or None
        """
        return None

    @abstractmethod
    def model(self, drive: str) -> Model:
        """Return the structure as a simulation of a drive of this name."""

    @abstractmethod
    def predict_left_out(self) -> list[LeftOutPrediction]:
        """Fit without some rows and predict them, for each block of rows to be left out."""

    @abstractmethod
    def left_out_evidence(
        self, predictions: Sequence[LeftOutPrediction], baseline_deg: float, structure_deg: float
    ) -> float:
        """Return the e-value for the structure over the baseline, from rows not fitted.

        Parameters
        ----------
        predictions : sequence of LeftOutPrediction
        baseline_deg, structure_deg : float
            Root mean square errors over all of them [deg].

        Returns
        -------
        float
            At least so many times likelier.
        """

    @abstractmethod
    def run_to_run_errors(self) -> list[tuple[float, float]]:
        """Errors of single-run fits: on their own run, and on the worst of its replicates [deg]."""

    @property
    def hidden_play(self) -> str | None:
        """Why play and stiffness cannot be read from the loop; None where they can be."""
        return None

    @abstractmethod
    def findings(self, repeats: Repetition | None, *, unsteady: bool) -> tuple[Finding, ...]:
        """Return topics and sentences on the measured loop, where the structure predicts it.

        Parameters
        ----------
        repeats : Repetition, optional
            How well the residual of one run predicts that of another.
        unsteady : bool
            Whether the loops drift from run to run.

        Returns
        -------
        tuple of Finding
        """

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of all parameters, linear ones first."""
        return self.covariance_given(np.zeros(len(self.beta) + len(self.fit_parameters)))

    @cached_property
    def covariance_within_bounds(self) -> Floats:
        """Covariance of all parameters, shapes and limits known to lie within their bounds.

        A shape that the recording does not tell would else be unknown beyond all bounds, and the
        size with it, though the twist of every shape within them is known.
        """
        information = np.zeros(len(self.beta) + len(self.fit_parameters))
        for place, each in enumerate(self.fit_parameters, len(self.beta)):
            room = each.to_scale(each.quantity.upper) - each.to_scale(each.quantity.lower)
            if 0.0 < room < np.inf:
                # Of an even distribution, the variance is a twelfth of the square of its width.
                information[place] = 12.0 / room**2
        return self.covariance_given(information)

    def covariance_given(self, information: Floats) -> Floats:
        """Covariance of all parameters, where something is known of each besides.

        Parameters
        ----------
        information : ndarray, shape (k,)
            One over the variance of each as far as it is known, linear ones first; zero where
            nothing is.

        Returns
        -------
        ndarray, shape (k, k)
        """
        return covariance_of(self.sensitivity, information, LEAST_TOLD)

    @property
    def standard_errors(self) -> Floats:
        """Standard errors of all parameters, linear ones first, each in the fit's own scale."""
        return np.asarray(np.sqrt(np.maximum(np.diag(self.covariance), 0.0)))

    @property
    def residual_deg(self) -> Floats:
        """Measured less modelled twist of the fitted rows, shape (fitted,) [deg]."""
        return np.asarray((self.problem.angle_deg - self.mean_deg)[self.problem.fitted])

    @property
    def rmse_deg(self) -> float:
        """Root mean square of the angle residual on the fitted rows in contact [deg]."""
        return self.problem.rms_error(self.mean_deg, self.problem.fitted)

    def column_range(self, index: int) -> slice:
        """Place of a linear term's amplitudes within `beta`."""
        first = self.problem.line_columns
        for k, term in enumerate(self.terms):
            width = 0 if term.slips else term.columns(self.history).shape[1]
            if k == index:
                return slice(first, first + width)
            first += width
        raise IndexError(index)

    @property
    def elastic_parts(self) -> list[tuple[Term, Floats]]:
        """Terms that belong to the elastic law, each with its amplitudes."""
        return [
            (term, self.beta[self.column_range(k)])
            for k, term in enumerate(self.terms)
            if term.elastic
        ]

    def wrong_signs(self, index: int) -> Flags:
        """Amplitudes of a term that lie outside what physics allows."""
        term = self.terms[index]
        if term.slips:
            return np.array([term.amplitude < 0])
        values = self.beta[self.column_range(index)]
        if term.effect is None:
            assert term.unnamed is not None
            return (values < 0) & term.unnamed.positive
        bounds = term.effect.amplitudes(term.shape)[: len(values)]
        lower = np.array([p.lower for p in bounds]) - 1e-12
        upper = np.array([p.upper for p in bounds])
        return (values[: len(bounds)] < lower) | (values[: len(bounds)] > upper)

    @property
    def keeps_line(self) -> bool:
        """Whether the line, and not its effects, is the elasticity of the drive.

        A law that the whole drive may follow counts for it.
        """
        line = self.line_compliance_deg_per_nm
        springs = [size for term, size in self.elastic_parts if term.is_whole_spring]
        whole = line + sum(float(size[0]) for size in springs)
        return line > 0.0 and whole >= LEAST_OF_SLOPE * self.problem.history.compliance_deg_per_nm

    @property
    def valid(self) -> bool:
        """Whether all amplitudes have their physical sign."""
        return not any(self.wrong_signs(k).any() for k in range(len(self.terms)))

    def contribution(self, index: int) -> Floats:
        """Twist that a term adds on all rows [deg]."""
        term = self.terms[index]
        if term.slips:
            return term.columns(self.history)[:, 0] * term.amplitude
        return term.columns(self.history) @ self.beta[self.column_range(index)]

    def whitened(self, columns: Floats, noise: Noise) -> Floats:
        """Whiten columns on the fitted rows.

        Parameters
        ----------
        columns : ndarray, shape (fitted,) or (fitted, k)
            Twist for unit parameters [deg].
        noise : Noise
            Noise by which they are whitened.

        Returns
        -------
        ndarray, shape (fitted,) or (fitted, k)
        """
        use = self.problem.fitted
        _, weight = noise.residual(self.problem.angle_deg[use], self.mean_deg[use])
        return noise.design(columns, weight)

    def whitened_contribution(self, index: int, noise: Noise) -> Floats:
        """Twist that a term adds on the fitted rows, whitened.

        Parameters
        ----------
        index : int
            Which of the terms.
        noise : Noise
            As of `whitened`.

        Returns
        -------
        ndarray, shape (fitted,)
        """
        return self.whitened(self.contribution(index)[self.problem.fitted], noise)

    def information(self, places: Sequence[int]) -> Floats:
        """Information on some parameters, all others known only by this recording.

        What the recording does not determine has none, where `covariance` would have to be
        without bound.
        """
        others = [k for k in range(self.sensitivity.shape[1]) if k not in places]
        basis = orthonormal(self.sensitivity[:, others], 1e-8)
        part = self.sensitivity[:, list(places)]
        left = part - basis @ (basis.T @ part)
        return np.asarray(left.T @ left)

    def amplitude_places(self, index: int) -> list[int]:
        """Places of a linear term's amplitudes among all parameters."""
        part = self.column_range(index)
        return list(range(part.start, part.stop))

    def nonlinear_places(self, index: int) -> list[int]:
        """Places of a term's nonlinear parameters among all parameters."""
        first = len(self.beta)
        return [first + k for k, each in enumerate(self.fit_parameters) if each.term == index]

    def moved(self, place: int, step: float) -> Self:
        """Return the same fit with one parameter moved and nothing else fitted again.

        Parameters
        ----------
        place : int
            Place of a parameter of a linear term among all parameters.
        step : float
            Change of it, in the fit's own scale.

        Returns
        -------
        FittedStructure
        """
        if place < len(self.beta):
            beta = self.beta.copy()
            beta[place] += step
            return replace(self, beta=beta)
        known = self.fit_parameters[place - len(self.beta)]
        terms = list(self.terms)
        shape = terms[known.term].shape
        value = known.to_physical(known.to_scale(float(shape[known.name])) + step)
        terms[known.term] = replace(terms[known.term], shape={**shape, known.name: value})
        return replace(self, terms=tuple(terms))
