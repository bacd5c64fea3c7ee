"""Types of the compiled core."""

from collections.abc import Sequence
from typing import Any, Final, TypedDict, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "DEBUG_BUILD",
    "SEGMENT_FIELDS",
    "DesignError",
    "PartStudy",
    "Study",
    "Train",
    "__version__",
    "active_pins",
    "chain_frequencies",
    "creep_state",
    "dragged",
    "hole_locus",
    "input_table",
    "kernel_evaluations",
    "line_contact",
    "output_table",
    "part_input_table",
    "part_output_table",
    "part_status_labels",
    "play",
    "profile_radii",
    "remembered_datum",
    "sample",
    "sectors",
    "slip_state",
    "solve_slip",
    "status_labels",
    "torque_twist",
    "whiten_weighted",
    "write_parquet",
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
    def fill_axes(self, names: Sequence[str], start: int, stop: int, memory: _Reals) -> None: ...
    def axis_at(self, name: str, indices: npt.NDArray[np.uint64]) -> _Reals: ...
    def evaluate_range(self, start: int, stop: int, outputs: Sequence[str]) -> _Evaluated: ...
    def fill_range(
        self,
        start: int,
        stop: int,
        axes: Sequence[str],
        outputs: Sequence[str],
        are_counts: Sequence[bool],
        real_memory: _Reals,
        count_memory: npt.NDArray[np.uint32],
    ) -> tuple[npt.NDArray[np.uint8], bool]: ...
    def evaluate_at(
        self, indices: npt.NDArray[np.uint64], outputs: Sequence[str]
    ) -> _Evaluated: ...
    def explain(self, index: int) -> str | None: ...

class _Mechanism(TypedDict):
    lobes: int
    discs: int
    output_pins: int
    eccentricity: float
    ring_radius: float
    pin_circle_radius: float
    hole_clocking: float
    ring_gap: float
    ring_enlargement: float
    profile_rotation: float
    hole_gap: float
    ring_stiffness: float
    hole_stiffness: float
    bearing_stiffness: float
    bearing_clearance: float
    shaft_compliance: float
    ring_gap_errors: list[float]
    hole_gap_errors: list[float]
    pin_stiffness: list[float]

class _State(TypedDict):
    converged: bool
    steps: int
    residual: float
    input_torque: float
    twist: float
    stiffness: float
    discs: list[list[float]]
    ring_forces: list[list[float]]
    pin_forces: list[list[float]]
    pressures: list[float]
    budget: list[float]
    shaft_compliance: float
    pin_circle_radius: float

@final
class PartStudy:
    def __new__(
        cls,
        values: Sequence[tuple[str, float]],
        law: str,
        root: Sequence[float],
        ring_gap_errors: Sequence[float],
        hole_gap_errors: Sequence[float],
        engine: str,
        limits: Sequence[tuple[str, float, float, int]],
        published_limits: Sequence[int],
    ) -> PartStudy: ...
    def evaluate_range(
        self, study: Study, start: int, stop: int, outputs: Sequence[str]
    ) -> _Evaluated: ...
    def evaluate_at(
        self, study: Study, indices: npt.NDArray[np.uint64], outputs: Sequence[str]
    ) -> _Evaluated: ...
    def explain(self, study: Study, index: int) -> str | None: ...
    def mechanism(self, study: Study, variant: int) -> _Mechanism: ...
    def state(
        self, study: Study, variant: int, torque: float, crank: float, engine: str
    ) -> _State: ...

def sample(
    axes: Sequence[tuple[str, str, _Reals]],
    layout: str,
    count: int,
    seed: int,
    start: int,
    stop: int,
) -> _Reals: ...
def torque_twist(
    part_study: PartStudy,
    study: Study,
    side: str,
    crank: float,
    sense: float,
    torque: float,
    steps: int,
) -> tuple[_Reals, npt.NDArray[np.bool_], float, bool]: ...

@final
class Train:
    def __new__(
        cls,
        inertias: Sequence[float],
        springs: Sequence[
            tuple[
                int,
                int | None,
                Sequence[float],
                Sequence[float],
                float,
                Sequence[tuple[float, float, float]],
            ]
        ],
        damping_s: float,
    ) -> Train: ...
    def modes(
        self, stiffnesses: Sequence[float]
    ) -> tuple[list[float], list[list[float]], list[list[float]]]: ...
    def static_twists(self, torques: Sequence[float]) -> list[tuple[float, list[float]]]: ...
    def transient(
        self,
        angles: Sequence[float],
        speeds: Sequence[float],
        anchors: Sequence[Sequence[float]],
        knot_times: _Reals,
        knot_torques: _Reals,
        samples: _Reals,
    ) -> dict[str, Any]: ...

def chain_frequencies(inertias: _Reals, stiffnesses: _Reals) -> _Reals: ...
def part_input_table() -> list[tuple[str, str, float, str]]: ...
def part_output_table() -> list[tuple[str, str]]: ...
def part_status_labels() -> list[str]: ...
def line_contact(
    force: float,
    length: float,
    radii: Sequence[float],
    first: Sequence[float],
    second: Sequence[float],
) -> list[float]: ...
def profile_radii(
    lobes: int, ring_radius: float, pin_radius: float, eccentricity: float
) -> list[float]: ...
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
    load_power: float = 0.0,
    growth: float = 0.0,
    reference_torque: float = 1.0,
    forgetting: float = 0.0,
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
    *,
    forgetting: float = 0.0,
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
    power: float = 1.0,
    reference_rate: float = 1.0,
    by_sample: bool = False,
    thinning_rate: float | None = None,
) -> _Reals: ...
def remembered_datum(push: _Reals, memory: float) -> _Reals: ...
def whiten_weighted(
    columns: _Reals, weight: _Reals, share: _Reals, carried: _Reals, fresh: _Reals
) -> _Reals: ...
def write_parquet(
    path: str,
    template: bytes,
    others: bytes,
    metadata: Sequence[tuple[str, str]],
    columns: Sequence[tuple[_Reals, npt.NDArray[np.bool_] | None] | None],
    rows: int,
    rows_per_group: int,
) -> None: ...
