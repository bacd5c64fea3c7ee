"""Which error of a simulation on all rows counts where a fit to whole loops is chosen."""

import numpy as np
import pytest

from cyclosweep.diagnosis.whole_loop.stepwise import MOST_LATE, WORST, usual_error
from tests.support.searches import search_of


@pytest.mark.parametrize(
    ("share", "counts"), [(0.5 * WORST, False), (0.5 * MOST_LATE, False), (1.5 * MOST_LATE, True)]
)
def test_a_few_crossings_of_the_play_do_not_count(share: float, counts: bool) -> None:
    # A dozen of 2,000 readings on the wrong flank made a fit that was off everywhere better.
    problem = search_of().problem
    rows = np.flatnonzero(problem.whole_fitted)
    simulated = problem.angle_deg + 0.1
    late = rows[:: round(1.0 / share)]
    simulated[late] += 50.0
    error = usual_error(problem, simulated)
    assert (error > 1.0) == counts
    if not counts:
        assert error == pytest.approx(0.1)
