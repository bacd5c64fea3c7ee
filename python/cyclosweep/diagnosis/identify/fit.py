"""Joint fit of the published model's calibration and any set of effects."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import least_squares

from cyclosweep.diagnosis.identify.fit_parameters import FitParameter, fit_parameters_of
from cyclosweep.diagnosis.identify.friction_path import friction_path
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.prepare.noise import Noise, orthonormal
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.simulation.effects.history import Flags, Floats, History

INNER = 3
"""Rounds in which the path of the shaft and the linear parameters settle on each other."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A structure fitted jointly with the baseline.

    Attributes
    ----------
    terms : tuple of Term
        With refined shapes; friction carries its amplitude.
    beta : ndarray
        Linear parameters: datum, compliance, free play (where both flanks were loaded), then the
        amplitudes of the linear terms in order.
    history : History
        All rows with the fitted path.
    mean_deg : ndarray, shape (n,)
        Modelled twist of all rows [deg].
    residual : ndarray, shape (fitted,)
        White residual of unit variance.
    chi2 : float
        Its sum of squares.
    tangent : ndarray, shape (fitted, q)
        Orthonormal basis of the tangent space in the whitened metric.
    sensitivity : ndarray, shape (fitted, p)
        Whitened derivative by every parameter: linear ones first, then `shape_values`.
    shape_values : ndarray
        Values of the nonlinear parameters, in the fit's own scale (log where logarithmic).
    """

    problem: Problem
    noise: Noise
    terms: tuple[Term, ...]
    beta: Floats
    history: History
    mean_deg: Floats
    residual: Floats
    chi2: float
    tangent: Floats
    sensitivity: Floats
    shape_values: Floats
    fit_parameters: tuple[FitParameter, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the terms."""
        return tuple(term.name for term in self.terms)

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of all parameters, linear ones first."""
        scale = np.linalg.norm(self.sensitivity, axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        gram = (self.sensitivity / scale).T @ (self.sensitivity / scale)
        return np.asarray(
            np.linalg.pinv(gram, rcond=1e-10, hermitian=True) / np.outer(scale, scale)
        )

    def column_range(self, index: int) -> slice:
        """Place of a linear term's amplitudes within `beta`."""
        first = 2 if self.problem.one_sided else 3
        for k, term in enumerate(self.terms):
            width = 0 if term.slips else term.columns(self.history).shape[1]
            if k == index:
                return slice(first, first + width)
            first += width
        raise IndexError(index)

    def wrong_signs(self, index: int) -> Flags:
        """Amplitudes of a term that lie outside what physics allows."""
        term = self.terms[index]
        if term.slips:
            return np.array([term.amplitude < 0])
        values = self.beta[self.column_range(index)]
        if term.effect is None:
            assert term.free is not None
            return (values < 0) & term.free.positive
        bounds = term.effect.amplitudes(term.shape)[: len(values)]
        lower = np.array([p.lower for p in bounds]) - 1e-12
        upper = np.array([p.upper for p in bounds])
        return (values[: len(bounds)] < lower) | (values[: len(bounds)] > upper)

    @property
    def valid(self) -> bool:
        """Whether all amplitudes have their physical sign."""
        return not any(self.wrong_signs(k).any() for k in range(len(self.terms)))

    def contribution(self, index: int) -> Floats:
        """Twist that a term adds on all rows [deg]."""
        term = self.terms[index]
        if term.slips:
            column = term.columns(self.history)[:, 0]
            return column * term.amplitude
        part = self.column_range(index)
        return term.columns(self.history) @ self.beta[part]

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

    def places_of(self, index: int) -> list[int]:
        """Places of a linear term's amplitudes and shape parameters among all parameters."""
        parameters = [
            len(self.beta) + k
            for k, parameter in enumerate(self.fit_parameters)
            if parameter.term == index
        ]
        return self.amplitude_places(index) + parameters

    def moved(self, place: int, step: float) -> "Fit":
        """Same fit with one parameter of a linear term moved, and nothing else settled on it."""
        if place < len(self.beta):
            beta = self.beta.copy()
            beta[place] += step
            return replace(self, beta=beta)
        parameter = self.fit_parameters[place - len(self.beta)]
        terms = list(self.terms)
        shape = terms[parameter.term].shape
        value = parameter.to_physical(parameter.to_scale(float(shape[parameter.name])) + step)
        terms[parameter.term] = replace(
            terms[parameter.term], shape={**shape, parameter.name: value}
        )
        return replace(self, terms=tuple(terms))

    @property
    def rmse_deg(self) -> float:
        """Root mean square of the angle residual on the fitted rows [deg]."""
        use = self.problem.fitted
        difference = (self.problem.angle_deg - self.mean_deg)[use]
        weight = self.problem.weight[use]
        return float(np.sqrt(np.average(difference**2, weights=weight)))


