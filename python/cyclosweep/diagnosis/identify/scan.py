"""Scan of a residual: the evidence in it for every hypothesis, given the structure that left it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.simulation.effects.history import Floats

SEEN = 1e-4
"""Share of a column's energy that must survive the projection for it to be testable."""


def evidence(chi2: Floats | float, rank: Floats | float) -> Floats:
    """Log evidence of a gain, under an empirical-Bayes prior of the amplitudes [nat].

    ``chi2/2 - k/2 - (k/2) ln(chi2/k)``, zero where the gain is below its expectation: the
    likelihood ratio averaged over amplitudes of the best-fitting size.

    Parameters
    ----------
    chi2 : float or ndarray
        Chi-squared that some columns take away.
    rank : float or ndarray
        Projected rank k of these columns.

    Returns
    -------
    ndarray
        Of the shape of `chi2`.
    """
    chi2, rank = np.asarray(chi2, dtype=np.float64), np.asarray(rank, dtype=np.float64)
    safe = np.maximum(chi2, 1e-12)
    value = 0.5 * (chi2 - rank - rank * np.log(safe / np.maximum(rank, 1e-12)))
    return np.where((chi2 > rank) & (rank > 0), value, 0.0)


def vector_penalty(size: Floats, information: Floats) -> float:
    """Log evidence that a vector of amplitudes is charged, all directions equally likely [nat].

    The components are independent and normal beforehand, of the spread that suits them best. A
    direction that must be met closely, as where one component shows a hundred times more than the
    other, is charged the odds against meeting it; a component that does not show at all, nothing.

    Parameters
    ----------
    size : ndarray, shape (k,)
        Amplitudes.
    information : ndarray, shape (k, k)
        Inverse of their covariance.

    Returns
    -------
    float
        In nat.
    """
    strength, axes = np.linalg.eigh(information)
    strength = np.maximum(strength, 0.0)
    gain = strength * (axes.T @ size) ** 2
    top = float(strength.max(initial=0.0))
    if top == 0.0:
        return 0.0
    least = 1e-2 / top
    spread2 = np.geomspace(least, max(10.0 * float(size @ size), 1e2 * least), 81)[:, None]
    seen = 1.0 + spread2 * strength
    return float(np.min(0.5 * np.sum(np.log(seen) + gain / seen, axis=1)))


def shape_choice_penalty(information: Floats, ranges: Floats) -> float:
    """Log of how many values of some parameters a recording tells apart within their ranges [nat].

    Laplace's approximation: the range over the error; nothing for what it does not determine.

    Parameters
    ----------
    information : ndarray, shape (k, k)
        Inverse of the parameters' covariance.
    ranges : ndarray, shape (k,)
        Range of each parameter in the library.

    Returns
    -------
    float
        In nat.
    """
    known = np.maximum(np.linalg.eigvalsh(information * np.outer(ranges, ranges)), 0.0)
    return float(0.5 * np.sum(np.log1p(known / (2.0 * np.pi))))


def likelihood_gain(chi2: Floats, excess: float, freedom: float) -> Floats:
    """Twice the log-likelihood gained by taking chi-squared away from an excess over pure noise.

    The noise is known with so many degrees of freedom only, so gains count by the logarithm; they
    add up over nested models, whatever the order.

    Parameters
    ----------
    chi2 : ndarray
        Chi-squared taken away.
    excess : float
        Chi-squared beyond what noise explains.
    freedom : float
        Degrees of freedom with which the noise is known.

    Returns
    -------
    ndarray
        Of the shape of `chi2`.
    """
    before = np.log1p(np.maximum(excess, chi2) / freedom)
    after = np.log1p(np.maximum(excess - chi2, 0.0) / freedom)
    return np.asarray(freedom * (before - after))


