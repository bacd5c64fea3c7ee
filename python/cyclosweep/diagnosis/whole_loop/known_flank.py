"""A simulation fitted to whole loops, offered to the diagnosis as a fitted structure.

The tables of a diagnosis (sizes, bounds, places) rest on rows in contact and on the flank that the
recording shows. This evaluates the model of a `Forecast` there, without fitting anything anew.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit_parameters import fit_parameters_of
from cyclosweep.diagnosis.identify.fitting.fit_state import Linearisation
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.friction_reached import friction_torque_nm
from cyclosweep.diagnosis.identify.fitting.prediction import (
    KnownFlankPrediction,
    LeftOutPrediction,
    Prediction,
)
from cyclosweep.diagnosis.identify.fitting.repetition import Repetition
from cyclosweep.diagnosis.identify.stages.stage import FAINT
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES, Noise
from cyclosweep.diagnosis.prepare.problem import DATUM, Problem, line_design
from cyclosweep.diagnosis.prepare.split import KEPT_RUNS, STRETCHES_OF_LOOPS, stretches
from cyclosweep.diagnosis.prepare.torque_zero import TorqueZero
from cyclosweep.diagnosis.whole_loop.findings import findings, hidden_by_friction
from cyclosweep.diagnosis.whole_loop.forecast import Forecast, at_start, fit_forecast, refit
from cyclosweep.diagnosis.whole_loop.run_comparison import steadiness
from cyclosweep.result import Finding
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.simulate import Model, settle

FEW_STEPS = 5
"""Iterations of the fit of a part of a simulation, which starts from the whole."""


@dataclass(frozen=True, eq=False)
class WholeLoopFit(FittedStructure):
    """A structure whose parameters are those of a simulation fitted to all rows.

    Attributes
    ----------
    forecast, before : Forecast
        The simulation, and that of the calibrated published model.
    """

    forecast: Forecast
    before: Forecast

    @property
    def prediction(self) -> Prediction:
        """Twist of all rows, crossings of the dead zone included."""
        return Prediction(self.forecast.angle_deg, self.forecast.error_deg, "whole loops")

    @property
    def prediction_path(self) -> History:
        """Path of the shaft by the simulation, which finds the flank for itself."""
        return self.forecast.history

    def baseline_prediction(self, baseline: FittedStructure) -> Prediction:
        """Twist of all rows by the published model calibrated on whole loops.

        The ``baseline`` fitted to rows in contact is not needed.
        """
        return Prediction(self.before.angle_deg, self.before.error_deg, "whole loops")

    @property
    def independent_share(self) -> float:
        """A small share: the residual repeats itself along the loop."""
        return min(INDEPENDENT_PIECES / max(self.problem.count, 1), 1.0)

    @property
    def line_errors(self) -> Floats:
        """Standard errors of datum [deg], compliance [deg/(N m)] and free play [deg]."""
        return self.standard_errors[: self.problem.line_columns]

    @property
    def torque_zero(self) -> TorqueZero | None:
        """Torque read without load, as the crossings of the dead zone show it."""
        if not self.forecast.has_zero:
            return self.problem.torque_zero
        parameters = self.forecast.parameters
        zero = next(k for k, each in enumerate(parameters) if each.kind == "zero")
        variance = self.forecast.covariance[zero, zero]
        value_nm = self.forecast.model.torque_zero_nm + self.problem.zero_nm
        return TorqueZero(value_nm, float(np.sqrt(max(variance, 0.0))))

    def follows_path(self, index: int) -> bool:
        """All terms: the flank in contact itself follows from the path of the shaft."""
        return True

    def only(self, names: Collection[str]) -> "WholeLoopFit":
        """Fit some of the effects alone, as a simulation, to all rows.

        Parameters
        ----------
        names : collection of str
            Names of the effects.

        Returns
        -------
        WholeLoopFit
        """
        whole = self.forecast
        kept = [k for k, term in enumerate(self.terms) if term.name in names]
        model = replace(whole.model, effects=tuple(whole.model.effects[k] for k in kept))
        terms = tuple(whole.terms[k] for k in kept)
        alone = fit_forecast(self.problem, model, terms, zero=whole.has_zero, most=FEW_STEPS)
        return whole_loop_fit(alone, self.before, self.noise)

    def model(self, drive: str) -> Model:
        """Return the simulation that was fitted, for a drive of this name."""
        return replace(self.forecast.model, drive=drive)

    def predict_left_out(self) -> list[LeftOutPrediction]:
        """Predict the runs kept for it, or stretches of the fitted ones left out in turn."""
        problem = self.problem
        kept_runs = bool(np.any(problem.whole_held_out))
        parts = [(KEPT_RUNS, problem.whole_held_out)]
        if not kept_runs:
            parts = stretches(problem.whole_fitted, STRETCHES_OF_LOOPS)
        found = []
        for label, rows in parts:
            before, after = self.before, self.forecast
            if not kept_runs:
                others = problem.whole_fitted & ~rows
                before = refit(before, rows=others, most=6)
                after = refit(after, rows=others, most=6)
            known = KnownFlankPrediction(
                rows & (problem.held_out if kept_runs else problem.fitted),
                known_flank_path(problem, before.model).angle_deg,
                known_flank_path(problem, after.model).angle_deg,
            )
            found.append(
                LeftOutPrediction(
                    label, rows, kept_runs, before.angle_deg, after.angle_deg, np.nan, known
                )
            )
        return found

    def left_out_evidence(
        self, predictions: Sequence[LeftOutPrediction], baseline_deg: float, structure_deg: float
    ) -> float:
        """Likelihood ratio of as many independent errors as such a residual has pieces.

        Parameters
        ----------
        predictions : sequence of LeftOutPrediction
            Not needed.
        baseline_deg, structure_deg : float
            Root mean square errors over all of them [deg].

        Returns
        -------
        float
            At least so many times likelier.
        """
        ratio = float(np.log(baseline_deg / max(structure_deg, 1e-12)))
        return float(np.exp(min(INDEPENDENT_PIECES * ratio, 200.0)))

    def run_to_run_errors(self) -> list[tuple[float, float]]:
        """Errors of single-run fits: on their own run, and on the worst of its replicates [deg]."""
        return [(each.own_deg, each.other_deg) for each in steadiness(self.forecast)]

    @property
    def hidden_play(self) -> str | None:
        """Why play and stiffness cannot be read: friction hardly let the shaft go."""
        return hidden_by_friction(self.problem, self.forecast)

    def findings(self, repeats: Repetition | None, *, unsteady: bool) -> tuple[Finding, ...]:
        """Return topics and sentences on the measured loop.

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
        errors = np.sqrt(np.maximum(np.diag(self.covariance_within_bounds), 0.0))
        limits = {
            self.terms[each.term].name: float(errors[len(self.beta) + k])
            for k, each in enumerate(self.fit_parameters)
            if each.name == "amplitude"
        }
        return findings(self.forecast, repeats, limits, unsteady=unsteady)

    @cached_property
    def _in_order(self) -> tuple[list[int], Floats]:
        """Place of each parameter of the structure in the simulation, and its scale there."""
        parameters = self.forecast.parameters
        order: list[int] = []
        kinds = ["datum", "compliance", "play"]
        for kind in kinds[: self.problem.line_columns]:
            order.append(next(k for k, each in enumerate(parameters) if each.kind == kind))
        order += [k for k, each in enumerate(parameters) if each.kind == "amplitude"]
        order += [k for k, each in enumerate(parameters) if each.kind == "nonlinear"]
        scale = np.ones(len(order))
        for place, k in enumerate(order):
            if parameters[k].logarithmic and parameters[k].kind != "nonlinear":
                scale[place] = np.exp(self.forecast.values[k])
        return order, scale

    def covariance_given(self, information: Floats) -> Floats:
        """Covariance of all parameters, from the whole loop; few pieces of it are independent.

        Parameters
        ----------
        information : ndarray, shape (k,)
            One over the variance of each as far as it is known besides, linear ones first; zero
            where nothing is.

        Returns
        -------
        ndarray, shape (k, k)
        """
        order, scale = self._in_order
        known = np.zeros(len(self.forecast.parameters))
        known[order] = information * scale**2
        spread = self.forecast.covariance_given(known)
        return np.asarray(spread[np.ix_(order, order)] * np.outer(scale, scale))

    def contribution(self, index: int) -> Floats:
        """Twist that a term adds on all rows [deg]; friction shares out its torque by its limit."""
        term = self.terms[index]
        if not term.slips:
            return super().contribution(index)
        taken = friction_torque_nm(self.terms, self.history, index)
        return np.asarray(-self.history.compliance_deg_per_nm * taken)


