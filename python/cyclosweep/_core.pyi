"""Types of the compiled core."""

from collections.abc import Sequence
from typing import Final, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "DEBUG_BUILD",
    "SEGMENT_FIELDS",
    "DesignError",
    "Study",
    "__version__",
    "active_pins",
    "creep_state",
    "dragged",
    "hole_locus",
    "input_table",
    "kernel_evaluations",
    "output_table",
    "play",
    "remembered_datum",
    "sectors",
    "slip_state",
    "solve_slip",
    "status_labels",
]

DEBUG_BUILD: Final[bool]
SEGMENT_FIELDS: Final[list[str]]
__version__: Final[str]

_Reals = npt.NDArray[np.float64]
_Evaluated = tuple[npt.NDArray[np.uint8], bool, _Reals]

class DesignError(ValueError): ...

@final
class Study:
    def __new__(
        cls,
        base: Sequence[tuple[str, float]],
        kinds: Sequence[str],
        axes: Sequence[tuple[str, str, _Reals]],
        layout: str,
        count: int,
        seed: int,
        loads: Sequence[float],
        limits: Sequence[tuple[str, float, float]],
    ) -> Study: ...
    @property
    def count(self) -> int: ...
    @property
    def evaluated(self) -> int: ...
    def may_not_apply(self, outputs: Sequence[str]) -> list[bool]: ...
    def axes(self, names: Sequence[str], start: int, stop: int) -> npt.NDArray[np.float64]: ...
    def axis_at(self, name: str, indices: npt.NDArray[np.uint64]) -> _Reals: ...
    def evaluate_range(self, start: int, stop: int, outputs: Sequence[str]) -> _Evaluated: ...
    def evaluate_at(
        self, indices: npt.NDArray[np.uint64], outputs: Sequence[str]
    ) -> _Evaluated: ...
    def explain(self, index: int) -> str | None: ...

def kernel_evaluations() -> tuple[int, int]: ...
def input_table() -> list[tuple[str, bool, bool]]: ...
def output_table(loads: Sequence[float]) -> list[tuple[str, str]]: ...
def status_labels() -> list[str]: ...
def active_pins(
    criterion: int, ratio: float, discs: int, pins: int, delta: float, clocking: float
) -> tuple[tuple[float, int, int], tuple[float, float, float], tuple[float, float]]: ...
def sectors(
    criterion: int, ratio: float, discs: int, pins: int, delta: float, clocking: float
) -> list[tuple[float, float, int]]: ...
def hole_locus(
    eccentricity: float, pin_circle_radius: float, ratio: float, hole_angle: float, theta: _Reals
) -> _Reals: ...
def solve_slip(
    torque: _Reals,
    offset: _Reals,
    restart: npt.NDArray[np.bool_],
    start_angle: _Reals,
    slip_angle: _Reals,
    share: _Reals,
    *,
    free_play: float,
    compliance: float,
    limit: float,
    load_factor: float = 0.0,
    growth: float = 0.0,
    reference_torque: float = 1.0,
    law_torque: _Reals | None = None,
    law_twist: _Reals | None = None,
) -> tuple[_Reals, _Reals]: ...
def slip_state(
    angle: _Reals,
    restart: npt.NDArray[np.bool_],
    start_angle: _Reals,
    stretch: _Reals,
    slip_angle: _Reals,
    share: _Reals,
) -> _Reals: ...
def play(
    signal: _Reals,
    half_width: float,
    restart: npt.NDArray[np.bool_],
    start: _Reals,
) -> _Reals: ...
def creep_state(
    signal: _Reals,
    time: _Reals,
    restart: npt.NDArray[np.bool_],
    time_constant: float,
) -> _Reals: ...
def dragged(
    signal: _Reals,
    lapse: _Reals,
    restart: npt.NDArray[np.bool_],
    lag: float,
) -> _Reals: ...
def remembered_datum(push: _Reals, memory: float) -> _Reals: ...
