"""Whether what a model leaves of one run shows in another run too."""

from collections.abc import Mapping
from dataclasses import dataclass, field

LEAST_REPEAT = 0.3
"""Correlation between runs up to which a residual does not repeat."""
REPEATING = 0.5
"""Correlation between runs above which a residual is a property of the drive."""
FEWEST_CELLS = 12
"""Fewest places at which two runs have to be compared."""


@dataclass(frozen=True)
class StepOrder:
    """Order of a staircase: its steps come at equal distances.

    Attributes
    ----------
    cycles_per_deg : float
        Steps in a degree of the measured angle.
    apart_share : float
        Share of the order by which another one must differ to be told from it.
    chance : float
        Share of random staircases with an order at least as clear.
    crest_deg : mapping of int to float
        An angle at which the torque is largest, by the sign of the load; where its legs agree.
    """

    cycles_per_deg: float
    apart_share: float
    chance: float
    crest_deg: Mapping[int, float] = field(default_factory=dict)

    def of_input(self, mesh_ratio: float) -> float:
        """Cycles a turn of the input, which turns so often a turn of the measured shaft."""
        return 360.0 * self.cycles_per_deg / mesh_ratio

    def in_words(self, mesh_ratio: float) -> str:
        """Distance of the steps and their order.

        Parameters
        ----------
        mesh_ratio : float
            Turns of the input a turn of the measured shaft.

        Returns
        -------
        str
        """
        return (
            f"every {1.0 / self.cycles_per_deg:.3g} deg, order {self.of_input(mesh_ratio):.3g} "
            "of a turn of the input"
        )


@dataclass(frozen=True)
class Repetition:
    """How well the residual of one run predicts that of another.

    Attributes
    ----------
    correlation : float
        Between mean residuals in the cells that both runs have visited.
    cells : int
        Number of these cells: bands of torque by flank and direction.
    order : StepOrder or None
        Order of the staircase that repeats; None where its steps have none that can be stated.
    """

    correlation: float
    cells: int
    order: StepOrder | None = None

    @property
    def is_known(self) -> bool:
        """Whether there were two runs of the same loads, long enough to be compared."""
        return self.cells > 0

    @property
    def in_words(self) -> str:
        """Between what it repeats, and how well."""
        return f"from run to run (correlation {self.correlation:.2f})"

    @property
    def is_physics(self) -> bool:
        """Whether something remains that repeats."""
        return self.cells >= FEWEST_CELLS and self.correlation > REPEATING