def known_flank_path(problem: Problem, model: Model) -> History:
    """Path of the shaft by a simulation, the flank in contact read off the recording.

    Parameters
    ----------
    problem : Problem
    model : Model

    Returns
    -------
    History
        All rows.
    """
    side = problem.history.side
    return settle(model, at_start(problem.history, model, side), known_side=side)


def noise_beside(forecast: Forecast, noise: Noise) -> Noise:
    """Noise, with model error that accounts for what a simulation leaves on the flanks.

    A structure fitted to the flanks alone may leave less there than any simulation of the loop, so
    that the model error of its search is too small for the simulation.

    Parameters
    ----------
    forecast : Forecast
        The simulation.
    noise : Noise
        Noise of the search; it may hold model error already.

    Returns
    -------
    Noise
    """
    problem = forecast.problem
    use = problem.fitted
    path = known_flank_path(problem, forecast.model)
    left = noise.plain.residual(problem.angle_deg[use], path.angle_deg[use])[0]
    # Where model error was added, noise alone is a small part of the unit variance.
    share = 1.0 / noise.model_error_factor**2
    beyond = max(float(left @ left) - share * (len(left) + FAINT**2), 0.0)
    return noise.with_model_error(float(np.sqrt(share + beyond / INDEPENDENT_PIECES)))


