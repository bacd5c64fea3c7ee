"""Search for the set of effects that explains a recording, each refitted with the baseline."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.hypotheses.sinusoid import find_sinusoid
from cyclosweep.diagnosis.identify.fitting.cancelling import cancel
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.alarm import Alarm
from cyclosweep.diagnosis.identify.structures.candidate import (
    FURTHER,
    Candidate,
    added_evidence,
    prior_penalty,
)
from cyclosweep.diagnosis.identify.structures.drag_and_friction import begun_together
from cyclosweep.diagnosis.identify.structures.enrichment import richer_structures
from cyclosweep.diagnosis.identify.structures.freer_part import freer_part
from cyclosweep.diagnosis.identify.structures.placement import best_placed
from cyclosweep.diagnosis.identify.structures.scan import Scan, evidence, likelihood_gain, scan
from cyclosweep.diagnosis.identify.structures.starting_terms import starting_terms
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.simulation.effects.history import Floats

SHAPE_ERROR = 0.05
"""Share of an effect's own visibility below which a remainder is taken for error of its shape:
no model of an effect is exact, and large effects show it."""
MOST_SHAPE_ERROR = 20.0
"""Evidence up to which a remainder is so taken; a further effect of signal-to-noise 7 has more."""
MOST_ENRICHED = 2
"""Times an effect is given more freedom of shape."""
USUAL_ROUNDS, RICH_ROUNDS = 6, 20
"""Most iterations of the fit of an effect with more freedom, beside friction and otherwise."""
MOST_TERMS = 3
"""Effects up to which alternatives are searched in breadth; beyond, the best is followed."""
MOST_FOLLOWED = 7
"""Effects up to which the best structure is followed."""


class Search:
    """Search of one recording: its noise, its whitened library and the structures visited.

    Parameters
    ----------
    problem : Problem
        The recording.
    noise : Noise
        Noise of its fitted rows.
    library : Library
        All hypotheses, as columns on the fitted rows.
    seed : int
        Seed of every random draw.
    accepted : FittedStructure, optional
        What every structure contains, as it was fitted before.

    Attributes
    ----------
    flexible : ndarray, shape (fitted, k), or None
        Columns of a flexible model, where the calibration has set them.
    baseline : Candidate
        The calibrated published model without effects.
    start : Candidate
        The structure that is searched from: the baseline with the accepted terms.
    alarm : Alarm
        Calibration of the global test.
    whitened : ndarray, shape (fitted, k)
        Whitened columns of the library.
    visited : dict of frozenset of str to Candidate
        The best fit of each structure, by the names of its terms.
    tried : set of (Candidate, str)
        Structures, each with a hypothesis by which it was extended.
    not_extended : frozenset of frozenset of str
        Structures, by their names, that are not worth to be extended.
    chosen : Candidate or None
        The structure chosen on whole loops; None where structures are compared by their evidence.
    rivals_of_start : list of (Candidate, probability)
        Other explanations than the structure that is searched from, from the stages before.
    """

    def __init__(
        self,
        problem: Problem,
        noise: Noise,
        library: Library,
        seed: int,
        accepted: FittedStructure | None = None,
    ) -> None:
        self.problem, self.noise, self.library = problem, noise, library
        self.seed = seed
        base = fit(problem, noise, ())
        self.whitened = base.whitened(library.columns, noise)
        self.gram = self.whitened.T @ self.whitened
        first = base
        if accepted is not None and accepted.terms:
            first = fit(problem, noise, accepted.terms, accepted)
            if not first.valid:
                # Under other noise an amplitude may change its sign: such an effect is left out.
                right = [t for k, t in enumerate(first.terms) if not first.wrong_signs(k).any()]
                first = with_right_signs(first, whole_effects=True) or (
                    fit(problem, noise, right, first) if right else base
                )
        self.alarm = Alarm(self._scan(first), seed)
        self.baseline = self.start = self.judged(base, 0.0, 0.0)
        self.visited: dict[frozenset[str], Candidate] = {}
        if first is not base:
            self.start = self.judged(first, 0.0, 0.0)
            self.visited[self.start.names] = self.start
        self.tried: set[tuple[Candidate, str]] = set()
        self.not_extended: frozenset[frozenset[str]] = frozenset()
        self.chosen: Candidate | None = None
        self.flexible: Floats | None = None
        self.rivals_of_start: list[tuple[Candidate, float]] = []

    @property
    def threshold(self) -> float:
        """Excess of the evidence beyond which something is said to be missing [nat]."""
        return self.alarm.threshold

    def run(self, progress: Callable[[str], None] = lambda text: None) -> None:
        """Visit structures: in breadth up to three terms, then along the best; say which."""
        if self.start.largest_excess < self.threshold:
            return
        front = [self.start]
        for depth in range(MOST_TERMS):
            found: list[Candidate] = []
            for parent in (n for n in front if n.names not in self.not_extended):
                for name in parent.hypotheses_to_add(6 if depth == 0 else 3, 3 - depth):
                    if parent.names | {name} in self.visited and depth:
                        continue
                    progress(f"fitting {' + '.join([*parent.fit.names, name])}")
                    child = self.extend(parent, name)
                    if child is not None:
                        found.append(child)
            # Once effects are accepted, what is not likelier with its charges is not extended.
            found = [n for n in found if not self.start.fit.terms or n.score > self.start.score]
            if not found:
                break
            found = list({n.names: n for n in sorted(found, key=lambda n: n.score)}.values())
            found.sort(key=lambda n: -n.score)
            named = [n for n in found if n.all_recognised]
            front = found[: 3 - (depth > 0)]
            front += [n for n in named[: 3 - depth] if all(n is not f for f in front)]
        self._visit_parts()
        self._follow(progress)

    def explanations(self) -> list[Candidate]:
        """Structures worth considering: those that contain a sufficient smaller one are not."""
        enough = [n for n in self.visited.values() if self.suffices(n)]
        kept = [
            n
            for n in self.visited.values()
            if not any(e.names < n.names and n.score < e.score + self._room(e) for e in enough)
        ]
        return sorted(kept, key=lambda n: -n.score)

    def best(self) -> Candidate | None:
        """Structure with the largest posterior odds."""
        return max(self.explanations(), key=lambda n: n.score, default=None)

    def suffices(self, candidate: Candidate) -> bool:
        """Whether a structure leaves nothing but noise, or what its own inexactness explains."""
        return candidate.largest_excess < self._room(candidate)

    def null(self, candidate: Candidate) -> Floats:
        """Largest excess of recordings in which this structure is all there is, shape (draws,)."""
        if candidate is self.baseline:
            return self.alarm.maxima
        return self.alarm.null(candidate.scan, np.random.default_rng([self.seed, 1]))

    def add(self, fitted: FittedStructure, gain: float) -> Candidate:
        """Add a structure that was fitted elsewhere to those visited.

        Parameters
        ----------
        fitted : FittedStructure
        gain : float
            Its log evidence over the baseline [nat].

        Returns
        -------
        Candidate
        """
        candidate = self.judged(fitted, gain, 0.0)
        self.visited[candidate.names] = candidate
        return candidate

    def refit(self, terms: tuple[Term, ...], before: FittedStructure) -> Candidate:
        """Fit a structure on its own, from a fit with more terms; its score compares with none."""
        return self.judged(fit(self.problem, self.noise, terms, before), 0.0, 0.0)

    def extend(self, parent: Candidate, hypothesis: str) -> Candidate | None:
        """Add one hypothesis to a structure and refit.

        Parameters
        ----------
        parent : Candidate
        hypothesis : str
            Name of an effect, or family of an unnamed shape.

        Returns
        -------
        Candidate or None
            None where no fit is better and has amplitudes of the sign that physics asks for.
        """
        self.tried.add((parent, hypothesis))
        best: Candidate | None = None
        for term, rank, penalty in starting_terms(parent, hypothesis):
            terms = (*parent.fit.terms, term)
            fitted = fit(self.problem, self.noise, terms, parent.fit, rival=parent.fit)
            joint: FittedStructure | None = with_right_signs(fitted)
            if joint is not None and term.slips:
                joint = best_placed(joint)
            if joint is not None:
                joint = begun_together(joint, parent.fit)
            # One more term fits no worse, unless the fit has ended in a bad optimum.
            if joint is None or joint.loss > parent.fit.loss or cancel(joint, self.baseline.fit):
                continue
            chi2_gain = self._further_chi2(parent.fit, joint)
            added = added_evidence(chi2_gain, joint, parent.scan, rank, penalty)
            prior = parent.prior - (FURTHER if parent.fit.terms else 0.0)
            prior -= prior_penalty(term.name, term.effect, term.shape)
            if best is None or parent.gain + added + prior > best.score:
                best = self.judged(joint, parent.gain + added, prior)
        for _ in range(MOST_ENRICHED):
            richer = None if best is None else self._enriched(best)
            if richer is None:
                break
            best = richer
        if best is not None:
            known = self.visited.get(best.names)
            if known is None or best.score > known.score:
                self.visited[best.names] = best
        return best

    def _scan(self, fitted: FittedStructure) -> Scan:
        """Evidence for every hypothesis in the residual of a structure, by that one's noise."""
        whitened, gram = self.whitened, self.gram
        if fitted.noise.model_error_factor != self.noise.model_error_factor:
            whitened = fitted.whitened(self.library.columns, fitted.noise)
            gram = whitened.T @ whitened
        return scan(
            self.library,
            whitened,
            gram,
            fitted.tangent,
            fitted.residual,
            self.noise.freedom,
            self._excess(fitted),
        )

    def judged(self, fitted: FittedStructure, gain: float, prior: float) -> Candidate:
        """Candidate of a fitted structure, its residual looked through.

        Parameters
        ----------
        fitted : FittedStructure
        gain : float
            Log evidence over the baseline [nat].
        prior : float
            Log prior odds [nat].

        Returns
        -------
        Candidate
        """
        rows, step = self.problem.fitted, self.problem.resolution_deg
        found = find_sinusoid(fitted.history, rows, fitted.residual, step)
        return Candidate(fitted, gain, prior, self._scan(fitted), found, self.alarm)

    def _room(self, candidate: Candidate) -> float:
        """Evidence that a sufficient structure may leave in its residual."""
        explained = max(self.baseline.fit.loss - candidate.fit.loss, 0.0)
        return max(self.threshold, min(0.5 * SHAPE_ERROR**2 * explained, MOST_SHAPE_ERROR))

    def _excess(self, fitted: FittedStructure) -> float:
        """Chi-squared of a residual beyond what noise explains."""
        return max(fitted.loss - fitted.noise.loss_of_row * self.noise.freedom, 0.0)

    def chi2_gain(self, before: FittedStructure, after: FittedStructure) -> float:
        """Twice the log likelihood gained from one fit to the next, which has no unit.

        Parameters
        ----------
        before : FittedStructure
        after : FittedStructure

        Returns
        -------
        float
        """
        drop = before.loss - after.loss
        return float(likelihood_gain(np.array(drop), self._excess(before), self.noise.freedom))

    def _further_chi2(self, before: FittedStructure, after: FittedStructure) -> float:
        """Gain over the start by one fit beyond another, see `chi2_gain` for the parameters.

        Counted so, gains add up in any order; from step to step they do not where structures fit
        better than noise with model error.
        """
        return self.chi2_gain(self.start.fit, after) - self.chi2_gain(self.start.fit, before)

    def _enriched(self, candidate: Candidate) -> Candidate | None:
        """Give a term more freedom of shape where the residual asks for it."""
        offers = richer_structures(
            candidate,
            self.library,
            self.threshold,
            suffices=self.suffices(candidate),
            accepted=self.start.names,
        )
        return self.first_better(candidate, offers)

    def first_better(
        self, candidate: Candidate, offers: Iterable[tuple[tuple[Term, ...], int]]
    ) -> Candidate | None:
        """First of some richer structures that the evidence prefers to a poorer one.

        Parameters
        ----------
        candidate : Candidate
            The poorer one.
        offers : iterable of (terms, rank)
            Richer ones, each with the number of parameters added.

        Returns
        -------
        Candidate or None
        """
        for terms, rank in offers:
            rounds = USUAL_ROUNDS if any(term.slips for term in terms) else RICH_ROUNDS
            joint = fit(
                self.problem, self.noise, terms, candidate.fit, rounds=rounds, rival=candidate.fit
            )
            signed = with_right_signs(joint)
            if signed is None or cancel(signed, self.baseline.fit):
                continue
            added = float(evidence(self._further_chi2(candidate.fit, signed), rank))
            if added <= 1.0:
                continue
            richer = self.judged(signed, candidate.gain + added, candidate.prior)
            if richer.all_recognised or not candidate.all_recognised:
                return richer
        return None

    def _visit_parts(self) -> None:
        """Leave each term out of the best structures: the others may explain it all."""
        for candidate in sorted(self.visited.values(), key=lambda n: -n.score)[:4]:
            terms = candidate.fit.terms
            added = [term.name for term in terms if term.name not in self.start.names]
            if len(added) < 2:
                continue
            for left_out in added:
                self._visit([name for name in added if name != left_out])
                known = self.visited.get(candidate.names - {left_out})
                gain, noise = self.chi2_gain, self.noise
                if known and (freer := freer_part(candidate, left_out, known, noise, gain)):
                    self.visited[known.names] = self.judged(*freer)

    def _visit(self, names: Sequence[str]) -> None:
        """Fit a structure of these terms, one after the other, unless it was visited."""
        if self.start.names | frozenset(names) in self.visited:
            return
        parent = self.start
        for name in names:
            if name not in parent.scan.groups:
                return
            child = self._child(parent, name)
            if child is None:
                return
            parent = child

    def _child(self, parent: Candidate, name: str) -> Candidate | None:
        """Structure with one more hypothesis; from one parent it is fitted once."""
        if (parent, name) in self.tried:
            return self.visited.get(parent.names | {name})
        return self.extend(parent, name)

    def _follow(self, progress: Callable[[str], None]) -> None:
        """Add further terms to the best structure as long as the residual asks for them."""
        best = self.best()
        while best is not None and len(best.fit.terms) < MOST_FOLLOWED:
            if best.largest_excess <= self.threshold:
                return
            children = []
            for name in best.hypotheses_to_add(2, 1):
                progress(f"fitting {' + '.join([*best.fit.names, name])}")
                child = self._child(best, name)
                if child is not None and child.score > best.score:
                    children.append(child)
            if not children:
                return
            best = max(children, key=lambda n: n.score)
