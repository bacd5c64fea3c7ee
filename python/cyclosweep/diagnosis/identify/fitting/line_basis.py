"""What the calibrated line takes up of a twist."""

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.simulation.effects.history import Floats


def line_basis(fitted: FittedStructure) -> Floats:
    """Orthonormal columns of datum, compliance and free play, whitened, shape (fitted, k)."""
    return orthonormal(fitted.sensitivity[:, : fitted.problem.line_columns], 1e-8)