def whole_loop_fit(forecast: Forecast, before: Forecast, noise: Noise) -> WholeLoopFit:
    """Offer a fitted simulation as a fitted structure.

    Parameters
    ----------
    forecast : Forecast
        The simulation.
    before : Forecast
        That of the published model, calibrated in the same way.
    noise : Noise
        Noise by which residual and sensitivities are whitened.

    Returns
    -------
    WholeLoopFit
    """
    problem = forecast.problem
    history = known_flank_path(problem, forecast.model)
    use = problem.fitted
    _, weight = noise.residual(problem.angle_deg[use], history.angle_deg[use])
    parts = [line_design(history, history.elastic_nm, one_sided=problem.one_sided)]
    parts += [term.columns(history) for term in forecast.terms if not term.slips]
    design = noise.design(np.column_stack(parts)[use], weight)
    kept = [k for k, each in enumerate(forecast.parameters) if each.kind == "nonlinear"]
    judged = {(forecast.parameters[k].term, forecast.parameters[k].name) for k in kept}

    def sensitivity() -> Floats:
        slopes = [
            noise.design(forecast.slope(k, known_flank_path)[use], weight)[:, None] for k in kept
        ]
        return np.hstack([design, *slopes])

    target = noise.residual(problem.angle_deg[use], history.angle_deg[use])[0]
    model = forecast.model
    beta = [model.datum_deg, model.compliance_deg_per_nm]
    if problem.one_sided:
        beta[DATUM] += float(history.side[use][0]) * model.free_play_deg
    else:
        beta.append(model.free_play_deg)
    for term, value in zip(forecast.terms, model.effects, strict=True):
        beta += [] if term.slips else list(value.amplitudes)
    return WholeLoopFit(
        problem=problem,
        noise=noise,
        terms=forecast.terms,
        beta=np.array(beta),
        history=history,
        mean_deg=history.angle_deg,
        chi2=float(target @ target),
        linearisation=Linearisation(target, sensitivity),
        fit_parameters=tuple(
            each
            for each in fit_parameters_of(forecast.terms, problem)
            if (each.term, each.name) in judged
        ),
        forecast=forecast,
        before=before,
    )
