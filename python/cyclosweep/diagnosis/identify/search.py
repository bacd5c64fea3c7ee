"""Search for the set of effects that explains a recording, each refitted with the baseline."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.hypotheses import sinusoid
from cyclosweep.diagnosis.hypotheses.freeform import CLASSES, FreeForm
from cyclosweep.diagnosis.hypotheses.library import Library, Signature
from cyclosweep.diagnosis.identify.alarm import Alarm
from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.scan import (
    Scan,
    evidence,
    likelihood_gain,
    price_of_choice,
    price_of_vector,
    scan,
)
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.prepare.noise import Noise, orthonormal
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.simulation.effects import Effect, Shape
from cyclosweep.simulation.effects.history import Floats

EXTRA_TERM = 6.0
"""Log prior odds against every further effect."""
WITHOUT_NAME = 4.0
"""Log prior odds against a shape without a name."""
CAUTION = {"saturation at the end of the range": 0.0} | dict.fromkeys(
    ("relaxation", "loop by rate", "position offsets", "compliance by position"), 6.0
)
"""The same for shapes as common as the named effects, and for those that hold a named effect whole:
creep, drag, transmission error and phase-dependent compliance need not be exact to be named."""
SHAPE_ERROR = 0.05
"""Share of an effect's own visibility below which a remainder is taken for error of its shape:
no model of an effect is exact, and large effects show it."""
MOST_FORGIVEN = 20.0
"""Evidence up to which a remainder is so taken; a further effect of visibility 7 has more."""
DENSE = frozenset({"saturation at the end of the range", "bump at a load"})
"""Shapes without a name whose grid stands for what is believed beforehand."""
MOST_FOR_CHOICE = 1.5
"""What the choice of a shape costs at most where the grid of shapes is coarse."""
ENRICHED = 2
"""Times an effect is given more freedom of shape."""
PRUNED = 3
"""Times parts of an effect are left out because of their sign."""
MOST_TERMS = 3
"""Effects up to which alternatives are searched in breadth; beyond, the best is followed."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A structure with its joint fit and its evidence over the baseline.

    Attributes
    ----------
    fit : FittedStructure
    gain : float
        Log evidence over the baseline alone.
    prior : float
        Log prior odds of the structure.
    rest : Scan
        What the library finds in its residual.
    sinusoid_left : tuple
        Evidence and columns of a sinusoid in its residual.
    alarm : Alarm
        Calibration of the global test.
    """

    fit: FittedStructure
    gain: float
    prior: float
    rest: Scan
    sinusoid_left: tuple[float, FreeForm | None]
    alarm: Alarm

    @property
    def names(self) -> frozenset[str]:
        """Names of the terms."""
        return frozenset(self.fit.names)

    @property
    def score(self) -> float:
        """Log posterior odds over the baseline."""
        return self.gain + self.prior

    @cached_property
    def recognised(self) -> tuple[bool, ...]:
        """Which terms carry their name: a shape without one takes it from others of its class."""
        fitted = self.fit
        own, nameless = [], set[str]()
        for k, term in enumerate(fitted.terms):
            effect = term.effect
            if effect is None:
                nameless |= CLASSES.get(term.name, frozenset())
            elif not term.slips and not effect.telling(
                fitted.history, term.shape, fitted.beta[fitted.column_range(k)]
            ):
                nameless.add(effect.family)
            else:
                own.append(k)
        return tuple(
            k in own and term.effect is not None and term.effect.family not in nameless
            for k, term in enumerate(fitted.terms)
        )

    @property
    def all_recognised(self) -> bool:
        """Whether every term has a name."""
        return all(self.recognised)

    @property
    def excesses(self) -> dict[str, float]:
        """How far each hypothesis, in its residual, is beyond what it reaches by chance."""
        found = {name: self.alarm.excess(name, v) for name, v in self.rest.by_hypothesis.items()}
        wave = self.sinusoid_left[1]
        if wave is not None:
            found[wave.family] = self.alarm.excess(wave.family, self.sinusoid_left[0])
        return found

    @property
    def left(self) -> float:
        """Largest excess of anything that remains in the residual."""
        return max(max(self.excesses.values(), default=0.0), 0.0)


class Search:
    """Everything that one recording's search shares: noise, whitened library, visited visited."""

    def __init__(self, problem: Problem, noise: Noise, library: Library, seed: int) -> None:
        self.problem, self.noise, self.library = problem, noise, library
        self.seed = seed
        base = fit(problem, noise, ())
        use = problem.fitted
        _, weight = noise.residual(problem.angle_deg[use], base.mean_deg[use])
        self.whitened = noise.design(library.columns, weight)
        self.gram = self.whitened.T @ self.whitened
        rng = np.random.default_rng([seed, 1])
        self.alarm = Alarm.calibrate(self._scan(base), rng)
        self.threshold = self.alarm.threshold
        self.baseline = self._node(base, 0.0, 0.0)
        self.visited: dict[frozenset[str], Candidate] = {}
        self.chosen: Candidate | None = None

    def null(self, candidate: Candidate) -> Floats:
        """Largest excess that recordings show when this candidate is all there is."""
        if candidate is self.baseline:
            return self.alarm.maxima
        return self.alarm.null(candidate.rest, np.random.default_rng([self.seed, 1]))

    def _scan(self, fitted: FittedStructure) -> Scan:
        return scan(
            self.library,
            self.whitened,
            self.gram,
            fitted.tangent,
            fitted.residual,
            self.noise.freedom,
            self._excess(fitted),
        )

    def _node(self, fitted: FittedStructure, gain: float, prior: float) -> Candidate:
        found = sinusoid.find_wave(fitted.history, self.problem.fitted, fitted.residual)
        return Candidate(fitted, gain, prior, self._scan(fitted), found, self.alarm)

    def suffices(self, candidate: Candidate) -> bool:
        """Whether a structure leaves nothing but noise, or what its own inexactness explains."""
        return candidate.left < self._slack(candidate)

    def _slack(self, candidate: Candidate) -> float:
        """Evidence that a sufficient structure may leave in its residual."""
        explained = max(self.baseline.fit.chi2 - candidate.fit.chi2, 0.0)
        return max(self.threshold, min(0.5 * SHAPE_ERROR**2 * explained, MOST_FORGIVEN))

    def _enriched(self, candidate: Candidate) -> Candidate | None:
        """Give a term more freedom of shape where the residual asks for more of the same effect."""
        for k, term in enumerate(candidate.fit.terms):
            if term.effect is None or term.slips:
                continue
            if candidate.excesses.get(term.name, 0.0) <= self.threshold:
                continue
            members = candidate.rest.groups[term.name]
            each = evidence(candidate.rest.observed[members], candidate.rest.ranks[members])
            for index in members[np.argsort(-each)][:3]:
                shape = term.effect.richer(term.shape, self.library.signatures[index].shape)
                if shape is None:
                    continue
                terms = list(candidate.fit.terms)
                terms[k] = replace(term, shape=shape)
                joint = self._pruned(fit(self.problem, self.noise, terms, candidate.fit))
                if joint is None:
                    continue
                rank = len(term.effect.amplitudes(shape)) - len(term.effect.amplitudes(term.shape))
                added = float(evidence(self._gain(candidate.fit, joint), max(rank, 1)))
                if added > 1.0:
                    return self._node(joint, candidate.gain + added, candidate.prior)
        return None

    def _pruned(self, joint: FittedStructure) -> FittedStructure | None:
        """Leave out parts of effects that came out with the wrong sign; None where that fails."""
        for _ in range(PRUNED):
            if joint.valid:
                return joint
            terms = []
            for k, term in enumerate(joint.terms):
                wrong = joint.wrong_signs(k)
                if wrong.any():
                    shape = None if term.effect is None else term.effect.poorer(term.shape, wrong)
                    if shape is None:
                        return None
                    term = replace(term, shape=shape)
                terms.append(term)
            joint = fit(self.problem, self.noise, terms, joint)
        return joint if joint.valid else None

    def extend(self, candidate: Candidate, hypothesis: str) -> Candidate | None:
        """Add one hypothesis to a structure and refit; None where no physical fit is better."""
        best: Candidate | None = None
        for term, rank, cost in self._starts(candidate, hypothesis):
            joint = self._pruned(
                fit(self.problem, self.noise, (*candidate.fit.terms, term), candidate.fit)
            )
            if joint is None:
                continue
            added = self._added(candidate, joint, rank, cost)
            prior = candidate.prior - (EXTRA_TERM if candidate.fit.terms else 0.0)
            prior -= _caution(term.name, term.effect, term.shape)
            if best is None or candidate.gain + added > best.gain:
                best = self._node(joint, candidate.gain + added, prior)
        for _ in range(ENRICHED):
            richer = None if best is None else self._enriched(best)
            if richer is None:
                break
            best = richer
        if best is not None:
            known = self.visited.get(best.names)
            if known is None or best.score > known.score:
                self.visited[best.names] = best
        return best

    def _added(
        self, candidate: Candidate, joint: FittedStructure, rank: float, cost: float
    ) -> float:
        """Log evidence that the last term of a joint fit adds to a structure."""
        gain = self._gain(candidate.fit, joint)
        effect = joint.terms[-1].effect
        if effect is not None and effect.vector:
            places = joint.amplitude_places(len(joint.terms) - 1)
            return 0.5 * gain - price_of_vector(joint.beta[places], joint.information(places))
        if effect is None or not effect.dense:
            cost = max(cost, self._price_of_shape(joint, candidate.rest))
        return float(evidence(gain, rank)) - cost

    def _price_of_shape(self, joint: FittedStructure, rest: Scan) -> float:
        """Log of how many of its library's shapes of the last term a recording tells apart."""
        last = len(joint.terms) - 1
        places, ranges = [], []
        for k, nonlinear in enumerate(joint.fit_parameters):
            if nonlinear.term != last or nonlinear.name == "amplitude":
                continue
            each = [
                nonlinear.to_scale(rest.library.signatures[m].shape[nonlinear.name])
                for m in rest.groups.get(joint.terms[last].name, ())
                if nonlinear.name in rest.library.signatures[m].shape
            ]
            if len(each) and max(each) > min(each):
                places.append(len(joint.beta) + k)
                ranges.append(max(each) - min(each))
        return price_of_choice(joint.information(places), np.array(ranges)) if places else 0.0

    def _excess(self, fitted: FittedStructure) -> float:
        return max(fitted.chi2 - self.noise.freedom, 0.0)

    def _gain(self, before: FittedStructure, after: FittedStructure) -> float:
        """Twice the log-likelihood gained from one fit to the next."""
        drop = before.chi2 - after.chi2
        return float(likelihood_gain(np.array(drop), self._excess(before), self.noise.freedom))

    def add(self, fitted: FittedStructure, gain: float) -> Candidate:
        """Add a structure that was fitted elsewhere to those visited."""
        candidate = self._node(fitted, gain, 0.0)
        self.visited[candidate.names] = candidate
        return candidate

    def refit(self, terms: tuple[Term, ...]) -> Candidate:
        """FittedStructure a structure that was not visited on its own."""
        return self._node(fit(self.problem, self.noise, terms, self.baseline.fit), 0.0, 0.0)

    def _starts(self, candidate: Candidate, hypothesis: str) -> Iterable[tuple[Term, float, float]]:
        """Terms to start from, with projected rank and the price of the choice of shape."""
        if hypothesis in sinusoid.FAMILIES:
            form = candidate.sinusoid_left[1]
            assert form is not None
            gain = self._wave_gain(candidate)
            yield Term(None, {}, form), 2.0, max(gain - candidate.sinusoid_left[0], 0.0)
            return
        rest = candidate.rest
        members = rest.groups[hypothesis]
        each = evidence(rest.observed[members], rest.ranks[members])
        average = rest.by_hypothesis[hypothesis]
        signatures = [rest.library.signatures[index] for index in members]
        caution = np.array([_caution(hypothesis, b.effect, b.shape) for b in signatures])
        rank = np.argsort(caution - each)
        order = members[rank]
        first = rest.library.signatures[order[0]]
        dense = first.effect.dense if first.effect is not None else hypothesis in DENSE
        most = np.inf if dense else MOST_FOR_CHOICE
        price = float(np.clip(each[rank[0]] - average, 0.0, most))
        slips = first.effect is not None and first.effect.slips
        tried = 0
        for index in order:
            signature = rest.library.signatures[index]
            if tried and not (slips and _differs(signature, first)):
                continue
            amplitude = self._amplitude(rest, int(index), signature) if slips else 0.0
            shapes: Sequence[Shape] = [signature.shape]
            if signature.effect is not None and not tried:
                shapes = signature.effect.variants(candidate.fit.history, signature.shape)
            for shape in shapes:
                term = Term(signature.effect, shape, signature.free, amplitude)
                yield term, float(rest.ranks[index]), price
            tried += 1
            if tried >= (2 if slips else 1):
                return

    def _wave_gain(self, candidate: Candidate) -> float:
        """Evidence of the wave found in a residual before the price of its search."""
        form = candidate.sinusoid_left[1]
        assert form is not None
        use = self.problem.fitted
        angle, mean = self.problem.angle_deg[use], candidate.fit.mean_deg[use]
        white = self.noise.design(
            form.make(candidate.fit.history)[use], self.noise.residual(angle, mean)[1]
        )
        basis = orthonormal(white)
        return float(evidence(np.sum((basis.T @ candidate.fit.residual) ** 2), 2.0))

    def _amplitude(self, rest: Scan, index: int, signature: Signature) -> float:
        inner = rest.gram[signature.first, signature.first]
        return float(max(rest.score[signature.first] / inner / signature.scale[0], 1e-6))

    def hypotheses_to_add(self, candidate: Candidate, most: int, least_named: int = 2) -> list[str]:
        """Hypotheses worth adding to a structure, strongest first."""
        values = candidate.excesses
        good = sorted(
            (
                name
                for name, v in values.items()
                if v > self.threshold and name not in candidate.names
            ),
            key=lambda name: -values[name],
        )
        named = {signature.hypothesis for signature in self.library.signatures if signature.named}
        chosen = good[:most]
        chosen += [name for name in good if name in named and name not in chosen][
            : max(0, least_named - sum(name in named for name in chosen))
        ]
        return chosen

    def run(self, progress: Callable[[str], None] = lambda text: None) -> None:
        """Visit structures: in breadth up to three terms, then along the best one."""
        if self.baseline.left < self.threshold:
            return
        front = [self.baseline]
        for depth in range(MOST_TERMS):
            found: list[Candidate] = []
            for candidate in front:
                for name in self.hypotheses_to_add(candidate, 6 if depth == 0 else 3, 3 - depth):
                    if candidate.names | {name} in self.visited and depth:
                        continue
                    progress(f"fitting {' + '.join([*candidate.fit.names, name])}")
                    child = self.extend(candidate, name)
                    if child is not None:
                        found.append(child)
            if not found:
                break
            found = list({n.names: n for n in sorted(found, key=lambda n: n.score)}.values())
            found.sort(key=lambda n: -n.score)
            named = [n for n in found if n.all_recognised]
            front = found[: 3 - (depth > 0)]
            front += [n for n in named[: 3 - depth] if all(n is not f for f in front)]
        self._drop()
        self._follow(progress)

    def _drop(self) -> None:
        """Leave each term out of the best structures: the rest may explain it all."""
        for candidate in sorted(self.visited.values(), key=lambda n: -n.score)[:4]:
            self._visit_subsets(candidate)

    def _visit_subsets(self, candidate: Candidate) -> None:
        if len(candidate.fit.terms) < 2:
            return
        for k in range(len(candidate.fit.terms)):
            kept = [t for j, t in enumerate(candidate.fit.terms) if j != k]
            if frozenset(t.name for t in kept) in self.visited:
                continue
            parent = self.baseline
            for term in kept:
                if term.name not in parent.rest.groups:
                    break
                child = self.extend(parent, term.name)
                if child is None:
                    break
                parent = child

    def _follow(self, progress: Callable[[str], None]) -> None:
        """Add further terms to the best structure as long as the residual asks for them."""
        candidate = self.best()
        while (
            candidate is not None
            and len(candidate.fit.terms) < 7
            and candidate.left > self.threshold
        ):
            children = []
            for name in self.hypotheses_to_add(candidate, 2, 1):
                progress(f"fitting {' + '.join([*candidate.fit.names, name])}")
                child = self.extend(candidate, name)
                if child is not None and child.score > candidate.score:
                    children.append(child)
            if not children:
                return
            candidate = max(children, key=lambda n: n.score)

    def best(self) -> Candidate | None:
        """Structure with the largest posterior odds."""
        return max(self.explanations(), key=lambda n: n.score, default=None)

    def explanations(self) -> list[Candidate]:
        """Structures worth considering: those that contain a sufficient smaller one are not."""
        enough = [n for n in self.visited.values() if self.suffices(n)]
        kept = [
            n
            for n in self.visited.values()
            if not any(e.names < n.names and n.score < e.score + self._slack(e) for e in enough)
        ]
        return sorted(kept, key=lambda n: -n.score)


def _caution(name: str, effect: Effect | None, shape: Shape) -> float:
    """Log prior odds against a shape, with a name or without."""
    return CAUTION.get(name, WITHOUT_NAME) if effect is None else effect.caution(shape)


def _differs(signature: Signature, other: Signature) -> bool:
    """Whether two shapes are far enough apart to be worth a second start."""
    return signature.effect is not None and signature.effect.far_apart(signature.shape, other.shape)
