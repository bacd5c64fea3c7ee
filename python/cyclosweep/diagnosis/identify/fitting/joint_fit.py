"""One joint fit in progress: path of the shaft, linear parameters, residual and its slopes."""

from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit_parameters import FitParameter, usual_change
from cyclosweep.diagnosis.identify.fitting.fit_state import Expansion
from cyclosweep.diagnosis.identify.fitting.fitted_structure import LEAST_BESIDE_SPRING
from cyclosweep.diagnosis.identify.fitting.friction_path import friction_path
from cyclosweep.diagnosis.identify.fitting.linear_solve import solve
from cyclosweep.diagnosis.identify.fitting.path_law import (
    beyond_friction,
    elastic_parts,
    path_law,
    under_drag,
)
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.prepare.problem import (
    COMPLIANCE,
    DATUM,
    FREE_PLAY,
    Problem,
    line_design,
)
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.slip import on_shared_elements

SETTLED = 0.01
"""Change of the modelled twist, over the noise, below which path and linear parameters agree."""
INNER = 3
"""Most rounds in which path and linear parameters are solved in turn with one set of weights."""
EXPANDED, EXPANDED_ON_A_LINE = 6, 40
"""Most times the weights of the rows follow the fit, with friction and without. Far from the noise
those of outliers settle slowly, and without a path of friction each time costs little."""