def fit(
    problem: Problem,
    noise: Noise,
    terms: Sequence[Term],
    start: "Fit | None" = None,
    *,
    refine: bool = True,
    rounds: int = 6,
) -> Fit:
    """Fit baseline and terms jointly by maximum likelihood.

    Parameters
    ----------
    terms : sequence of Term
        With the shapes (and friction amplitudes) from which the search starts.
    start : Fit, optional
        A fit of a similar structure, whose path the iteration starts from.
    refine : bool
        Whether shape parameters are refined, or only linear ones fitted.
    rounds : int
        Most iterations of the refinement.
    """
    terms = tuple(terms)
    parameters = fit_parameters_of(terms, problem) if refine else _friction_limits(terms, problem)
    model = _Model(problem, noise, terms, parameters, start)
    values = np.array(
        [
            parameter.to_scale(_value(terms[parameter.term], parameter.name))
            for parameter in parameters
        ]
    )
    if len(parameters):
        lower = np.array([parameter.to_scale(parameter.quantity.lower) for parameter in parameters])
        upper = np.array([parameter.to_scale(parameter.quantity.upper) for parameter in parameters])
        lower = np.where(np.isneginf(lower), -1e6, lower)
        width = np.minimum(upper - lower, 1e6)
        values = np.clip(values, lower + 1e-6 * width, upper - 1e-6 * width)
        scale = np.array(
            [_scale(parameter, v) for parameter, v in zip(parameters, values, strict=True)]
        )
        model.settle(values)
        for _ in range(2):
            result = least_squares(
                model.residual,
                values,
                bounds=(lower, upper),
                x_scale=scale,
                diff_step=np.full(len(values), 1e-4),
                max_nfev=rounds,
                ftol=1e-5,
                xtol=1e-5,
                gtol=1e-8,
            )
            moved = float(np.max(np.abs(result.x - values) / scale))
            values = result.x
            model.settle(values)
            if moved < 1e-2:
                break
    else:
        model.settle(values)
    return model.finish(values)


def _friction_limits(terms: Sequence[Term], problem: Problem) -> tuple[FitParameter, ...]:
    """Only friction amplitudes, which enter through the path of the shaft."""
    return tuple(s for s in fit_parameters_of(terms, problem) if s.name == "amplitude")


def _value(term: Term, name: str) -> float:
    return term.amplitude if name == "amplitude" else float(term.shape[name])


def _scale(parameter: FitParameter, value: float) -> float:
    if parameter.quantity.logarithmic:
        return 0.5
    if parameter.name == "amplitude":
        return max(abs(value), 1e-3 * (parameter.quantity.upper - parameter.quantity.lower), 1e-6)
    return max(
        0.2 * abs(value), 0.02 * min(parameter.quantity.upper - parameter.quantity.lower, 1e3)
    )