@dataclass(frozen=True, eq=False)
class Scan:
    """Evidence for every hypothesis in the residual of one structure.

    All columns of the library are projected off what the structure itself can explain.

    Attributes
    ----------
    library : Library
    score : ndarray, shape (k,)
        Product of each projected whitened column with the white residual.
    gram : ndarray, shape (k, k)
        Inner products of the projected columns.
    energy : ndarray, shape (k,)
        Inner products of the columns before the projection.
    freedom : float
        Degrees of freedom with which the noise is known.
    excess : float
        Chi-squared of the residual beyond what noise explains.
    """

    library: Library
    score: Floats
    gram: Floats
    energy: Floats
    freedom: float
    excess: float = 0.0

    @cached_property
    def transforms(self) -> list[Floats]:
        """Orthonormal coordinates of each signature, shape (columns, rank)."""
        out = []
        for signature in self.library.signatures:
            part = slice(signature.first, signature.stop)
            inner = self.gram[part, part]
            out.append(_whitener(inner, self.energy[part]))
        return out

    @cached_property
    def ranks(self) -> Floats:
        """Projected rank of each signature."""
        return np.array([t.shape[1] for t in self.transforms], dtype=np.float64)

    def gains(self, score: Floats) -> Floats:
        """Chi-squared that each signature takes away.

        Parameters
        ----------
        score : ndarray, shape (k,) or (k, draws)
            Product of each projected column with a white residual.

        Returns
        -------
        ndarray, shape (signatures,) or (signatures, draws)
        """
        out = np.zeros((len(self.library.signatures), *score.shape[1:]))
        alone = self._single
        if len(alone[0]):
            index, column, factor, sign = alone
            z = score[column] * factor.reshape((-1,) + (1,) * (score.ndim - 1))
            wrong = sign.reshape((-1,) + (1,) * (score.ndim - 1)) * z < 0
            out[index] = np.where(wrong, 0.0, z**2)
        for k, signature in enumerate(self.library.signatures):
            transform = self.transforms[k]
            if transform.shape[1] == 0 or signature.stop - signature.first == 1:
                continue
            part = score[signature.first : signature.stop]
            gain = np.sum((transform.T @ part) ** 2, axis=0)
            if np.any(signature.signs):
                amplitude = transform @ (transform.T @ part)
                signs = signature.signs.reshape((-1,) + (1,) * (score.ndim - 1))
                gain = np.where(np.any(signs * amplitude < 0, axis=0), 0.0, gain)
            out[k] = gain
        return out

    @cached_property
    def _single(self) -> tuple[np.ndarray, np.ndarray, Floats, Floats]:
        """Index, column, scale and sign of the signatures with one column."""
        index, column, factor, sign = [], [], [], []
        for k, signature in enumerate(self.library.signatures):
            if signature.stop - signature.first == 1 and self.transforms[k].shape[1] == 1:
                index.append(k)
                column.append(signature.first)
                factor.append(self.transforms[k][0, 0])
                sign.append(signature.signs[0])
        return np.array(index, int), np.array(column, int), np.array(factor), np.array(sign)

    @cached_property
    def groups(self) -> dict[str, np.ndarray]:
        """Indices of the signatures of each hypothesis that the recording can show."""
        names = np.array([signature.hypothesis for signature in self.library.signatures])
        found: dict[str, np.ndarray] = {}
        for name in dict.fromkeys(names.tolist()):
            members = np.flatnonzero((names == name) & (self.ranks > 0))
            if len(members):
                found[name] = members
        return found

    def evidences(self, gains: Floats) -> Floats:
        """Evidence of each hypothesis, averaged over its shapes [nat].

        Parameters
        ----------
        gains : ndarray, shape (signatures,) or (signatures, draws)
            Chi-squared that each signature takes away.

        Returns
        -------
        ndarray, shape (hypotheses,) or (hypotheses, draws)
        """
        ranks = self.ranks.reshape((-1,) + (1,) * (gains.ndim - 1))
        each = evidence(gains, ranks)
        rows = []
        for members in self.groups.values():
            part = each[members]
            top = part.max(axis=0)
            rows.append(top + np.log(np.mean(np.exp(part - top), axis=0)))
        return np.array(rows)

    @cached_property
    def observed(self) -> Floats:
        """Gain of each signature on the recording."""
        return likelihood_gain(self.gains(self.score), self.excess, self.freedom)

    @cached_property
    def by_hypothesis(self) -> dict[str, float]:
        """Evidence of each hypothesis on the recording."""
        values = self.evidences(self.observed)
        return dict(zip(self.groups, map(float, values), strict=True))

    def best_signature(self, hypothesis: str) -> int:
        """Index of the signature with the largest evidence within a hypothesis."""
        members = self.groups[hypothesis]
        each = evidence(self.observed[members], self.ranks[members])
        return int(members[int(np.argmax(each))])

    @cached_property
    def _root(self) -> Floats:
        """Square root of the projected gram."""
        # Far below what has to survive the projection, and enough to make it definite.
        lifted = self.gram + np.diag(1e-4 * SEEN * self.energy + 1e-300)
        try:
            return np.asarray(np.linalg.cholesky(lifted))
        except np.linalg.LinAlgError:
            pass
        values, vectors = np.linalg.eigh(self.gram)
        keep = values > 1e-10 * max(values[-1], 1e-300)
        return np.asarray(vectors[:, keep] * np.sqrt(values[keep]))

    def draws(self, count: int, rng: np.random.Generator) -> Floats:
        """Scores of recordings with nothing beyond the model at hand.

        Parameters
        ----------
        count : int
            Number of draws.
        rng : numpy.random.Generator

        Returns
        -------
        ndarray, shape (k, count)
        """
        root = self._root
        score = root @ rng.standard_normal((root.shape[1], count))
        if self.freedom < 1000:
            score /= np.sqrt(rng.chisquare(self.freedom, count) / self.freedom)
        return np.asarray(score)

    def null_evidences(self, count: int, rng: np.random.Generator) -> Floats:
        """Evidence of every hypothesis in recordings with nothing more to find [nat].

        Parameters
        ----------
        count : int
            Number of draws.
        rng : numpy.random.Generator

        Returns
        -------
        ndarray, shape (hypotheses, count)
        """
        parts = []
        left = count
        while left > 0:
            part = min(left, 500)
            gains = likelihood_gain(self.gains(self.draws(part, rng)), 0.0, self.freedom)
            parts.append(self.evidences(gains))
            left -= part
        return np.concatenate(parts, axis=1)


