"""Moving zeros: the datum that remembers runs, and what follows temperature."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.laws.law import Draw, Law, Parameters, State

Array = NDArray[np.float64]


def _runs(state: State) -> tuple[NDArray[np.int64], Array, Array]:
    """Number of each row's run from zero, and each run's largest and last large load, shape (R,).

    The last large load is the turning point beyond half of the largest that was passed last.
    """
    index = np.unique(state.path.run, return_inverse=True)[1].astype(np.int64)
    count = int(index[-1]) + 1
    largest, last = np.zeros(count), np.zeros(count)
    for k in range(count):
        load = state.twist[index == k]
        largest[k] = np.abs(load).max()
        far = load[np.abs(load) > 0.5 * largest[k]]
        last[k] = far[-1] if len(far) else 0.0
    return index, largest, last


def to_and_fro(state: State, shape: Parameters) -> Array:
    """Hereditary datum that swings: complex roots, driven by what each run did last."""
    index, _, last = _runs(state)
    damping, turn = shape["damping"], shape["turn"]
    zero = np.zeros(len(last))
    for k in range(1, len(zero)):
        older = zero[k - 2] if k > 1 else 0.0
        kick = np.sign(last[k - 1]) * (abs(last[k - 1]) / shape["top"]) ** 0.5
        zero[k] = 2.0 * damping * np.cos(turn) * zero[k - 1] - damping**2 * older + kick
    return zero[index]


def random_walk(state: State, shape: Parameters) -> Array:
    """Random walk of the zero from run to run."""
    index, _, _ = _runs(state)
    seed = [int(shape["seed"]), len(state.path), int(state.path.time_s[-1])]
    steps = np.random.default_rng(seed).normal(0.0, 1.0, int(index[-1]) + 1)
    return np.asarray(np.cumsum(steps)[index], dtype=float)


def ratchet(state: State, shape: Parameters) -> Array:
    """Ratcheting: each run moves the zero one way, by a power of its load, less and less."""
    index, largest, _ = _runs(state)
    steps = (largest / shape["top"]) ** shape["power"] / np.arange(1, len(largest) + 1)
    zero = np.concatenate([[0.0], np.cumsum(steps)[:-1]])
    return zero[index]


def remanence(state: State, shape: Parameters) -> Array:
    """Remanence: a new run begins where the last left the interface, wiped by larger loads."""
    index, largest, last = _runs(state)
    zero = np.zeros(len(last))
    for k in range(1, len(zero)):
        kept = shape["kept"] * (1.0 - 0.5 * largest[k - 1] / shape["top"])
        zero[k] = kept * zero[k - 1] + np.tanh(2.0 * last[k - 1] / shape["top"])
    return zero[index]


def _warmth(state: State) -> Array:
    """Rise of the housing's temperature in tens of degrees [10 K]."""
    warmth = state.path.temperature_c - state.path.temperature_c[0]
    return np.asarray(warmth / 10.0, dtype=float)


def lagged_housing(state: State, shape: Parameters) -> Array:
    """Datum that follows the housing with a first-order lag: the parts inside warm later."""
    warm, time = _warmth(state), state.path.time_s
    fade = np.exp(-np.diff(time, prepend=time[0]) / shape["lag"])
    now, course = 0.0, []
    for f, w in zip(fade.tolist(), warm.tolist(), strict=True):
        now = f * now + (1.0 - f) * w
        course.append(now)
    return np.array(course)


def warm_compliance(state: State, shape: Parameters) -> Array:
    """Young's modulus that falls with temperature: twist in proportion to load and warmth."""
    return _warmth(state) * state.twist / shape["top"]


def expansion(state: State, shape: Parameters) -> Array:
    """Free expansion of a bracket: datum in proportion to the temperature."""
    return _warmth(state)


def warm_play(state: State, shape: Parameters) -> Array:
    """Clearances that grow or shrink with temperature, alike on both sides of the play."""
    return _warmth(state) * state.side


def _drawn(**ranges: tuple[float, float]) -> Draw:
    def draw(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
        drawn = {k: float(rng.uniform(*v)) for k, v in ranges.items()}
        chance = {"seed": float(rng.integers(2**31)), "lag": duration_s * rng.uniform(0.01, 0.1)}
        return {"top": top} | chance | drawn

    return draw


RUNS, WARM = frozenset({"runs"}), frozenset({"temperature"})
LAWS = (
    Law(
        "datum_drift",
        "to-and-fro",
        "N. Kumar et al., 2016: the zero of an unreset rig moves one way and then the other; "
        "second-order recurrence as in V. Volterra, hereditary mechanics, 1913",
        _drawn(damping=(0.6, 0.9), turn=(0.6, 1.8)),
        to_and_fro,
        RUNS,
    ),
    Law(
        "datum_drift",
        "random-walk",
        "D. W. Allan, Proc. IEEE, vol. 54, pp. 221-230, 1966: random walk of a zero",
        _drawn(),
        random_walk,
        RUNS,
        True,
    ),
    Law(
        "datum_drift",
        "ratchet",
        "J. L. Chaboche, Int. J. Plast., vol. 7, pp. 661-678, 1991: ratcheting by cycles",
        _drawn(power=(1.0, 4.0)),
        ratchet,
        RUNS,
    ),
    Law(
        "datum_drift",
        "remanence",
        "I. D. Mayergoyz, Mathematical Models of Hysteresis, 1991: wiping-out of remanence",
        _drawn(kept=(0.2, 0.8)),
        remanence,
        RUNS,
    ),
    Law(
        "thermal_drift",
        "lagged-housing",
        "J. Mayr et al., CIRP Ann., vol. 61, pp. 771-791, 2012: first-order lag of thermal error",
        _drawn(),
        lagged_housing,
        WARM,
    ),
    Law(
        "thermal_drift",
        "warm-compliance",
        "Y. P. Varshni, Phys. Rev. B, vol. 2, pp. 3952-3958, 1970: elastic constants fall with "
        "temperature",
        _drawn(),
        warm_compliance,
        WARM,
    ),
    Law(
        "thermal_drift",
        "expansion",
        "J. Bryan, CIRP Ann., vol. 39, pp. 645-656, 1990: expansion in the measuring loop",
        _drawn(),
        expansion,
        WARM,
    ),
    Law(
        "thermal_drift",
        "warm-play",
        "T. A. Harris, M. N. Kotzalas, Rolling Bearing Analysis, 2006, ch. 3: clearance by "
        "temperature",
        _drawn(),
        warm_play,
        WARM,
    ),
)
