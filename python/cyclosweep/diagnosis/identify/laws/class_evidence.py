"""Evidence for a class of behaviour: the likelihood averaged over all amplitudes of its columns.

The amplitudes of a class are independent and normal beforehand, with one variance that suits the
recording best (empirical Bayes). A class is so charged for as many directions as the recording
tells apart, and no more: a smooth curve costs little more than the law that made it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import CLASSES_OF_FAMILY, class_columns
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.structures.scan import likelihood_gain
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES, orthonormal
from cyclosweep.simulation.effects.conditioning import CONDITIONING
from cyclosweep.simulation.effects.history import Floats

NARROWEST = 1e-9
"""Share of a group's largest energy from which one of its directions counts."""
SPREADS = 60
"""Variances of the amplitudes that are tried."""
WEAKEST, STRONGEST = -3.0, 25.0
"""Logarithm of the smallest and the largest variance that is tried, in units of the noise along the
group's clearest direction."""


@dataclass(frozen=True, eq=False)
class ClassEvidence:
    """What a class explains of a residual.

    Attributes
    ----------
    evidence : float
        Log evidence of the class over none [nat].
    explained : float
        Chi-squared of what it explains, noise taken off.
    twist : ndarray, shape (fitted,)
        What it explains, whitened, in units of the noise.
    """

    evidence: float
    explained: float
    twist: Floats


@dataclass(frozen=True, eq=False)
class ClassColumns:
    """Whitened columns of every class on the fitted rows of one structure.

    Attributes
    ----------
    columns : dict of str to ndarray, shape (fitted, k)
        By the name of the class.
    freedom : float
        Degrees of freedom with which the noise is known.
    scale : float
        Factor by which columns are multiplied, and residuals are to be: where what is left is error
        of the model, all rows together count as a few independent pieces.
    """

    columns: dict[str, Floats]
    freedom: float
    scale: float = 1.0

    @classmethod
    def of(cls, fitted: FittedStructure) -> "ClassColumns":
        """Columns of every class that a recording can show, whitened.

        Parameters
        ----------
        fitted : FittedStructure
            The structure whose residual is looked at.

        Returns
        -------
        ClassColumns
        """
        problem, noise = fitted.problem, fitted.noise
        use = problem.fitted
        _, weight = noise.residual(problem.angle_deg[use], fitted.mean_deg[use])
        friction = next((term.shape for term in fitted.terms if term.slips), {})
        made = class_columns(fitted.history, friction.get(CONDITIONING, 0.0))
        in_series = {
            name
            for term in fitted.terms
            if term.in_series
            for name in CLASSES_OF_FAMILY.get(term.family, ())
        }
        if in_series:
            applied = class_columns(fitted.history.under_applied_torque)
            made |= {name: applied[name] for name in in_series & made.keys()}
        scale, freedom = 1.0, noise.freedom
        if noise.structured:
            freedom = min(INDEPENDENT_PIECES, freedom)
            scale = float(np.sqrt(freedom / max(problem.count, 1)))
        columns = {k: scale * noise.design(each[use], weight) for k, each in made.items()}
        return cls(columns, freedom, scale)

    def evidence(self, name: str, known: Floats, residual: Floats) -> ClassEvidence:
        """Evidence for one class in a residual.

        Parameters
        ----------
        name : str
            Name of the class.
        known : ndarray, shape (fitted, q)
            Orthonormal basis of what is fitted besides.
        residual : ndarray, shape (fitted,)
            White unit-variance residual, orthogonal to it.

        Returns
        -------
        ClassEvidence
        """
        columns = self.columns[name]
        columns = columns - known @ (known.T @ columns)
        left, singular, _ = np.linalg.svd(columns, full_matrices=False)
        energy = singular**2
        top = float(np.max(np.sum(self.columns[name] ** 2, axis=0), initial=0.0))
        kept = energy > NARROWEST * max(top, 1e-300)
        if not np.any(kept):
            return ClassEvidence(0.0, 0.0, np.zeros_like(residual))
        left, energy = left[:, kept], energy[kept]
        along = left.T @ residual
        excess = max(float(residual @ residual) - self.freedom, 0.0)
        spread = np.exp(np.linspace(WEAKEST, STRONGEST, SPREADS))[:, None] / energy.max()
        share = 1.0 - 1.0 / (1.0 + spread * energy)
        drop = share @ along**2
        gain = 0.5 * likelihood_gain(drop, excess, self.freedom)
        value = gain + 0.5 * np.sum(np.log1p(-share), axis=1)
        best = int(np.argmax(value))
        if value[best] <= 0.0:
            return ClassEvidence(0.0, 0.0, np.zeros_like(residual))
        twist = left @ (share[best] * along)
        size = float(twist @ twist - np.sum(share[best] ** 2))
        return ClassEvidence(float(value[best]), max(size, 0.0), twist)

    def evidence_together(
        self, alone: Mapping[str, ClassEvidence], known: Floats, residual: Floats
    ) -> float:
        """Evidence for several classes, strongest first, each of what those before leave [nat].

        An approximation of the joint evidence: columns that classes have in common count once.

        Parameters
        ----------
        alone : mapping of str to ClassEvidence
            The classes, each with its evidence alone.
        known : ndarray, shape (fitted, q)
            Orthonormal basis of what is fitted besides.
        residual : ndarray, shape (fitted,)
            White unit-variance residual, orthogonal to it.

        Returns
        -------
        float
        """
        strongest, *others = sorted(alone, key=lambda name: -alone[name].evidence)
        found = alone[strongest]
        total = found.evidence
        for name in others:
            residual = residual - found.twist
            found = self.evidence(name, known, residual)
            total += found.evidence
        return total

    def beside(self, known: Floats, name: str) -> Floats:
        """Basis of what is fitted with all columns of a class.

        Parameters
        ----------
        known : ndarray, shape (fitted, q)
            Orthonormal basis of what is fitted.
        name : str
            Name of the class.

        Returns
        -------
        ndarray, shape (fitted, q + k)
        """
        return orthonormal(np.column_stack([known, self.columns[name]]), 1e-6)