def _whitener(inner: Floats, energy: Floats) -> Floats:
    """Matrix that turns a signature's scores into independent unit-variance ones.

    Parameters
    ----------
    inner : ndarray, shape (k, k)
        Inner products of the projected columns.
    energy : ndarray, shape (k,)
        Inner products of the columns before the projection.

    Returns
    -------
    ndarray, shape (k, rank)
    """
    if len(energy) == 1:
        if energy[0] <= 0 or inner[0, 0] < SEEN * energy[0]:
            return np.zeros((1, 0))
        return np.array([[1.0 / np.sqrt(inner[0, 0])]])
    scale = np.where(energy > 0, 1.0 / np.sqrt(np.maximum(energy, 1e-300)), 0.0)
    values, vectors = np.linalg.eigh(inner * np.outer(scale, scale))
    keep = values > SEEN
    return np.asarray(scale[:, None] * vectors[:, keep] / np.sqrt(values[keep]))


def scan(
    library: Library,
    whitened: Floats,
    gram: Floats,
    tangent: Floats,
    residual: Floats,
    freedom: float,
    excess: float = 0.0,
) -> Scan:
    """Scan the residual of a structure for every hypothesis of a library.

    Parameters
    ----------
    library : Library
        The hypotheses.
    whitened : ndarray, shape (n, k)
        Whitened columns of the library.
    gram : ndarray, shape (k, k)
        Their inner products.
    tangent : ndarray, shape (n, q)
        Orthonormal basis of the tangent space of the model at hand.
    residual : ndarray, shape (n,)
        White unit-variance residual of that model.
    freedom : float
        Degrees of freedom with which the noise is known.
    excess : float
        Chi-squared beyond what noise explains.

    Returns
    -------
    Scan
    """
    shadow = tangent.T @ whitened
    projected = gram - shadow.T @ shadow
    score = whitened.T @ residual - shadow.T @ (tangent.T @ residual)
    return Scan(library, score, projected, np.diag(gram).copy(), freedom, excess)
