"""Types of the arrays that tests pass around."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def present(column: Floats | None) -> Floats:
    """Return a column that a recording may lack and here has."""
    assert column is not None
    return column
