"""Search in stages: large effects first, each stage judged against the error of its own models."""

from collections.abc import Callable
from dataclasses import dataclass, field

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.acceptance import Accepted, acceptable
from cyclosweep.diagnosis.identify.stages.bent_friction import bent_instead_of_others
from cyclosweep.diagnosis.identify.stages.freer_laws import freer_instead_of_others, with_freer_laws
from cyclosweep.diagnosis.identify.stages.friction_first import (
    CONVERGED,
    PARAMETER_CHARGE,
    friction_first,
    from_better_start,
)
from cyclosweep.diagnosis.identify.stages.other_laws import with_better_laws
from cyclosweep.diagnosis.identify.stages.stage import error_factor, stage_of, visibility
from cyclosweep.diagnosis.identify.stages.variants import in_better_variant, with_refined_drag
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.placement import best_placed
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import (
    NEARLY_ALL,
    Decision,
    decide,
    named_if_close,
    with_further_rivals,
)
from cyclosweep.diagnosis.identify.structures.worth import still_needed
from cyclosweep.simulation.effects.history import Floats

MOST_STAGES = 8
"""Stages of a search: two for each of four effects, as what was accepted may be given up again."""
MISSED = 1.5
"""Error of what a stage would accept over that of what was accepted before, from which it is not
accepted: it has lost something that only the part left out explains."""


def search_in_stages(
    searched: Search,
    flexible: Floats,
    say: Callable[[str], None],
    begun: FittedStructure | None = None,
    renewed: Callable[[Search, FittedStructure], Search] = lambda search, accepted: search,
) -> Search:
    """Explain the largest mismatch first, then what is left of it, stage by stage.

    Parameters
    ----------
    searched : Search
        A search against the noise alone.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model, see `visibility`.
    say : callable
        Called with a few words before each long step.
    begun : FittedStructure, optional
        What was accepted before; without it friction is looked for first.
    renewed : callable
        From a search against the noise alone and what is accepted to the search by the noise that
        this leaves; the same search where that is no other noise.

    Returns
    -------
    Search
        The search of the last stage, which starts from everything that the stages before it
        accepted; the one given where they accepted nothing.
    """
    stages = _Stages.begin(searched, flexible, begun)
    for _ in range(MOST_STAGES):
        if not stages.accepted and stages.factor == 1.0:
            break
        stages.renew(renewed)
        search = stage_of(stages.searched, flexible, stages.fitted)
        search.run(say)
        decision = named_if_close(search, decide(search), NEARLY_ALL)
        if stages.accepted:
            stages.last = search
        best = decision.best
        if best is None or best.score < search.start.score:
            # What leaves nothing more may still be less likely than what was accepted.
            break
        if stages.starts_over(best) or stages.gives_up(search, best):
            continue
        if not stages.accepts(search, decision, best):
            break
    last = stages.ended()
    return _with_settled_laws(stages.searched, flexible, last, say)


