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
    whole_gram : ndarray, shape (k, k)
        Inner products of the columns before the projection.
    shadow : ndarray, shape (q, k)
        What the projection takes off them, in its own orthonormal basis.
    freedom : float
        Degrees of freedom with which the noise is known.
    excess : float
        Chi-squared of the residual beyond what noise explains.
    """

    library: Library
    score: Floats
    whole_gram: Floats
    shadow: Floats
    freedom: float
    excess: float = 0.0

    @cached_property
    def energy(self) -> Floats:
        """Sum of squares of each column before the projection, shape (k,)."""
        return np.diag(self.whole_gram).copy()

    @cached_property
    def left(self) -> Floats:
        """Sum of squares of each projected column, shape (k,)."""
        return np.asarray(self.energy - np.sum(self.shadow**2, axis=0))

    @cached_property
    def gram(self) -> Floats:
        """Inner products of the projected columns, shape (k, k)."""
        return np.asarray(self.whole_gram - self.shadow.T @ self.shadow)

    @cached_property
    def alone(self) -> Floats:
        """Scale that makes each column one of unit length, zero where it is lost, shape (k,)."""
        seen = (self.energy > 0) & (self.left >= SEEN * self.energy)
        return np.where(seen, 1.0 / np.sqrt(np.where(seen, self.left, 1.0)), 0.0)

    @cached_property
    def _together(self) -> dict[int, Floats]:
        """Orthonormal coordinates of the signatures of several columns, by index."""
        found = {}
        for k in self.library.several:
            part = slice(self.library.signatures[k].first, self.library.signatures[k].stop)
            shadow = self.shadow[:, part]
            inner = self.whole_gram[part, part] - shadow.T @ shadow
            found[k] = _whitener(inner, self.energy[part])
        return found

    def transform(self, index: int) -> Floats:
        """Orthonormal coordinates of a signature.

        Parameters
        ----------
        index : int
            Which of the library's signatures.

        Returns
        -------
        ndarray, shape (columns, rank)
        """
        if index in self._together:
            return self._together[index]
        factor = self.alone[self.library.signatures[index].first]
        return np.full((1, 1), factor) if factor > 0 else np.zeros((1, 0))

    @cached_property
    def ranks(self) -> Floats:
        """Projected rank of each signature."""
        out = np.zeros(len(self.library.signatures))
        index, column, _ = self.library.single
        out[index] = self.alone[column] > 0
        for k, transform in self._together.items():
            out[k] = transform.shape[1]
        return out

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
        along = (-1,) + (1,) * (score.ndim - 1)
        index, column, sign = self.library.single
        z = score[column] * self.alone[column].reshape(along)
        out[index] = np.where(sign.reshape(along) * z < 0, 0.0, z**2)
        for k, transform in self._together.items():
            if transform.shape[1] == 0:
                continue
            signature = self.library.signatures[k]
            part = score[signature.first : signature.stop]
            gain = np.sum((transform.T @ part) ** 2, axis=0)
            if np.any(signature.signs):
                amplitude = transform @ (transform.T @ part)
                wrong = signature.signs.reshape(along) * amplitude < 0
                gain = np.where(np.any(wrong, axis=0), 0.0, gain)
            out[k] = gain
        return out

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
    # In one product, because reading the columns takes longest.
    products = np.column_stack([tangent, residual]).T @ whitened
    shadow, score = products[:-1], products[-1] - products[:-1].T @ (tangent.T @ residual)
    return Scan(library, score, gram, shadow, freedom, excess)
