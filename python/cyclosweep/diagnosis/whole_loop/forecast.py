"""Fit of a model that predicts the whole loop, the crossings of the dead zone included.

Everywhere else the flank in contact is read off the recording. A forecast has to find it: the shaft
leaves a flank where the torque no longer overcomes friction, and that place, not the slope, decides
most of a forecast's error. Here the simulation itself is fitted to all rows, so that what is
written to ``model.json`` is what was fitted.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import least_squares

from cyclosweep.diagnosis.identify.fitting.covariance import covariance_of
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.whole_loop.model_parameters import (
    ModelParameter,
    model_parameters_of,
    values_of,
    with_values,
)
from cyclosweep.simulation.effects.history import Flags, Floats, History
from cyclosweep.simulation.simulate import SIMULATED_ROUNDS, Model, flanks_of, settle

FITTING_ROUNDS = 4
"""Rounds of effects that depend on more than the elastic torque, while fitting."""
LEAST_COMPLIANCE_DEG_PER_NM = 1e-300
"""What stands in for a line that falls, from which no simulation can start; the parameters' own
bounds come to bear on it."""
BLUR = 0.01
"""Blur of the last stage, see `fit_forecast`."""
STEP = 0.02
"""Step of a difference quotient in units of a parameter's scale. A crossing of the dead zone moves
by whole rows, so the step has to reach over several."""
LEAST = 1e-6
"""Least distance of a starting value from its bounds, as a share of the room between them."""
LEAST_TOLD = 1e-4
"""Singular value over the largest one below which the loop tells nothing of a direction."""


@dataclass(frozen=True, eq=False)
class Forecast:
    """A simulation fitted to all rows.

    Attributes
    ----------
    problem : Problem
        The recording.
    model : Model
        The simulation.
    terms : tuple of Term
        Its effects as terms of a structure.
    parameters : tuple of ModelParameter
        What was fitted.
    history : History
        All rows with the predicted path.
    values : ndarray
        Parameters in the fit's own scale, in the order of ``parameters``.
    jacobian : ndarray, shape (rows, p)
        Derivative of the prediction on the fitted rows [deg].
    rows : ndarray of bool, shape (n,)
        Rows that were fitted.
    """

    problem: Problem
    model: Model
    terms: tuple[Term, ...]
    parameters: tuple[ModelParameter, ...]
    values: Floats
    history: History
    jacobian: Floats
    rows: Flags

    @property
    def angle_deg(self) -> Floats:
        """Predicted twist of all rows [deg]."""
        return self.history.angle_deg

    @cached_property
    def error_deg(self) -> float:
        """Root mean square on the fitted rows [deg]."""
        return self.problem.rms_error(self.angle_deg, self.rows)

    @cached_property
    def covariance(self) -> Floats:
        """Covariance of the parameters in the fit's own scale.

        The residual repeats itself along the loop, so it tells far less than its rows.
        """
        return self.covariance_given(np.zeros(len(self.parameters)))

    def covariance_given(self, information: Floats) -> Floats:
        """Covariance of the parameters, where something is known of each besides.

        Parameters
        ----------
        information : ndarray, shape (k,)
            One over the variance of each as far as it is known, in the fit's own scale; zero
            where nothing is.

        Returns
        -------
        ndarray, shape (k, k)
        """
        repeated = max(len(self.jacobian) / INDEPENDENT_PIECES, 1.0)
        variance = self.error_deg**2 * repeated
        return variance * covariance_of(self.jacobian, information * variance, LEAST_TOLD)

    def slope(self, parameter: int, path: Callable[[Problem, Model], History]) -> Floats:
        """Derivative of the twist by a parameter, in the fit's own scale.

        Parameters
        ----------
        parameter : int
            Index among ``parameters``.
        path : callable
            From problem and simulation to the path of the shaft.

        Returns
        -------
        ndarray, shape (n,)
            For all rows [deg].
        """
        step = STEP * self.parameters[parameter].scale
        if self.values[parameter] + step > self.parameters[parameter].upper:
            step = -step
        ahead = self.values.copy()
        ahead[parameter] += step
        moved, _ = with_values(self.parameters, ahead, self.model, self.terms)
        there, here = path(self.problem, moved), path(self.problem, self.model)
        return np.asarray((there.angle_deg - here.angle_deg) / step)

    @property
    def has_zero(self) -> bool:
        """Whether the reading of torque without load was fitted."""
        return any(each.kind == "zero" for each in self.parameters)

    @property
    def names(self) -> frozenset[str]:
        """Names of the effects."""
        return frozenset(term.name for term in self.terms)


def starting_model(problem: Problem) -> Model:
    """Spring and free play as read off the recording, without effects."""
    history = problem.history
    return Model(
        compliance_deg_per_nm=max(history.compliance_deg_per_nm, LEAST_COMPLIANCE_DEG_PER_NM),
        free_play_deg=max(history.free_play_deg, 0.0),
        datum_deg=history.datum_deg,
        side=problem.recording.side,
        output_pin_count=history.output_pin_count,
        one_history=problem.one_history,
    )


def predicted_path(problem: Problem, model: Model, rounds: int = FITTING_ROUNDS) -> History:
    """Path of the shaft by a simulation along all rows of a problem.

    Parameters
    ----------
    problem : Problem
    model : Model
    rounds : int
        Most rounds of effects that depend on more than the elastic torque.

    Returns
    -------
    History
    """
    return settle(model, at_start(problem.history, model), rounds)


def at_start(history: History, model: Model, side: Floats | None = None) -> History:
    """Load history with the torque's zero taken out, in the state of the model's line alone.

    Parameters
    ----------
    history : History
    model : Model
    side : ndarray, shape (n,), optional
        Flank in contact, where it is read off a recording; default: by the sign of the torque,
        and without torque the last one.

    Returns
    -------
    History
    """
    history = history.zeroed(model.torque_zero_nm)
    if any(value.effect.slips for value in model.effects):
        # Found here, they are known to all states of this load.
        _ = history.corners
    applied = history.applied_nm
    side = flanks_of(applied, history.restart) if side is None else side
    return history.with_state(
        elastic_nm=applied,
        angle_deg=model.datum_deg
        + side * model.free_play_deg
        + model.compliance_deg_per_nm * applied,
        side=side,
        compliance_deg_per_nm=model.compliance_deg_per_nm,
        free_play_deg=model.free_play_deg,
        datum_deg=model.datum_deg,
    )


def fit_forecast(
    problem: Problem,
    model: Model,
    terms: Sequence[Term],
    *,
    zero: bool,
    rows: Flags | None = None,
    most: int = 25,
    blur: float = 0.0,
) -> Forecast:
    """Fit a simulation to rows, starting from a model of the same structure.

    Parameters
    ----------
    problem : Problem
    model : Model
        Starting values, its effects in the order of ``terms``.
    terms : sequence of Term
        Its effects with their shapes.
    zero : bool
        Whether the reading of torque without load is fitted.
    rows : ndarray of bool, optional
        Rows to fit; default: all that count, crossings included.
    most : int
        Most iterations.
    blur : float
        Share of the largest torque by which the torque is also shifted up and down: a crossing
        that fits by the accident of one row then counts for less.

    Returns
    -------
    Forecast
    """
    rows = problem.whole_fitted if rows is None else rows
    terms = tuple(terms)
    parameters = model_parameters_of(problem, terms, zero=zero)
    weight = np.sqrt(problem.weight[rows] / problem.weight[rows].mean())
    measured = problem.angle_deg[rows]
    lower = np.array([k.lower for k in parameters])
    upper = np.array([k.upper for k in parameters])
    scale = np.array([k.scale for k in parameters])
    room = np.minimum(upper - lower, 1e6)
    first = np.clip(values_of(parameters, model, terms), lower + LEAST * room, upper - LEAST * room)

    top = problem.history.largest_torque_nm
    shifts = (0.0,) if blur == 0.0 else (0.0, -blur * top, blur * top)

    last: tuple[Floats, Floats] | None = None

    def residual(values: Floats) -> Floats:
        nonlocal last
        if last is not None and np.array_equal(last[0], values):
            # The solver asks for the slopes where it has asked for the residual.
            return last[1]
        moved, _ = with_values(parameters, values, model, terms)
        parts = []
        for shift in shifts:
            shifted = replace(moved, torque_zero_nm=moved.torque_zero_nm + shift)
            parts.append((predicted_path(problem, shifted).angle_deg[rows] - measured) * weight)
        found = np.asarray(np.concatenate(parts) / np.sqrt(len(shifts)))
        last = values.copy(), found
        return found

    def slopes(values: Floats) -> Floats:
        at = residual(values)
        out = np.empty((len(at), len(values)))
        for k in range(len(values)):
            step = STEP * scale[k]
            if values[k] + step > upper[k]:
                step = -step
            ahead = values.copy()
            ahead[k] += step
            out[:, k] = (residual(ahead) - at) / step
        return out

    found = least_squares(
        residual, first, jac=slopes, bounds=(lower, upper), x_scale=scale, max_nfev=most,
        ftol=1e-4, xtol=1e-4,
    )  # fmt: skip
    moved, shaped = with_values(parameters, found.x, model, terms)
    return Forecast(
        problem=problem,
        model=moved,
        terms=shaped,
        parameters=parameters,
        values=found.x,
        history=predicted_path(problem, moved, SIMULATED_ROUNDS),
        jacobian=np.asarray(found.jac)[: len(weight)] * np.sqrt(len(shifts)) / weight[:, None],
        rows=rows,
    )


def refit(known: Forecast, *, rows: Flags | None = None, most: int, blur: float = 0.0) -> Forecast:
    """Fit the same structure again, on other rows, for longer or blurred.

    Parameters
    ----------
    known : Forecast
        From which the fit starts.
    rows : ndarray of bool, shape (n,), optional
        Rows to fit; default: all that count, crossings included.
    most : int
        Most iterations.
    blur : float
        See `fit_forecast`.

    Returns
    -------
    Forecast
    """
    return fit_forecast(
        known.problem,
        known.model,
        known.terms,
        zero=known.has_zero,
        rows=rows,
        most=most,
        blur=blur,
    )