@dataclass
class _Stages:
    """What the stages of a search have found so far.

    Attributes
    ----------
    searched : Search
        The search against the noise alone, by the noise that is known best.
    first : Search
        The one before the first stage.
    last : Search
        The search of the last stage that started from something.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model, see `visibility`.
    fitted : FittedStructure
        What was accepted, fitted to convergence.
    rivals : list of (Candidate, probability)
        Other explanations of what was accepted.
    kept_their_start : set of frozenset of str
        Structures whose friction was tried from other states already.
    restarted : bool
        Whether the friction was changed once.
    before_giving_up : (Search, Search, FittedStructure, list) or None
        Searches, accepted structure and rivals when something accepted was given up, once.
    """

    searched: Search
    first: Search
    last: Search
    flexible: Floats
    fitted: FittedStructure
    rivals: list[tuple[Candidate, float]] = field(default_factory=list)
    kept_their_start: set[frozenset[str]] = field(default_factory=set)
    restarted: bool = False
    before_giving_up: (
        tuple[Search, Search, FittedStructure, list[tuple[Candidate, float]]] | None
    ) = None

    @classmethod
    def begin(cls, searched: Search, flexible: Floats, begun: FittedStructure | None) -> "_Stages":
        """Start from what was accepted before, or from friction where the mismatch is loud.

        Parameters
        ----------
        searched : Search
            A search against the noise alone.
        flexible : ndarray, shape (fitted, k)
            Columns of a flexible model, see `visibility`.
        begun : FittedStructure or None
            What was accepted before.

        Returns
        -------
        _Stages
        """
        stages = cls(searched, searched, searched, flexible, searched.baseline.fit)
        factor = stages.factor
        if begun is not None:
            stages._refit(begun.terms, begun)
        elif factor > 1.0:
            friction = friction_first(searched, searched.noise.with_model_error(factor))
            if friction is not None:
                stages.fitted = in_better_variant(friction)
        stages.kept_their_start.add(frozenset(stages.names))
        return stages

    @property
    def accepted(self) -> tuple[Term, ...]:
        """Terms that the stages so far accepted."""
        return self.fitted.terms

    @property
    def names(self) -> set[str]:
        """Their names."""
        return {term.name for term in self.accepted}

    @property
    def factor(self) -> float:
        """Size of noise and model error over that of the noise, see `error_factor`."""
        return error_factor(visibility(self.fitted, self.searched.noise, self.flexible))

    def _refit(self, terms: tuple[Term, ...], near: FittedStructure) -> None:
        """Accept some terms, fitted to convergence.

        Parameters
        ----------
        terms : tuple of Term
        near : FittedStructure
            Where their fit begins.
        """
        again = fit(self.searched.problem, self.searched.noise, terms, near, rounds=CONVERGED)
        self.fitted = in_better_variant(again)

    def renew(self, renewed: Callable[[Search, FittedStructure], Search]) -> None:
        """Search by the noise that is left by what was accepted, see `search_in_stages`."""
        better_known = renewed(self.searched, self.fitted) if self.accepted else self.searched
        if better_known is not self.searched:
            self.searched = better_known
            self.rivals.clear()
            self._refit(self.accepted, self.fitted)

    def starts_over(self, best: Candidate) -> bool:
        """Change the state or shape of what was accepted where that is likelier with a structure.

        What was found beside friction in the wrong state, or drag of another shape, may be the
        error of that. Done once.

        Parameters
        ----------
        best : Candidate
            Best structure of a stage.

        Returns
        -------
        bool
            Whether it was changed, so that the stage is to be repeated.
        """
        if not self.accepted or self.restarted or best.names in self.kept_their_start:
            return False
        turned = from_better_start(self.searched.noise, best.fit, PARAMETER_CHARGE)
        turned = with_refined_drag(turned, self.names)
        self.kept_their_start.add(best.names)
        if turned is best.fit:
            return False
        self.restarted = True
        kept = tuple(term for term in turned.terms if term.name in self.names)
        self._refit(kept, turned)
        return True

    def gives_up(self, search: Search, best: Candidate) -> bool:
        """Give up what stood in for something found since; done once.

        Parameters
        ----------
        search : Search
            Search of a stage.
        best : Candidate
            Its best structure.

        Returns
        -------
        bool
            Whether something was given up, so that the stage is to be repeated.
        """
        if self.before_giving_up is not None:
            return False
        needed = still_needed(search, best, self.accepted)
        if len(needed) >= len(self.accepted):
            return False
        self.before_giving_up = (self.searched, self.last, self.fitted, list(self.rivals))
        if not needed:
            self.searched = self.first
        self.last, self.fitted = self.searched, self.searched.baseline.fit
        self.rivals.clear()
        if needed:
            self._refit(needed, best.fit)
        return True

    def accepts(self, search: Search, decision: Decision, best: Candidate) -> bool:
        """Accept what a stage found, or a freer form of it.

        Parameters
        ----------
        search : Search
            Search of the stage.
        decision : Decision
            What it says.
        best : Candidate
            Its best structure.

        Returns
        -------
        bool
            Whether anything new was accepted.
        """
        mismatch_deg = self.first.baseline.fit.rmse_deg
        part, found = acceptable(search, decision, best, self.names, mismatch_deg)
        freer = freer_instead_of_others(search, found.best, part)
        if freer is None:
            freer = bent_instead_of_others(search, found.part(search))
        if freer is not None:
            self._refit(freer.fit.terms, freer.fit)
            self.last = stage_of(self.searched, self.flexible, self.fitted)
            self.rivals.clear()
            return True
        if found.names == self.names:
            return False
        before = self.fitted
        self._refit(found.terms, found.best.fit)
        if before.terms and self.fitted.rmse_deg > MISSED * before.rmse_deg:
            self.fitted = before
            return False
        self._add_rivals(found)
        return True

    def _add_rivals(self, found: Accepted) -> None:
        """Keep the other explanations of a stage that leaves nothing."""
        if not found.decision.unexplained:
            so_far = 1.0 - sum(share for _, share in self.rivals)
            others = [each for each in found.decision.explanations if each[0] is not found.best]
            self.rivals += [(candidate, so_far * share) for candidate, share in others]

    def ended(self) -> Search:
        """Search of the last stage, which starts from all that was accepted.

        What was given up is taken back where the stages since explain less than before.
        """
        before = self.before_giving_up
        if before is not None and self.fitted.rmse_deg > MISSED * before[2].rmse_deg:
            self.searched, self.last, self.fitted, self.rivals = before
        if len(self.last.start.fit.terms) < len(self.accepted):
            self.last = stage_of(self.searched, self.flexible, self.fitted)
        self.last.rivals_of_start = self.rivals
        return self.last


def _with_settled_laws(
    searched: Search, flexible: Floats, last: Search, say: Callable[[str], None]
) -> Search:
    """Settle the laws of what the stages accepted, once all of it is known.

    Parameters
    ----------
    searched : Search
        The search against the noise alone.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model, see `visibility`.
    last : Search
        The search of the last stage.
    say : callable
        Called with a few words before each long step.

    Returns
    -------
    Search
        That search, or one from a structure of other laws, or of freer ones.
    """
    rivals = last.rivals_of_start
    if last.start is not last.baseline:
        settled, others = with_better_laws(last)
        rivals = [each for each in rivals if each[0].names != frozenset(settled.names)]
        rivals, better = with_further_rivals(rivals, others), best_placed(settled)
        if better is not last.start.fit:
            last = stage_of(searched, flexible, better)
        freer = with_freer_laws(last, last.start).fit
        if freer is not last.start.fit:
            last = stage_of(searched, flexible, freer)
            if not last.suffices(last.start):
                # What a freer law leaves may be another thing than what the law left.
                last.run(say)
    last.rivals_of_start = [each for each in rivals if each[0].names != last.start.names]
    return last
