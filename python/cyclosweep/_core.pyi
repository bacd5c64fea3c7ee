"""Types of the Rust core."""

import numpy as np
from numpy.typing import NDArray

DEBUG_BUILD: bool
__version__: str

def solve_slip(
    torque: NDArray[np.float64],
    offset: NDArray[np.float64],
    restart: NDArray[np.bool_],
    start_angle: NDArray[np.float64],
    slip_angle: NDArray[np.float64],
    share: NDArray[np.float64],
    *,
    free_play: float,
    compliance: float,
    limit: float,
    load_factor: float = 0.0,
    growth: float = 0.0,
    reference_torque: float = 1.0,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
def slip_state(
    angle: NDArray[np.float64],
    restart: NDArray[np.bool_],
    start_angle: NDArray[np.float64],
    slip_angle: NDArray[np.float64],
    share: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def play(
    input: NDArray[np.float64],
    half_width: float,
    restart: NDArray[np.bool_],
    start: NDArray[np.float64],
) -> NDArray[np.float64]: ...
def creep_state(
    input: NDArray[np.float64],
    time: NDArray[np.float64],
    restart: NDArray[np.bool_],
    time_constant: float,
) -> NDArray[np.float64]: ...
def remembered_datum(push: NDArray[np.float64], memory: float) -> NDArray[np.float64]: ...
