"""Laws periodic in the position of the mesh or in the indicated angle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.drive import OUTPUT_PINS
from cyclosweep_challenge.second_generator.laws.law import Draw, Law, Parameters, State

Array = NDArray[np.float64]


def _orders(state: State, shape: Parameters, travel: float) -> Array:
    """Sum of the first three orders of the mesh position."""
    mesh = np.deg2rad(state.path.crank_deg + travel * state.mesh_per_deg * state.angle_deg)
    return np.asarray(
        sum(shape[f"order_{k}"] * np.cos(k * mesh - shape[f"phase_{k}"]) for k in (1, 2, 3)),
        dtype=float,
    )


def few_orders(state: State, shape: Parameters) -> Array:
    """Kinematic error of three orders at the position at which the output was locked."""
    return _orders(state, shape, 0.0)


def travelling_orders(state: State, shape: Parameters) -> Array:
    """The same error along the ramp: the mesh travels as the shaft turns."""
    return _orders(state, shape, 1.0)


def sawtooth(state: State, shape: Parameters) -> Array:
    """Cumulative pitch error that is corrected once a turn: a sawtooth."""
    turn = (state.path.crank_deg / 360.0 + shape["phase_1"] / (2.0 * np.pi)) % 1.0
    return 2.0 * turn - 1.0


def pulsating_orders(state: State, shape: Parameters) -> Array:
    """Compliance that varies by three orders of the position."""
    return state.twist / shape["top"] * _orders(state, shape, 0.0)


def tooth_pulsation(state: State, shape: Parameters) -> Array:
    """Rectified sine of the output pins: compliance rises each time a pin changes over."""
    half = 0.5 * OUTPUT_PINS * np.deg2rad(state.path.crank_deg) + shape["phase_1"]
    return state.twist / shape["top"] * np.abs(np.sin(half))


def pin_change(state: State, shape: Parameters) -> Array:
    """Square wave: one active pin more or fewer, twice a turn, with rounded edges."""
    wave = np.cos(np.deg2rad(state.path.crank_deg) - shape["phase_1"]) - shape["duty"]
    return state.twist / shape["top"] * np.tanh(4.0 * wave)


def eccentric_dial(state: State, shape: Parameters) -> Array:
    """Dial mounted off centre: first order of the indicated angle."""
    return np.sin(np.deg2rad(state.angle_deg) - shape["phase_1"])


def tilted_dial(state: State, shape: Parameters) -> Array:
    """Dial off centre and tilted: first and second order of the indicated angle."""
    angle = np.deg2rad(state.angle_deg)
    second = shape["tilt"] * np.sin(2.0 * angle - shape["phase_2"])
    return np.asarray(np.sin(angle - shape["phase_1"]) + second, dtype=float)


def _drawn(**ranges: tuple[float, float]) -> Draw:
    def draw(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
        drawn = {k: float(rng.uniform(*v)) for k, v in ranges.items()}
        orders = {f"order_{k}": float(rng.uniform(0.2, 1.0)) / k for k in (1, 2, 3)}
        phases = {f"phase_{k}": float(rng.uniform(0.0, 2.0 * np.pi)) for k in (1, 2, 3)}
        return {"top": top} | orders | phases | drawn

    return draw


CRANK, INPUT = frozenset({"crank"}), frozenset({"input"})
LAWS = (
    Law(
        "transmission_error",
        "few-orders",
        "D. C. H. Yang, J. G. Blanche, Mech. Mach. Theory, vol. 25, pp. 487-501, 1990: rotational "
        "error of cycloidal drives, few orders of the input",
        _drawn(),
        few_orders,
        CRANK,
    ),
    Law(
        "transmission_error",
        "sawtooth",
        "ISO 1328-1, 2013: cumulative pitch deviation; F. L. Litvin, A. Fuentes, Gear Geometry "
        "and Applied Theory, 2004: piecewise function of transmission errors",
        _drawn(),
        sawtooth,
        CRANK,
    ),
    Law(
        "transmission_error",
        "travelling-orders",
        "D. B. Welbourn, Fundamental knowledge of gear noise, IMechE, 1979: error as a function "
        "of the rotation itself",
        _drawn(),
        travelling_orders,
        frozenset({"crank", "input"}),
    ),
    Law(
        "phase_dependent_compliance",
        "few-orders",
        "C. Gorla et al., J. Mech. Des., vol. 130, 112604, 2008: force distribution over the "
        "turn, Fourier sum",
        _drawn(),
        pulsating_orders,
        CRANK,
    ),
    Law(
        "phase_dependent_compliance",
        "rectified-sine",
        "S. V. Thube, T. R. Bobak, AGMA 12FTM18, 2012: pins that change over; rectified sine",
        _drawn(),
        tooth_pulsation,
        CRANK,
    ),
    Law(
        "phase_dependent_compliance",
        "pin-change",
        "A. Kahraman, R. Singh, J. Sound Vib., vol. 146, pp. 135-156, 1991: mesh stiffness that "
        "varies by steps",
        _drawn(duty=(-0.3, 0.3)),
        pin_change,
        CRANK,
    ),
    Law(
        "dial_eccentricity",
        "eccentric",
        "T. Masuda, M. Kajitani, Precis. Eng., vol. 11, pp. 95-100, 1989: eccentricity of angle "
        "encoders, first order",
        _drawn(),
        eccentric_dial,
        INPUT,
    ),
    Law(
        "dial_eccentricity",
        "eccentric-and-tilted",
        "X.-D. Lu, D. L. Trumper, CIRP Ann., vol. 56, pp. 499-502, 2007: first and second order",
        _drawn(tilt=(0.15, 0.5)),
        tilted_dial,
        INPUT,
    ),
)
