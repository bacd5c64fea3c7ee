"""Search for the set of effects that explains a recording, each refitted with the baseline."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.hypotheses import sinusoid
from cyclosweep.diagnosis.hypotheses.freeform import CLASSES, FreeForm
from cyclosweep.diagnosis.hypotheses.library import Block, Library
from cyclosweep.diagnosis.identify.alarm import Alarm
from cyclosweep.diagnosis.identify.fit import Fit, fit
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
class Node:
    """A structure with its joint fit and its evidence over the baseline.

    Attributes
    ----------
    fit : Fit
    gain : float
        Log evidence over the baseline alone.
    prior : float
        Log prior odds of the structure.
    rest : Scan
        What the library finds in its residual.
    rest_hum : tuple
        Evidence and columns of a sinusoid in its residual.
    alarm : Alarm
        Calibration of the global test.
    """

    fit: Fit
    gain: float
    prior: float
    rest: Scan
    rest_hum: tuple[float, FreeForm | None]
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
    def carries(self) -> tuple[bool, ...]:
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
    def named_only(self) -> bool:
        """Whether every term has a name."""
        return all(self.carries)

    @property
    def excesses(self) -> dict[str, float]:
        """How far each hypothesis, in its residual, is beyond what it reaches by chance."""
        found = {name: self.alarm.excess(name, v) for name, v in self.rest.by_hypothesis.items()}
        wave = self.rest_hum[1]
        if wave is not None:
            found[wave.family] = self.alarm.excess(wave.family, self.rest_hum[0])
        return found

    @property
    def left(self) -> float:
        """Largest excess of anything that remains in the residual."""
        return max(max(self.excesses.values(), default=0.0), 0.0)


class Search:
    """Everything that one recording's search shares: noise, whitened library, nodes visited."""

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
        self.root = self._node(base, 0.0, 0.0)
        self.nodes: dict[frozenset[str], Node] = {}
        self.settled: Node | None = None

    def null(self, node: Node) -> Floats:
        """Largest excess that recordings show when this node is all there is."""
        if node is self.root:
            return self.alarm.maxima
        return self.alarm.null(node.rest, np.random.default_rng([self.seed, 1]))

    def _scan(self, fitted: Fit) -> Scan:
        return scan(
            self.library,
            self.whitened,
            self.gram,
            fitted.tangent,
            fitted.residual,
            self.noise.freedom,
            self._excess(fitted),
        )

    def _node(self, fitted: Fit, gain: float, prior: float) -> Node:
        found = sinusoid.find_wave(fitted.history, self.problem.fitted, fitted.residual)
        return Node(fitted, gain, prior, self._scan(fitted), found, self.alarm)

    def suffices(self, node: Node) -> bool:
        """Whether a structure leaves nothing but noise, or what its own inexactness explains."""
        return node.left < self._slack(node)

    def _slack(self, node: Node) -> float:
        """Evidence that a sufficient structure may leave in its residual."""
        explained = max(self.root.fit.chi2 - node.fit.chi2, 0.0)
        return max(self.threshold, min(0.5 * SHAPE_ERROR**2 * explained, MOST_FORGIVEN))

    def _enriched(self, node: Node) -> Node | None:
        """Give a term more freedom of shape where the residual asks for more of the same effect."""
        for k, term in enumerate(node.fit.terms):
            if term.effect is None or term.slips:
                continue
            if node.excesses.get(term.name, 0.0) <= self.threshold:
                continue
            members = node.rest.groups[term.name]
            each = evidence(node.rest.observed[members], node.rest.ranks[members])
            for index in members[np.argsort(-each)][:3]:
                shape = term.effect.richer(term.shape, self.library.blocks[index].shape)
                if shape is None:
                    continue
                terms = list(node.fit.terms)
                terms[k] = replace(term, shape=shape)
                joint = self._pruned(fit(self.problem, self.noise, terms, node.fit))
                if joint is None:
                    continue
                rank = len(term.effect.amplitudes(shape)) - len(term.effect.amplitudes(term.shape))
                added = float(evidence(self._gain(node.fit, joint), max(rank, 1)))
                if added > 1.0:
                    return self._node(joint, node.gain + added, node.prior)
        return None

    def _pruned(self, joint: Fit) -> Fit | None:
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

    def extend(self, node: Node, hypothesis: str) -> Node | None:
        """Add one hypothesis to a structure and refit; None where no physical fit is better."""
        best: Node | None = None
        for term, rank, cost in self._starts(node, hypothesis):
            joint = self._pruned(fit(self.problem, self.noise, (*node.fit.terms, term), node.fit))
            if joint is None:
                continue
            added = self._added(node, joint, rank, cost)
            prior = node.prior - (EXTRA_TERM if node.fit.terms else 0.0)
            prior -= _caution(term.name, term.effect, term.shape)
            if best is None or node.gain + added > best.gain:
                best = self._node(joint, node.gain + added, prior)
        for _ in range(ENRICHED):
            richer = None if best is None else self._enriched(best)
            if richer is None:
                break
            best = richer
        if best is not None:
            known = self.nodes.get(best.names)
            if known is None or best.score > known.score:
                self.nodes[best.names] = best
        return best

    def _added(self, node: Node, joint: Fit, rank: float, cost: float) -> float:
        """Log evidence that the last term of a joint fit adds to a structure."""
        gain = self._gain(node.fit, joint)
        effect = joint.terms[-1].effect
        if effect is not None and effect.vector:
            places = joint.amplitude_places(len(joint.terms) - 1)
            return 0.5 * gain - price_of_vector(joint.beta[places], joint.information(places))
        if effect is None or not effect.dense:
            cost = max(cost, self._price_of_shape(joint, node.rest))
        return float(evidence(gain, rank)) - cost

    def _price_of_shape(self, joint: Fit, rest: Scan) -> float:
        """Log of how many of its library's shapes of the last term a recording tells apart."""
        last = len(joint.terms) - 1
        places, ranges = [], []
        for k, nonlinear in enumerate(joint.fit_parameters):
            if nonlinear.term != last or nonlinear.name == "amplitude":
                continue
            each = [
                nonlinear.to_scale(rest.library.blocks[m].shape[nonlinear.name])
                for m in rest.groups.get(joint.terms[last].name, ())
                if nonlinear.name in rest.library.blocks[m].shape
            ]
            if len(each) and max(each) > min(each):
                places.append(len(joint.beta) + k)
                ranges.append(max(each) - min(each))
        return price_of_choice(joint.information(places), np.array(ranges)) if places else 0.0

    def _excess(self, fitted: Fit) -> float:
        return max(fitted.chi2 - self.noise.freedom, 0.0)

    def _gain(self, before: Fit, after: Fit) -> float:
        """Twice the log-likelihood gained from one fit to the next."""
        drop = before.chi2 - after.chi2
        return float(likelihood_gain(np.array(drop), self._excess(before), self.noise.freedom))

    def adopt(self, fitted: Fit, gain: float) -> Node:
        """Take in a structure that was fitted elsewhere."""
        node = self._node(fitted, gain, 0.0)
        self.nodes[node.names] = node
        return node

    def refit(self, terms: tuple[Term, ...]) -> Node:
        """Fit a structure that was not visited on its own."""
        return self._node(fit(self.problem, self.noise, terms, self.root.fit), 0.0, 0.0)

    def _starts(self, node: Node, hypothesis: str) -> Iterable[tuple[Term, float, float]]:
        """Terms to start from, with projected rank and the price of the choice of shape."""
        if hypothesis in sinusoid.FAMILIES:
            form = node.rest_hum[1]
            assert form is not None
            gain = self._wave_gain(node)
            yield Term(None, {}, form), 2.0, max(gain - node.rest_hum[0], 0.0)
            return
        rest = node.rest
        members = rest.groups[hypothesis]
        each = evidence(rest.observed[members], rest.ranks[members])
        average = rest.by_hypothesis[hypothesis]
        blocks = [rest.library.blocks[index] for index in members]
        caution = np.array([_caution(hypothesis, b.effect, b.shape) for b in blocks])
        rank = np.argsort(caution - each)
        order = members[rank]
        first = rest.library.blocks[order[0]]
        dense = first.effect.dense if first.effect is not None else hypothesis in DENSE
        most = np.inf if dense else MOST_FOR_CHOICE
        price = float(np.clip(each[rank[0]] - average, 0.0, most))
        slips = first.effect is not None and first.effect.slips
        tried = 0
        for index in order:
            block = rest.library.blocks[index]
            if tried and not (slips and _differs(block, first)):
                continue
            amplitude = self._amplitude(rest, int(index), block) if slips else 0.0
            shapes: Sequence[Shape] = [block.shape]
            if block.effect is not None and not tried:
                shapes = block.effect.variants(node.fit.history, block.shape)
            for shape in shapes:
                term = Term(block.effect, shape, block.free, amplitude)
                yield term, float(rest.ranks[index]), price
            tried += 1
            if tried >= (2 if slips else 1):
                return

    def _wave_gain(self, node: Node) -> float:
        """Evidence of the wave found in a residual before the price of its search."""
        form = node.rest_hum[1]
        assert form is not None
        use = self.problem.fitted
        angle, mean = self.problem.angle_deg[use], node.fit.mean_deg[use]
        white = self.noise.design(
            form.make(node.fit.history)[use], self.noise.residual(angle, mean)[1]
        )
        basis = orthonormal(white)
        return float(evidence(np.sum((basis.T @ node.fit.residual) ** 2), 2.0))

    def _amplitude(self, rest: Scan, index: int, block: Block) -> float:
        inner = rest.gram[block.first, block.first]
        return float(max(rest.score[block.first] / inner / block.scale[0], 1e-6))

    def candidates(self, node: Node, most: int, least_named: int = 2) -> list[str]:
        """Hypotheses worth adding to a structure, strongest first."""
        values = node.excesses
        good = sorted(
            (name for name, v in values.items() if v > self.threshold and name not in node.names),
            key=lambda name: -values[name],
        )
        named = {block.hypothesis for block in self.library.blocks if block.named}
        chosen = good[:most]
        chosen += [name for name in good if name in named and name not in chosen][
            : max(0, least_named - sum(name in named for name in chosen))
        ]
        return chosen

    def run(self, progress: Callable[[str], None] = lambda text: None) -> None:
        """Visit structures: in breadth up to three terms, then along the best one."""
        if self.root.left < self.threshold:
            return
        front = [self.root]
        for depth in range(MOST_TERMS):
            found: list[Node] = []
            for node in front:
                for name in self.candidates(node, 6 if depth == 0 else 3, 3 - depth):
                    if node.names | {name} in self.nodes and depth:
                        continue
                    progress(f"fitting {' + '.join([*node.fit.names, name])}")
                    child = self.extend(node, name)
                    if child is not None:
                        found.append(child)
            if not found:
                break
            found = list({n.names: n for n in sorted(found, key=lambda n: n.score)}.values())
            found.sort(key=lambda n: -n.score)
            named = [n for n in found if n.named_only]
            front = found[: 3 - (depth > 0)]
            front += [n for n in named[: 3 - depth] if all(n is not f for f in front)]
        self._drop()
        self._follow(progress)

    def _drop(self) -> None:
        """Leave each term out of the best structures: the rest may explain it all."""
        for node in sorted(self.nodes.values(), key=lambda n: -n.score)[:4]:
            self._visit_subsets(node)

    def _visit_subsets(self, node: Node) -> None:
        if len(node.fit.terms) < 2:
            return
        for k in range(len(node.fit.terms)):
            kept = [t for j, t in enumerate(node.fit.terms) if j != k]
            if frozenset(t.name for t in kept) in self.nodes:
                continue
            parent = self.root
            for term in kept:
                if term.name not in parent.rest.groups:
                    break
                child = self.extend(parent, term.name)
                if child is None:
                    break
                parent = child

    def _follow(self, progress: Callable[[str], None]) -> None:
        """Add further terms to the best structure as long as the residual asks for them."""
        node = self.best()
        while node is not None and len(node.fit.terms) < 7 and node.left > self.threshold:
            children = []
            for name in self.candidates(node, 2, 1):
                progress(f"fitting {' + '.join([*node.fit.names, name])}")
                child = self.extend(node, name)
                if child is not None and child.score > node.score:
                    children.append(child)
            if not children:
                return
            node = max(children, key=lambda n: n.score)

    def best(self) -> Node | None:
        """Structure with the largest posterior odds."""
        return max(self.explanations(), key=lambda n: n.score, default=None)

    def explanations(self) -> list[Node]:
        """Structures worth considering: those that contain a sufficient smaller one are not."""
        enough = [n for n in self.nodes.values() if self.suffices(n)]
        kept = [
            n
            for n in self.nodes.values()
            if not any(e.names < n.names and n.score < e.score + self._slack(e) for e in enough)
        ]
        return sorted(kept, key=lambda n: -n.score)


def _caution(name: str, effect: Effect | None, shape: Shape) -> float:
    """Log prior odds against a shape, with a name or without."""
    return CAUTION.get(name, WITHOUT_NAME) if effect is None else effect.caution(shape)


def _differs(block: Block, other: Block) -> bool:
    """Whether two slip shapes are far enough apart to be worth a second start."""
    ratio = float(block.shape["slip_deg"]) / float(other.shape["slip_deg"])
    return not 0.5 < ratio < 2.0 or block.shape.get("slack") != other.shape.get("slack")