class JointFit:
    """Workspace of one fit: path of the shaft, linear solve, residual.

    Parameters
    ----------
    problem : Problem
    noise : Noise
    terms : tuple of Term
    parameters : tuple of FitParameter
        The nonlinear parameters of the terms.
    history : History
        All rows with the path from which the iteration starts.
    mean_deg : ndarray, shape (n,)
        Modelled twist of all rows from which it starts [deg].
    """

    def __init__(
        self,
        problem: Problem,
        noise: Noise,
        terms: tuple[Term, ...],
        parameters: tuple[FitParameter, ...],
        history: History,
        mean_deg: Floats,
    ) -> None:
        self.problem, self.noise, self.terms = problem, noise, terms
        self.fit_parameters = parameters
        self.slides = any(term.slips for term in terms)
        # Where the noise is error of the model, whole loops are fitted next, whose play is bounded.
        self._bounds_play = not (problem.one_sided or noise.structured)
        self.use = problem.fitted
        self.angle = problem.angle_deg[self.use]
        self.drags = any(term.effect is not None and term.effect.is_drag for term in terms)
        self.history = history if self.drags else history.with_state(drag_compliance=None)
        self.mean = mean_deg
        self._work_at(self.mean)

    def _work_at(self, mean: Floats) -> None:
        """Take the working data of the likelihood at a mean [deg]; they hold for one refinement."""
        self.target, self.weight = self.noise.residual(self.angle, mean[self.use])
        self._shifted = self.target + self.noise.design(mean[self.use], self.weight)
        self._known_path: tuple[History, Floats, tuple[object, ...], History] | None = None
        self._known_columns: dict[int, tuple[History, tuple[object, ...], Floats, Floats]] = {}

    def _terms_at(self, values: Floats) -> tuple[Term, ...]:
        """Terms with their nonlinear parameters at these values, in the fit's own scale."""
        shapes = [dict(term.shape) for term in self.terms]
        amplitudes = [term.amplitude for term in self.terms]
        for parameter, value in zip(self.fit_parameters, values, strict=True):
            if parameter.name == "amplitude":
                amplitudes[parameter.term] = parameter.to_physical(value)
            else:
                shapes[parameter.term][parameter.name] = parameter.to_physical(value)
        shapes = on_shared_elements([term.effect for term in self.terms], shapes)
        return tuple(
            term
            if shape == term.shape and amplitude == term.amplitude
            else replace(term, shape=shape, amplitude=amplitude)
            for term, shape, amplitude in zip(self.terms, shapes, amplitudes, strict=True)
        )

    def _design(
        self, terms: tuple[Term, ...], history: History
    ) -> tuple[list[Floats], Floats, Floats]:
        """Columns of the linear parameters, and the precision with which each is known before.

        Parameters
        ----------
        terms : tuple of Term
        history : History

        Returns
        -------
        columns : list of ndarray, shape (n, m)
            Side by side they are the k columns.
        white : ndarray, shape (fitted, k)
            The same on the fitted rows, whitened.
        hold : ndarray, shape (k,)
        """
        line = line_design(history, history.elastic_nm, one_sided=self.problem.one_sided)
        parts = [line]
        white = [self.noise.design(line[self.use], self.weight)]
        hold = [np.zeros(self.problem.line_columns)]
        for index, term in enumerate(terms):
            if term.slips:
                continue
            columns, whitened = self._columns(index, term, history)
            parts.append(columns)
            white.append(whitened)
            size = None if term.effect is None else term.effect.expected(history, term.shape)
            # Where rows count less for model error, what is expected does so too: it is to settle
            # what the rows leave open, and not to shrink what is large.
            factor = self.noise.model_error_factor
            hold.append(np.zeros(columns.shape[1]) if size is None else (factor * size) ** -2.0)
        return parts, np.concatenate(white, axis=1), np.concatenate(hold)

    def _columns(self, index: int, term: Term, history: History) -> tuple[Floats, Floats]:
        """Columns of a term and their whitened fitted rows, computed once a shape and path.

        Parameters
        ----------
        index : int
            Its place among the terms.
        term : Term
        history : History

        Returns
        -------
        columns : ndarray, shape (n, k)
        white : ndarray, shape (fitted, k)
        """
        shape = tuple(term.shape.items())
        known = self._known_columns.get(index)
        if known is not None and known[0] is history and known[1] == shape:
            return known[2], known[3]
        columns = term.columns(history)
        white = self.noise.design(columns[self.use], self.weight)
        self._known_columns[index] = (history, shape, columns, white)
        return columns, white

    def _path(self, terms: tuple[Term, ...], history: History, mean: Floats) -> History:
        """Path of the shaft, computed once for the same friction from the same state.

        Parameters
        ----------
        terms : tuple of Term
        history : History
            All rows in the state from which the path is solved.
        mean : ndarray, shape (n,)
            Modelled twist of all rows there [deg].

        Returns
        -------
        History
        """
        friction = tuple((t.amplitude, *t.shape.items()) for t in terms if t.slips)
        known = self._known_path
        if known is not None and known[0] is history and known[1] is mean and known[2] == friction:
            return known[3]
        path = friction_path(terms, history, mean)
        self._known_path = (history, mean, friction, path)
        return path

    def _solve_at(
        self,
        terms: tuple[Term, ...],
        history: History,
        mean: Floats,
    ) -> tuple[History, list[Floats], Floats, Floats]:
        """Solve path and linear parameters once, from a path and a mean.

        Parameters
        ----------
        terms : tuple of Term
        history : History
            All rows in the state from which the path is solved.
        mean : ndarray, shape (n,)
            Modelled twist of all rows there [deg].

        Returns
        -------
        history, design, white, beta
            Path, columns of the linear parameters, their whitened fitted rows, and the linear
            parameters.
        """
        if self.slides:
            history = self._path(terms, history, mean)
        design, white, hold = self._design(terms, history)
        beta = solve(white, self._shifted, hold)
        least = LEAST_BESIDE_SPRING * self.problem.history.compliance_deg_per_nm
        held = dict[int, float]()
        if beta[COMPLIANCE] < least and any(term.is_whole_spring for term in terms):
            # The line may be nothing beside such a spring; the simulation divides by it.
            held[COMPLIANCE] = least
        if self._bounds_play and beta[FREE_PLAY] < 0.0:
            # No play is negative; where a curve has taken its place it is nothing.
            held[FREE_PLAY] = 0.0
        if held:
            places = list(held)
            rest = self._shifted - white[:, places] @ np.array(list(held.values()))
            others = solve(np.delete(white, places, axis=1), rest, np.delete(hold, places))
            for place, value in held.items():
                others = np.insert(others, place, value)
            # Beside a wave of the angle the line itself may then have no stiffness.
            beta = others if others[COMPLIANCE] > 0.0 else beta
        return history, design, white, beta

    def _evaluate(self, values: Floats) -> tuple[History, Floats, Floats]:
        """Solve path and linear parameters in turn at these values of the nonlinear ones.

        Parameters
        ----------
        values : ndarray
            Nonlinear parameters, in the fit's own scale.

        Returns
        -------
        history, mean, beta
            Path of the shaft with the elastic law, modelled twist [deg], linear parameters.
        """
        terms = self._terms_at(values)
        history, mean = self.history, self.mean
        for _ in range(INNER if self.slides else 1):
            before = mean
            history, design, _, beta = self._solve_at(terms, history, mean)
            mean = np.concatenate(design, axis=1) @ beta
            history = self._calibrated(history, beta, mean)
            if self.drags:
                history = under_drag(terms, design, beta, history)
            law = path_law(elastic_parts(terms, design, beta), history)
            history = history.with_state(elastic_law=law)
            if self.slides:
                beyond = beyond_friction(terms, design, beta)
                history = history.with_state(angle_deg=history.held_deg + beyond, beyond_deg=beyond)
            if self._is_settled(before, mean):
                break
        return history, mean, beta

    def _is_settled(self, before: Floats, mean: Floats) -> bool:
        """Whether a round hardly changes the modelled twist of the fitted rows."""
        moved = np.sqrt(np.mean((mean - before)[self.use] ** 2))
        return bool(moved < SETTLED * self.noise.sigma_deg)

    def _calibrated(self, history: History, beta: Floats, mean: Floats) -> History:
        """Path of the shaft with the fitted line, and with the fitted twist where nothing slips.

        Parameters
        ----------
        history : History
        beta : ndarray
            Linear parameters.
        mean : ndarray, shape (n,)
            Modelled twist of all rows [deg].

        Returns
        -------
        History
        """
        play = history.free_play_deg if self.problem.one_sided else max(float(beta[FREE_PLAY]), 0.0)
        compliance = float(beta[COMPLIANCE])
        if compliance <= 0:
            compliance = history.compliance_deg_per_nm
        datum = float(beta[DATUM])
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
        """Working residual, path and linear parameters solved for these nonlinear ones."""
        terms = self._terms_at(values)
        _, _, white, beta = self._solve_at(terms, self.history, self.mean)
        self._last = (terms, white, beta)
        return self._shifted - white @ beta

    def expand_at(self, values: Floats) -> Expansion:
        """Move the point about which the likelihood is expanded to these nonlinear parameters."""
        exact = self.noise
        for level in _levels(exact):
            self.noise = exact.with_sigma(level)
            self._work_at(self.mean)
            for _ in range(EXPANDED if self.slides else EXPANDED_ON_A_LINE):
                history, mean, beta = self._evaluate(values)
                settled = self._is_settled(self.mean, mean)
                self.history, self.mean = history, mean
                self._follow_amplitudes(history, beta)
                self._work_at(mean)
                if settled:
                    break
        chi2 = float(self.target @ self.target)
        misfit = self.misfit_of(self.mean)
        return Expansion(chi2, misfit, values, self.history, self.mean, self.terms)

    def misfit_of(self, mean: Floats) -> float:
        """Twice the log likelihood that a modelled twist [deg] lacks to a perfect fit."""
        return self.noise.misfit(self.angle, mean[self.use])

    def return_to(self, before: Expansion) -> None:
        """Move the point back to one about which the likelihood was expanded before."""
        self.history, self.mean, self.terms = before.history, before.mean_deg, before.terms
        self._work_at(self.mean)

    def _follow_amplitudes(self, history: History, beta: Floats) -> None:
        """Compute shapes anew that depend on the amplitudes.

        Parameters
        ----------
        history : History
        beta : ndarray
            Linear parameters.
        """
        first, terms = self.problem.line_columns, []
        for term in self.terms:
            width = 0 if term.slips else term.columns(history).shape[1]
            if term.effect is not None and width:
                shape = term.effect.consistent(history, term.shape, beta[first : first + width])
                term = replace(term, shape=shape)
            terms.append(term)
            first += width
        self.terms = tuple(terms)

    def solution(self, values: Floats) -> tuple[tuple[Term, ...], Floats]:
        """Terms and linear parameters at these nonlinear ones."""
        self.residual(values)
        terms, _, beta = self._last
        return terms, beta

    def slopes(self, values: Floats) -> Floats:
        """Whitened derivative by all parameters, at these nonlinear ones: linear ones first."""
        residual = self.residual(values)
        _, white, beta = self._last
        slopes = []
        for k in range(len(values)):
            of = self.fit_parameters[k]
            step = 1e-3 * max(abs(values[k]), usual_change(of, values[k]))
            if values[k] + step > of.to_scale(of.quantity.upper):
                step = -step
            ahead = values.copy()
            ahead[k] += step
            change = residual - self.residual(ahead)
            # The linear parameters have followed; the derivative is at theirs held.
            slopes.append((change - white @ (self._last[2] - beta)) / step)
        return np.column_stack([white, *slopes]) if slopes else white


def _levels(noise: Noise) -> list[float]:
    """Sizes of noise from wide to exact: a coarse dial's likelihood has to be approached."""
    levels = [noise.sigma_deg]
    while noise.step_deg > 0 and levels[-1] < 0.25 * noise.step_deg:
        levels.append(1.8 * levels[-1])
    return levels[::-1]