class _Model:
    """Workspace of one fit: path of the shaft, linear solve, residual."""

    def __init__(
        self,
        problem: Problem,
        noise: Noise,
        terms: tuple[Term, ...],
        parameters: tuple[FitParameter, ...],
        start: Fit | None,
    ) -> None:
        self.problem, self.noise, self.terms, self.fit_parameters = (
            problem,
            noise,
            terms,
            parameters,
        )
        self.slides = any(term.slips for term in terms)
        self.use = problem.fitted
        self.angle = problem.angle_deg[self.use]
        base = start.history if start is not None else problem.history
        self.history = base
        self.mean = start.mean_deg if start is not None else base.angle_deg
        if start is not None and not self.slides:
            self.history = base.with_state(elastic_nm=base.applied_nm, angle_deg=self.mean)
        self.beta = np.zeros(0)
        self.target, self.weight = self._working(self.mean)

    def _working(self, mean: Floats) -> tuple[Floats, Floats]:
        """Working residual of the likelihood at a mean, and its row weights."""
        residual, weight = self.noise.residual(self.angle, mean[self.use])
        return residual, weight

    def _terms_at(self, values: Floats) -> tuple[Term, ...]:
        shapes = [dict(term.shape) for term in self.terms]
        amplitudes = [term.amplitude for term in self.terms]
        for parameter, value in zip(self.fit_parameters, values, strict=True):
            if parameter.name == "amplitude":
                amplitudes[parameter.term] = parameter.to_physical(value)
            else:
                shapes[parameter.term][parameter.name] = parameter.to_physical(value)
        slide = next((k for k, term in enumerate(self.terms) if term.slips), None)
        for k, term in enumerate(self.terms):
            if term.slips and slide is not None and k != slide:
                shapes[k] = dict(shapes[slide])
        return tuple(
            replace(term, shape=shape, amplitude=amplitude)
            for term, shape, amplitude in zip(self.terms, shapes, amplitudes, strict=True)
        )

    def _design(self, terms: tuple[Term, ...], history: History) -> tuple[Floats, Floats]:
        """Columns of the linear parameters, and the precision with which each is known before."""
        parts = [np.ones((len(history), 1)), history.elastic_nm[:, None]]
        if not self.problem.one_sided:
            parts.append(history.side[:, None])
        hold = [np.zeros(len(parts))]
        for term in terms:
            if term.slips:
                continue
            columns = term.columns(history)
            parts.append(columns)
            size = None if term.effect is None else term.effect.expected(history, term.shape)
            hold.append(np.zeros(columns.shape[1]) if size is None else 1.0 / size**2)
        return np.column_stack(parts), np.concatenate(hold)

    def _evaluate(self, values: Floats, inner: int) -> tuple[Floats, History, Floats, Floats]:
        """Settle path and linear parameters at these shapes; return the working residual."""
        terms = self._terms_at(values)
        history, mean = self.history, self.mean
        here = mean[self.use]
        for _ in range(inner if self.slides else 1):
            if self.slides:
                history = friction_path(terms, history, mean)
            design, hold = self._design(terms, history)
            inside = design[self.use]
            # The working data are fixed during one refinement: target = residual at self.mean.
            white = self.noise.design(inside, self.weight)
            shifted = self.target + self.noise.design(here, self.weight)
            beta = _solve(white, shifted, hold)
            mean = design @ beta
            history = self._calibrated(history, beta, mean)
        self._last = (terms, design, white, beta)
        return shifted - white @ beta, history, mean, beta

    def _calibrated(self, history: History, beta: Floats, mean: Floats) -> History:
        play = history.free_play_deg if self.problem.one_sided else max(float(beta[2]), 0.0)
        compliance = float(beta[1])
        if compliance <= 0:
            compliance = history.compliance_deg_per_nm
        datum = float(beta[0])
        if self.problem.one_sided:
            datum -= float(history.side[self.use][0]) * play
        state: dict[str, float | Floats] = {
            "compliance_deg_per_nm": compliance,
            "free_play_deg": play,
            "datum_deg": datum,
        }
        if not self.slides:
            state["angle_deg"] = mean
        return history.with_state(**state)

    def residual(self, values: Floats) -> Floats:
        """Working residual with path and linear parameters settled."""
        return self._evaluate(values, 1)[0]

    def settle(self, values: Floats) -> None:
        """Move the point about which the likelihood is expanded to these shapes."""
        exact = self.noise
        for level in _levels(exact):
            self.noise = exact.with_sigma(level)
            self.target, self.weight = self._working(self.mean)
            for _ in range(6):
                _, history, mean, beta = self._evaluate(values, INNER)
                moved = float(np.sqrt(np.mean((mean - self.mean)[self.use] ** 2)))
                self.history, self.mean, self.beta = history, mean, beta
                self._agree(history, beta)
                self.target, self.weight = self._working(mean)
                if moved < 1e-3 * self.noise.sigma_deg:
                    break

    def _agree(self, history: History, beta: Floats) -> None:
        """Let the shapes follow where they depend on the amplitudes."""
        first, terms = 2 if self.problem.one_sided else 3, []
        for term in self.terms:
            width = 0 if term.slips else term.columns(history).shape[1]
            if term.effect is not None and width:
                shape = term.effect.settled(history, term.shape, beta[first : first + width])
                term = replace(term, shape=shape)
            terms.append(term)
            first += width
        self.terms = tuple(terms)

    def finish(self, values: Floats) -> Fit:
        """Collect the fit with its tangent space."""
        residual = self.residual(values)
        terms, _, white, beta = self._last
        slopes = []
        for k in range(len(values)):
            step = 1e-3 * max(abs(values[k]), _scale(self.fit_parameters[k], values[k]))
            ahead = values.copy()
            ahead[k] += step
            change = residual - self.residual(ahead)
            # The linear parameters have followed; the derivative is at theirs held.
            slopes.append((change - white @ (self._last[3] - beta)) / step)
        self.residual(values)
        sensitivity = np.column_stack([white, *slopes]) if slopes else white
        tangent = orthonormal(sensitivity, 1e-6)
        return Fit(
            problem=self.problem,
            noise=self.noise,
            terms=terms,
            beta=beta,
            history=self.history,
            mean_deg=self.mean,
            residual=self.target - tangent @ (tangent.T @ self.target),
            chi2=float(self.target @ self.target),
            tangent=tangent,
            sensitivity=sensitivity,
            shape_values=values,
            fit_parameters=self.fit_parameters,
        )


