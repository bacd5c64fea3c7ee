"""A fitted simulation seen as a structure of the search: the same model, told the flank.

The tables of a diagnosis (sizes, bounds, places) rest on rows in contact and on the flank that the
recording shows. This evaluates the model of a `Forecast` there, without fitting anything anew.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.identify.fit import Fit
from cyclosweep.diagnosis.identify.fit_parameters import fit_parameters_of
from cyclosweep.diagnosis.prepare.noise import Noise, orthonormal
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.whole_loop.forecast import Forecast, at_start
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.simulate import Model, settle


@dataclass(frozen=True, eq=False)
class ForecastFit(Fit):
    """A `Fit` whose parameters are those of a simulation fitted to all rows.

    Attributes
    ----------
    forecast, before : Forecast
        The simulation, and that of the calibrated published model.
    """

    forecast: Forecast
    before: Forecast

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of all parameters, from the whole loop; few pieces of it are independent."""
        parameters = self.forecast.parameters
        spread = self.forecast.covariance
        order: list[int] = []
        kinds = ["datum", "compliance", "play"]
        for kind in kinds[: 2 if self.problem.one_sided else 3]:
            order.append(next(k for k, each in enumerate(parameters) if each.kind == kind))
        order += [k for k, each in enumerate(parameters) if each.kind == "amplitude"]
        order += [k for k, each in enumerate(parameters) if each.kind == "nonlinear"]
        scale = np.ones(len(order))
        for place, k in enumerate(order):
            if parameters[k].logarithmic and parameters[k].kind != "nonlinear":
                scale[place] = np.exp(self.forecast.values[k])
        return np.asarray(spread[np.ix_(order, order)] * np.outer(scale, scale))

    def contribution(self, index: int) -> Floats:
        """Twist that a term adds on all rows [deg]; friction shares out its torque by its limit."""
        term = self.terms[index]
        if not term.slips:
            return super().contribution(index)
        history = self.history
        load = np.abs(history.elastic_nm)
        limit = np.zeros(len(history))
        for other in self.terms:
            if other.slips:
                limit += other.amplitude * (load if other.name.startswith("load") else 1.0)
        own = term.amplitude * (load if term.name.startswith("load") else 1.0)
        share = np.divide(own, limit, out=np.zeros_like(limit), where=limit > 0)
        friction = history.applied_nm - history.elastic_nm
        return np.asarray(-history.compliance_deg_per_nm * share * friction)


def told_path(problem: Problem, model: Model) -> History:
    """Path by a model on all rows when the flank is told by the recording."""
    side = problem.history.side
    return settle(model, at_start(problem.history, model, side), told_side=side)


def told_fit(forecast: Forecast, before: Forecast, noise: Noise) -> ForecastFit:
    """Turn a forecast, and the one of the baseline, into a structure of the search."""
    problem = forecast.problem
    history = told_path(problem, forecast.model)
    use = problem.fitted
    _, weight = noise.residual(problem.angle_deg[use], history.angle_deg[use])
    parts = [np.ones((len(history), 1)), history.elastic_nm[:, None]]
    if not problem.one_sided:
        parts.append(history.side[:, None])
    parts += [term.columns(history) for term in forecast.terms if not term.slips]
    design = noise.design(np.column_stack(parts)[use], weight)
    kept = [k for k, each in enumerate(forecast.parameters) if each.kind == "nonlinear"]
    slopes = [noise.design(forecast.slope(k, told_path)[use], weight)[:, None] for k in kept]
    sensitivity = np.hstack([design, *slopes]) if slopes else design
    tangent = orthonormal(sensitivity, 1e-6)
    target = noise.residual(problem.angle_deg[use], history.angle_deg[use])[0]
    model = forecast.model
    beta = [model.datum_deg, model.compliance_deg_per_nm]
    if problem.one_sided:
        beta[0] += float(history.side[use][0]) * model.free_play_deg
    else:
        beta.append(model.free_play_deg)
    for term, value in zip(forecast.terms, model.effects, strict=True):
        beta += [] if term.slips else list(value.amplitudes)
    return ForecastFit(
        problem=problem,
        noise=noise,
        terms=forecast.terms,
        beta=np.array(beta),
        history=history,
        mean_deg=history.angle_deg,
        residual=target - tangent @ (tangent.T @ target),
        chi2=float(target @ target),
        tangent=tangent,
        sensitivity=sensitivity,
        shape_values=forecast.values[kept],
        fit_parameters=fit_parameters_of(forecast.terms, problem),
        forecast=forecast,
        before=before,
    )
