"""Whether what a model leaves of one run shows in another run too."""

from dataclasses import dataclass

LEAST_REPEAT = 0.3
"""Correlation between runs up to which a residual does not repeat."""
REPEATING = 0.5
"""Correlation between runs above which a residual is a property of the drive."""
FEWEST_CELLS = 12
"""Fewest places at which two runs have to be compared."""


@dataclass(frozen=True)
class Repetition:
    """How well the residual of one run predicts that of another.

    Attributes
    ----------
    correlation : float
        Between mean residuals in the cells that both runs have visited.
    cells : int
        Number of these cells: bands of torque by flank and direction.
    """

    correlation: float
    cells: int

    @property
    def is_physics(self) -> bool:
        """Whether something remains that repeats."""
        return self.cells >= FEWEST_CELLS and self.correlation > REPEATING
