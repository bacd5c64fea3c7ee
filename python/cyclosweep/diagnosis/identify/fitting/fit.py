"""Fit of the calibration and any set of terms to the rows in contact, by maximum likelihood."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit_parameters import fit_parameters_of
from cyclosweep.diagnosis.identify.fitting.fit_state import Linearisation
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.joint_fit import JointFit
from cyclosweep.diagnosis.identify.fitting.path_law import path_law
from cyclosweep.diagnosis.identify.fitting.prediction import (
    LeftOutPrediction,
    Prediction,
)
from cyclosweep.diagnosis.identify.fitting.refine import refine
from cyclosweep.diagnosis.identify.fitting.repetition import Repetition
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES, Noise
from cyclosweep.diagnosis.prepare.problem import Problem, gaps
from cyclosweep.diagnosis.prepare.split import KEPT_RUNS, folds, restrict
from cyclosweep.diagnosis.prepare.torque_zero import TorqueZero
from cyclosweep.result import Finding
from cyclosweep.simulation.effects.history import Flags, Floats
from cyclosweep.simulation.simulate import EffectValue, Model

FEWEST_FITTED = 6
"""Fewer readings in contact than this cannot even calibrate the baseline."""


@dataclass(frozen=True, eq=False)
class ContactFit(FittedStructure):
    """A structure fitted to the rows in contact, each on the flank that the recording shows."""

    @property
    def prediction(self) -> Prediction:
        """Twist of all rows on the recorded flank."""
        return Prediction(self.mean_deg, self.rmse_deg, "readings in contact")

    def baseline_prediction(self, baseline: FittedStructure) -> Prediction:
        """Twist of all rows by the calibrated published model on the recorded flank."""
        return baseline.prediction

    @cached_property
    def loss(self) -> float:
        """Twice the log likelihood that the fit lacks to a perfect one."""
        if not self.noise.forgets_far_off:
            return self.chi2
        use = self.problem.fitted
        return self.noise.misfit(self.problem.angle_deg[use], self.mean_deg[use])

    @property
    def independent_share(self) -> float:
        """One: all rows count, because the residual is whitened."""
        return 1.0

    @property
    def line_errors(self) -> Floats:
        """Standard errors of datum [deg], compliance [deg/(N m)] and free play [deg]."""
        spread = self.standard_errors
        if self.noise.structured:
            spread = spread * np.sqrt(max(self.problem.count / INDEPENDENT_PIECES, 1.0))
        return np.asarray(spread[: self.problem.line_columns])

    @property
    def torque_zero(self) -> TorqueZero | None:
        """What was taken off the torques; on a straight flank it is a shift of the datum."""
        return self.problem.torque_zero

    def follows_path(self, index: int) -> bool:
        """Whether a term is friction, which moves the path on which it is solved."""
        return self.terms[index].slips

    def model(self, drive: str) -> Model:
        """Return the structure as a simulation of a drive of this name."""
        values, notes = [], list[str]()
        for index, term in enumerate(self.terms):
            shape = term.shape
            notes += term.place_in_words
            amplitudes: Sequence[float] = (term.amplitude,)
            if not term.slips:
                assert term.effect is not None
                found = self.beta[self.column_range(index)]
                notes += term.effect.notes(self.history, shape, found)
                shape, amplitudes = term.effect.portable(self.history, shape, found)
            plain = {name: float(value) for name, value in shape.items()}
            values.append(
                EffectValue(term.name, plain, tuple(map(float, amplitudes)), term.in_series)
            )
        return Model(
            compliance_deg_per_nm=self.line_compliance_deg_per_nm,
            free_play_deg=self.history.free_play_deg,
            datum_deg=self.history.datum_deg,
            side=self.problem.recording.side,
            effects=tuple(values),
            output_pin_count=self.history.output_pin_count,
            drive=drive,
            notes=tuple(notes),
            one_history=self.problem.one_history,
        )

    def predict_left_out(self) -> list[LeftOutPrediction]:
        """Fit baseline and structure without each block of rows, and predict it.

        The blocks are the runs kept for it, or parts of the fitted rows in turn.
        """
        problem, noise = self.problem, self.noise
        kept_runs = bool(np.any(problem.held_out))
        parts = [(KEPT_RUNS, problem.held_out)] if kept_runs else folds(problem)
        terms = [self._foreseen(index) or term for index, term in enumerate(self.terms)]
        found = []
        for label, rows in parts:
            train, train_noise = (problem, noise) if kept_runs else restrict(problem, noise, ~rows)
            if train.count < FEWEST_FITTED or not np.any(train.held_out):
                continue
            base = fit(train, train_noise, ())
            repaired = base
            if self.terms:
                repaired = fit(train, train_noise, terms, self, rounds=4)
            held, mean = train.held_out, repaired.mean_deg + self._unforeseen(repaired, train)
            ratio = _log_likelihood_ratio(problem, noise, mean, held)
            found.append(LeftOutPrediction(label, held, kept_runs, base.mean_deg, mean, ratio))
        return found

    def _foreseen(self, index: int) -> Term | None:
        """Term as a simulation takes it to other runs: offsets of runs by the law they follow.

        The law was chosen by all runs; its size is fitted to those that are not left out.

        Parameters
        ----------
        index : int
            Which term.

        Returns
        -------
        Term or None
            None where nothing tells it of other runs.
        """
        term = self.terms[index]
        if term.effect is None or term.slips:
            return term
        known = self.beta[self.column_range(index)]
        shape, _ = term.effect.portable(self.history, term.shape, known)
        told = bool(np.any(term.effect.columns(self.history, shape)))
        return replace(term, shape=shape) if told else None

    def _unforeseen(self, repaired: "ContactFit", train: Problem) -> Floats:
        """Put the mean of the fitted rows for what no prediction can tell of other runs.

        An erratic datum has an offset for each run that was fitted, and none for a new one.

        Parameters
        ----------
        repaired : ContactFit
            The structure fitted to a part of the recording.
        train : Problem
            That part.

        Returns
        -------
        ndarray, shape (n,)
            What is added to the twist of the part that was left out [deg].
        """
        change = np.zeros(len(self.history))
        for index in range(len(self.terms)):
            if self._foreseen(index) is not None:
                continue
            part = repaired.terms[index].columns(repaired.history)
            twist = part @ repaired.beta[repaired.column_range(index)]
            change[train.held_out] += twist[train.fitted].mean() - twist[train.held_out]
        return change

    def left_out_evidence(
        self, predictions: Sequence[LeftOutPrediction], baseline_deg: float, structure_deg: float
    ) -> float:
        """Average over the blocks of the likelihood ratio against a baseline fitted to the block.

        Valid whatever was searched (universal inference, Wasserman, Ramdas, Balakrishnan, PNAS
        2020). The errors themselves are not needed.

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
        if not self.terms:
            return 1.0
        ratios = [each.log_likelihood_ratio for each in predictions]
        return float(np.mean(np.exp(np.minimum(ratios, 200.0))))

    def run_to_run_errors(self) -> list[tuple[float, float]]:
        """Nothing: on a known flank, drift from run to run is an effect like others."""
        return []

    def findings(self, repeats: Repetition | None, *, unsteady: bool) -> tuple[Finding, ...]:
        """Nothing: a loop is described only where it is predicted as a whole.

        Parameters
        ----------
        repeats : Repetition, optional
            Not needed.
        unsteady : bool
            Not needed.

        Returns
        -------
        tuple of Finding
        """
        return ()