def _levels(noise: Noise) -> list[float]:
    """Sizes of noise from wide to exact: a coarse dial's likelihood has to be approached."""
    levels = [noise.sigma_deg]
    while noise.step_deg > 0 and levels[-1] < 0.25 * noise.step_deg:
        levels.append(1.8 * levels[-1])
    return levels[::-1]


def _solve(design: Floats, target: Floats, hold: Floats) -> Floats:
    """Least squares by normal equations on scaled columns, a whisker of ridge for lost ranks.

    `hold` is the precision with which each parameter is known beforehand to be near zero.
    """
    norm = np.sqrt(np.einsum("ij,ij->j", design, design))
    norm = np.where(norm > 0, norm, 1.0)
    scaled = design / norm
    gram = scaled.T @ scaled + np.diag(hold / norm**2)
    right = scaled.T @ target
    for ridge in (0.0, 1e-9, 1e-6):
        try:
            factor = cho_factor(gram + ridge * np.eye(len(gram)), check_finite=False)
        except np.linalg.LinAlgError:
            continue
        if ridge > 0 or np.min(np.abs(np.diag(factor[0]))) > 1e-5:
            return np.asarray(cho_solve(factor, right, check_finite=False) / norm)
    return np.asarray(np.linalg.lstsq(scaled, target, rcond=1e-10)[0] / norm)
