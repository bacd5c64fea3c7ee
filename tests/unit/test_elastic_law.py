"""Elastic law of a model: points through which the twist rises everywhere."""

import numpy as np
import pytest

from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.elastic_law import law_of_twist


@pytest.mark.parametrize("compliance", [5e-14, 1.0])
def test_the_twist_rises_even_where_nothing_gives_way(compliance: float) -> None:
    """A law of equal twists has no slope, and the path of the shaft was not a number."""

    def twist(torque: Floats) -> Floats:
        return np.asarray(57.0 * np.sign(torque))

    law = law_of_twist(twist, 15.0, compliance)
    steps = np.diff(law.twist_deg) / np.diff(law.torque_nm)
    assert np.all(np.diff(law.twist_deg) > 0.0)
    # A thousandth of the usual compliance, as ever, where that is more.
    assert np.median(steps) == pytest.approx(max(1e-3 * compliance, 1.27e-4), rel=0.01)