def fit(
    problem: Problem,
    noise: Noise,
    terms: Sequence[Term],
    start: FittedStructure | None = None,
    *,
    rounds: int = 6,
    rival: FittedStructure | None = None,
) -> ContactFit:
    """Fit baseline and terms jointly by maximum likelihood.

    Parameters
    ----------
    problem : Problem
        The recording.
    noise : Noise
        Noise of its fitted rows.
    terms : sequence of Term
        With the shapes (and friction amplitudes) from which the search starts.
    start : FittedStructure, optional
        A fit of a similar structure, whose path the iteration starts from.
    rounds : int
        Most iterations of the refinement.
    rival : FittedStructure, optional
        A fit that this one is to come near, else it is given up early, see `refine.HOPELESS`.

    Returns
    -------
    ContactFit
    """
    terms = tuple(terms)
    parameters = fit_parameters_of(terms, problem)
    history = problem.history if start is None else start.history
    mean = history.angle_deg if start is None else start.mean_deg
    # A model that is told the measured angle explains it by itself: it has to find the position.
    history = history.with_state(measured_deg=None)
    if start is not None and not any(term.slips for term in terms):
        history = history.with_state(elastic_nm=history.applied_nm, angle_deg=mean, beyond_deg=0.0)
    if start is not None:
        history = history.with_state(elastic_law=path_law(start.elastic_parts, start.history))
    work = JointFit(problem, noise, terms, parameters, history, mean)
    values = np.array([each.to_scale(_value(terms[each.term], each.name)) for each in parameters])
    if len(parameters):
        lower = np.array([each.to_scale(each.quantity.lower) for each in parameters])
        upper = np.array([each.to_scale(each.quantity.upper) for each in parameters])
        lower = np.where(np.isneginf(lower), -1e6, lower)
        width = np.minimum(upper - lower, 1e6)
        values = np.clip(values, lower + 1e-6 * width, upper - 1e-6 * width)
        near = np.inf if rival is None else work.misfit_of(rival.mean_deg)
        values = refine(work, values, (lower, upper), rounds, near)
    else:
        work.expand_at(values)
    found, beta = work.solution(values)
    return ContactFit(
        problem=problem,
        noise=work.noise,
        terms=found,
        beta=beta,
        history=work.history,
        mean_deg=work.mean,
        chi2=float(work.target @ work.target),
        linearisation=Linearisation(work.target, partial(work.slopes, values)),
        fit_parameters=parameters,
    )


def _value(term: Term, name: str) -> float:
    """Value of a nonlinear parameter of a term.

    Parameters
    ----------
    term : Term
    name : str
        Name of a shape parameter, or ``"amplitude"``.

    Returns
    -------
    float
    """
    return term.amplitude if name == "amplitude" else float(term.shape[name])


def _log_likelihood_ratio(problem: Problem, noise: Noise, mean: Floats, held: Flags) -> float:
    """Log likelihood of a block under the trained model over that of its own best baseline.

    Parameters
    ----------
    problem : Problem
    noise : Noise
    mean : ndarray, shape (n,)
        Twist of all rows by the trained model [deg].
    held : ndarray of bool, shape (n,)
        Rows of the block.

    Returns
    -------
    float
        In nat.
    """
    gap = gaps(held, problem.history.run, None if noise.by_rows else problem.history.time_s)
    block = replace(problem, fitted=held, held_out=~held, gap=gap)
    local = replace(noise, gap=gap[held])
    null = fit(block, local, ())
    trained, _ = local.residual(problem.angle_deg[held], mean[held])
    return 0.5 * (null.chi2 - float(trained @ trained))
