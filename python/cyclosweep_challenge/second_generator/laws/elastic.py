"""Elastic laws: twist as another function of load than a straight line.

Each function returns the angle added per unit of size [deg]; a size of one adds about a degree at
the largest load. Loads are in rated torques. Where a law is published as torque over twist it is
inverted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import special

from cyclosweep_challenge.second_generator.laws.law import Draw, Law, Parameters, State

Array = NDArray[np.float64]

GRID = 4001
"""Points of the twist at which a law given as torque over twist is inverted."""


def _odd(state: State, shape: Parameters) -> tuple[Array, Array]:
    """Sign and magnitude of the elastic torque, the magnitude in parts of the largest load."""
    return np.sign(state.twist), np.abs(state.twist) / shape["top"]


def power_contact(state: State, shape: Parameters) -> Array:
    """Contact whose approach is a power of the load below one, less its chord."""
    sign, part = _odd(state, shape)
    return np.asarray(sign * (part ** shape["power"] - part), dtype=float)


def line_contact_log(state: State, shape: Parameters) -> Array:
    """Line contact by Johnson: approach is load times the logarithm of a length over its width.

    The part in proportion to the load, which holds that length, is compliance and left out.
    """
    sign, part = _odd(state, shape)
    part = np.maximum(part, 1e-12)
    return np.asarray(sign * part * 0.5 * np.log(1.0 / part), dtype=float)


def exponential_approach(state: State, shape: Parameters) -> Array:
    """Joint that stiffens exponentially with closure, so that approach is a logarithm of load."""
    sign, part = _odd(state, shape)
    course = np.log1p(part / shape["knee"]) / np.log1p(1.0 / shape["knee"])
    return np.asarray(sign * (course - part), dtype=float)


def cubic_stiffness(state: State, shape: Parameters) -> Array:
    """Torque as a cubic polynomial of twist: twist less its straight line through zero."""
    sign, part = _odd(state, shape)
    cubic = shape["cubic"]
    # Real root of x + cubic x^3 = part, in closed form.
    scale = np.sqrt(4.0 / (3.0 * cubic))
    root = scale * np.sinh(np.arcsinh(part * 1.5 * np.sqrt(3.0 * cubic)) / 3.0)
    return np.asarray(sign * (root - part) * 4.0, dtype=float)


def _inverted(state: State, shape: Parameters, torque: Array, twist: Array) -> Array:
    """Twist beyond the final tangent of a torque that is tabulated over twist."""
    sign, part = _odd(state, shape)
    reached = np.interp(part * torque[-1], torque, twist)
    return np.asarray(sign * (reached - part * twist[-1]) * 3.0, dtype=float)


def scattered_teeth(state: State, shape: Parameters) -> Array:
    """Teeth with random gaps, each a spring from its own twist on."""
    gaps = np.random.default_rng(int(shape["seed"])).uniform(0.05, 0.8, int(shape["teeth"]))
    twist = np.linspace(0.0, 1.0, GRID)
    tooth = shape["stiffness"] / len(gaps)
    torque = twist + tooth * np.maximum(twist[:, None] - gaps, 0.0).sum(axis=1)
    return _inverted(state, shape, torque, twist)


def softplus_teeth(state: State, shape: Parameters) -> Array:
    """Two groups of teeth whose engagement is smoothed by their elastic tips."""
    twist = np.linspace(0.0, 1.0, GRID)
    torque = twist.copy()
    for gap in (shape["first"], shape["second"]):
        width = shape["width"]
        torque += 0.5 * shape["stiffness"] * width * np.logaddexp(0.0, (twist - gap) / width)
    return _inverted(state, shape, torque - torque[0], twist)


def gaussian_gaps(state: State, shape: Parameters) -> Array:
    """Contacts with normally distributed gaps (Greenwood and Williamson, linear springs)."""
    twist = np.linspace(0.0, 1.0, GRID)
    z = (twist - shape["mean"]) / shape["spread"]
    density = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi)
    met = shape["spread"] * (z * special.ndtr(z) + density)
    torque = twist + shape["stiffness"] * (met - met[0])
    return _inverted(state, shape, torque, twist)


def ramberg_osgood(state: State, shape: Parameters) -> Array:
    """Ramberg-Osgood: a power of the load added to the elastic line."""
    sign, part = _odd(state, shape)
    return sign * part ** shape["power"]


def bilinear_softening(state: State, shape: Parameters) -> Array:
    """Bilinear: a second, softer line beyond a knee."""
    sign, part = _odd(state, shape)
    return sign * np.maximum(part - shape["knee"], 0.0) / (1.0 - shape["knee"])


def flag_shaped(state: State, shape: Parameters) -> Array:
    """Preloaded joint that opens beyond a load and closes at a lower one: a flag-shaped loop."""
    parts, edge, lag = (state.twist / shape["top"]).tolist(), shape["knee"], shape["lag"]
    opened, before, course = 0.0, 0.0, []
    for part, start in zip(parts, state.path.starts.tolist(), strict=True):
        beyond = abs(part) - edge
        if start or part * before < 0.0:
            opened = 0.0
        opened = min(max(opened, beyond, 0.0), max(beyond + lag, 0.0))
        course.append(opened if part > 0.0 else -opened)
        before = part
    return np.array(course) / (1.0 - edge)


def even_magnitude(state: State, shape: Parameters) -> Array:
    """Side load that bends the housing alike in both directions: magnitude of the load."""
    return np.abs(state.twist) / shape["top"]


def even_square(state: State, shape: Parameters) -> Array:
    """Misaligned coupling: square of the load."""
    return (state.twist / shape["top"]) ** 2


def two_stiffnesses(state: State, shape: Parameters) -> Array:
    """Bilinear: another stiffness in one direction of torque than in the other."""
    return np.maximum(state.twist, 0.0) / shape["top"]


def tilted_seat(state: State, shape: Parameters) -> Array:
    """Flange that tilts about one edge: even, square at small loads and linear at large ones."""
    seat = shape["seat"]
    return np.hypot(state.twist / shape["top"], seat) - seat


def _plain(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
    return {"top": top}


def _scaled(**ranges: tuple[float, float]) -> Draw:
    def draw(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
        return {"top": top} | {k: float(rng.uniform(*v)) for k, v in ranges.items()}

    return draw


def _teeth(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
    return {
        "top": top,
        "teeth": float(rng.integers(2, 6)),
        "stiffness": float(rng.uniform(0.5, 2.0)),
        "seed": float(rng.integers(2**31)),
    }


LAWS = (
    Law(
        "contact_stiffening",
        "palmgren",
        "A. Palmgren, Ball and Roller Bearing Engineering, 1959: approach of a roller, Q^0.9",
        _scaled(power=(0.88, 0.92)),
        power_contact,
    ),
    Law(
        "contact_stiffening",
        "johnson-log",
        "K. L. Johnson, Contact Mechanics, Cambridge, 1985, sec. 4.2: line contact",
        _plain,
        line_contact_log,
    ),
    Law(
        "contact_stiffening",
        "hertz-point",
        "H. Hertz, J. reine angew. Math., vol. 92, pp. 156-171, 1882: approach, Q^(2/3)",
        _scaled(power=(0.6666, 0.6667)),
        power_contact,
    ),
    Law(
        "contact_stiffening",
        "exponential-joint",
        "K. L. Johnson, Contact Mechanics, Cambridge, 1985, sec. 13.4: exponential heights of "
        "asperities, so that approach is a logarithm of the load",
        _scaled(knee=(0.03, 0.3)),
        exponential_approach,
    ),
    Law(
        "contact_stiffening",
        "cubic",
        "G. Duffing, Erzwungene Schwingungen, 1918; harmonic drives: T. D. Tuttle, W. P. Seering, "
        "IEEE Trans. Robot. Autom., vol. 12, pp. 368-374, 1996",
        _scaled(cubic=(0.1, 1.0)),
        cubic_stiffness,
    ),
    Law(
        "clearance_takeup",
        "scattered-teeth",
        "Load sharing by clearances: J. G. Blanche, D. C. H. Yang, J. Mech. Transm. Autom. Des., "
        "vol. 111, pp. 337-344, 1989; piecewise linear",
        _teeth,
        scattered_teeth,
    ),
    Law(
        "clearance_takeup",
        "softplus-teeth",
        "T. C. Kim, T. E. Rook, R. Singh, J. Sound Vib., vol. 281, pp. 965-993, 2005: smoothed "
        "clearance functions",
        _scaled(first=(0.1, 0.35), second=(0.45, 0.8), width=(0.01, 0.08), stiffness=(0.5, 2.0)),
        softplus_teeth,
    ),
    Law(
        "clearance_takeup",
        "gaussian-gaps",
        "J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. A, vol. 295, pp. 300-319, 1966",
        _scaled(mean=(0.25, 0.6), spread=(0.05, 0.2), stiffness=(0.5, 2.0)),
        gaussian_gaps,
    ),
    Law(
        "overload_softening",
        "ramberg-osgood",
        "W. Ramberg, W. R. Osgood, NACA TN 902, 1943",
        _scaled(power=(4.0, 9.0)),
        ramberg_osgood,
    ),
    Law(
        "overload_softening",
        "bilinear",
        "R. Hill, The Mathematical Theory of Plasticity, Oxford, 1950: bilinear hardening",
        _scaled(knee=(0.45, 0.75)),
        bilinear_softening,
    ),
    Law(
        "overload_softening",
        "flag-shaped",
        "C. Christopoulos, A. Filiatrault, B. Folz, Earthq. Eng. Struct. Dyn., vol. 31, "
        "pp. 1131-1150, 2002: joints held by preload and friction",
        _scaled(knee=(0.5, 0.75), lag=(0.02, 0.08)),
        flag_shaped,
    ),
    Law(
        "load_asymmetry",
        "magnitude",
        "W. C. Young, R. G. Budynas, Roark's Formulas for Stress and Strain, 7th ed., 2002: "
        "bending by a side load, |T|",
        _plain,
        even_magnitude,
    ),
    Law(
        "load_asymmetry",
        "square",
        "Angular misalignment of couplings: C. B. Gibbons, Proc. 5th Turbomachinery Symp., 1976; "
        "second-order term of the load",
        _plain,
        even_square,
    ),
    Law(
        "load_asymmetry",
        "two-stiffnesses",
        "S. W. Shaw, P. J. Holmes, J. Sound Vib., vol. 90, pp. 129-155, 1983: piecewise linear "
        "oscillator of two stiffnesses",
        _plain,
        two_stiffnesses,
    ),
    Law(
        "load_asymmetry",
        "tilted-seat",
        "Seat that opens at one edge, as flange joints of VDI 2230-1, 2015: hyperbola",
        _scaled(seat=(0.1, 0.5)),
        tilted_seat,
    ),
)
