"""A plain torsion rig for tests: programmes, contact laws solved by bisection, families of noise.

Its laws are chosen to differ in form from those the diagnosis fits.
"""

import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

import cyclosweep as cs
from tests.support.arrays import Floats, Integers

COMPLIANCE = 19.8 / 7.2575
PLAY = 28.0


def _ramp(points: Sequence[float], rate: float, step: float) -> list[float]:
    out = [points[0]]
    for a, b in itertools.pairwise(points):
        count = max(int(abs(b - a) / (rate * step)), 2)
        out += list(np.linspace(a, b, count + 1)[1:])
    return out


def programme(
    rng: np.random.Generator, kind: str = "rich", scale: float = 1.0
) -> tuple[Floats, Floats, Integers, Floats, Floats]:
    """Columns torque, time, run, crank, temperature."""
    top = 31.0
    torque, time, run, crank = [], [], [], []
    clock = 0.0
    spots = rng.uniform(0, 360, 7)
    runs = {"rich": 12, "medium": 8, "poor": 6}[kind]
    for r in range(runs):
        m = top * rng.choice([0.25, 0.4, 0.6, 0.8, 1.0]) if r else top
        rate = rng.choice([0.25, 0.75, 2.2]) if kind == "rich" else 0.5
        if kind == "poor":
            path = _ramp([0.4, m, 0.4], rate, 1.0 / scale)
        else:
            path = _ramp([0.4, m, -m, 0.55 * m, 0.4, 0.8 * m], rate, 1.0 / scale)
            if kind == "rich":
                path += [0.8 * m] * int(40 * scale)
                path += _ramp([0.8 * m, 0.3 * m, 0.8 * m, 0.4], rate, 1.0 / scale)[1:]
        n = len(path)
        torque += path
        time += list(clock + np.arange(n) / scale)
        run += [r + 1] * n
        crank += [spots[rng.integers(7)] if kind == "rich" else 0.0] * n
        clock += n / scale + rng.uniform(150, 300)
    at = np.array(time)
    warm = 20 + 8 * (1 - np.exp(-at / 3000)) + 1.2 * np.sin(at / 400 + rng.uniform(0, 6))
    return np.array(torque), at, np.array(run), np.array(crank), warm


def _solve(law: Callable[[Floats], Floats], target: Floats) -> Floats:
    low, high = np.full_like(target, -400.0), np.full_like(target, 400.0)
    for _ in range(60):
        mid = 0.5 * (low + high)
        under = law(mid) < target
        low, high = np.where(under, mid, low), np.where(under, high, mid)
    return 0.5 * (low + high)


def effect(
    name: str,
    rng: np.random.Generator,
    torque: Floats,
    time: Floats,
    run: Integers,
    crank: Floats,
    warm: Floats,
) -> Floats:
    """Extra twist [deg] that an effect makes, of arbitrary size."""
    return np.asarray(_effect(name, rng, torque, time, run, crank, warm), dtype=np.float64)


def _effect(
    name: str,
    rng: np.random.Generator,
    torque: Floats,
    time: Floats,
    run: Integers,
    crank: Floats,
    warm: Floats,
) -> Any:
    side = np.where(torque >= 0, 1.0, -1.0)
    load, top = np.abs(torque), np.abs(torque).max()
    starts = np.r_[True, np.diff(run) != 0]
    base = COMPLIANCE * torque + side * PLAY
    if name in ("friction_hysteresis", "load_dependent_friction"):
        # Dahl friction along the path of the shaft.
        reach = np.exp(rng.uniform(np.log(0.5), np.log(6)))
        state, out = 0.0, np.zeros(len(torque))
        for i in range(len(torque)):
            if starts[i]:
                state = 0.0
            else:
                move = base[i] - base[i - 1]
                s = np.sign(move)
                state = s + (state - s) * np.exp(-abs(move) / reach)
            out[i] = state
        return -out * (1 if name == "friction_hysteresis" else load / top)
    if name == "contact_stiffening":
        k = np.exp(rng.uniform(np.log(0.3), np.log(2)))
        return side * _solve(lambda x: np.sign(x) * k * np.abs(x) ** 1.5, load)
    if name == "clearance_takeup":
        gaps = np.sort(rng.uniform(0, 0.6 * top, rng.integers(2, 6)))
        return side * _solve(lambda x: x + sum(0.15 * np.maximum(x - g, 0) for g in gaps), load)
    if name == "overload_softening":
        onset = rng.uniform(0.4, 0.75) * top
        width = 0.05 * top
        return side * width * np.logaddexp(0, (load - onset) / width)
    if name == "datum_drift":
        out, shift = np.zeros(len(torque)), 0.0
        keep = rng.uniform(0.5, 0.95)
        for r in np.unique(run):
            out[run == r] = shift
            shift = keep * shift + np.tanh(load[run == r].max() / top) * rng.uniform(0.6, 1.4)
        return out
    if name == "creep":
        tau = np.exp(rng.uniform(np.log(15), np.log(120)))
        out, state = np.zeros(len(torque)), 0.0
        for i in range(len(torque)):
            if starts[i]:
                state = 0.0
            else:
                h = (time[i] - time[i - 1]) / 10
                for _ in range(10):
                    state += h * (torque[i] - state) / tau
            out[i] = state
        return out
    if name == "phase_dependent_compliance":
        m = rng.choice([1, 2, 3, 4, 8])
        wave = np.cos(np.radians(m * crank) + rng.uniform(0, 6.3))
        return torque * (wave + 0.2 * wave**2)
    if name == "transmission_error":
        waves = [
            np.cos(np.radians(m * crank) + rng.uniform(0, 6.3)) * rng.uniform(0.2, 1) / m
            for m in range(1, rng.integers(2, 5))
        ]
        return np.sum(waves, axis=0)
    if name == "thermal_drift":
        return warm - 20.0
    if name == "viscous_drag":
        rate = np.gradient(torque) / np.gradient(time)
        rate[starts] = 0
        return -rate
    if name == "load_asymmetry":
        return load + 0.01 * load**2
    if name == "dial_eccentricity":
        return np.sin(np.radians(base) + rng.uniform(0, 6.3))
    if name == "slip_event":
        return (np.arange(len(torque)) > rng.uniform(0.2, 0.8) * len(torque)) * 1.0
    if name == "bump":
        return side * np.exp(-0.5 * ((load - rng.uniform(0.3, 0.8) * top) / (0.05 * top)) ** 2)
    if name == "hum":
        return np.sin(time * rng.uniform(0.5, 2.5) + 1)
    if name == "telegraph":
        flips = np.cumsum(rng.random(len(torque)) < 0.005) % 2
        return flips * 1.0
    if name == "saturation":
        return -side * np.maximum(load - 0.93 * top, 0.0)
    if name == "early_saturation":
        return -side * np.maximum(load - 0.65 * top, 0.0)
    raise ValueError(name)


def noise_of(rng: np.random.Generator, n: int, family: str, sigma: float) -> Floats:
    """Noise of unit family times sigma."""
    if family.startswith("ar"):
        rho = float(family[2:])
        white = rng.standard_normal(n)
        out = np.zeros(n)
        out[0] = white[0]
        for i in range(1, n):
            out[i] = rho * out[i - 1] + np.sqrt(1 - rho**2) * white[i]
        return sigma * out
    if family == "t3":
        return np.asarray(sigma * rng.standard_t(3, n) / np.sqrt(3))
    if family == "outliers":
        out = rng.standard_normal(n)
        out[rng.random(n) < 0.01] *= 12
        return sigma * out
    return sigma * rng.standard_normal(n)


def record(
    seed: int,
    effects: Sequence[str] = (),
    d: npt.ArrayLike = 10.0,
    kind: str = "rich",
    family: str = "white",
    sigma: float = 0.2,
    step: float = 0.0,
    scale: float = 1.0,
) -> cs.Recording:
    """A recording with effects at these projected signal-to-noise ratios."""
    rng = np.random.default_rng(seed)
    torque, time, run, crank, warm = programme(rng, kind, scale)
    side = np.where(torque >= 0, 1.0, -1.0)
    c, g, z = COMPLIANCE * rng.uniform(0.85, 1.15), PLAY * rng.uniform(0.95, 1.05), rng.normal()
    angle = z + side * g + c * torque
    base = np.column_stack([np.ones_like(side), side, torque])
    sizes = np.broadcast_to(d, len(effects))
    for name, size in zip(effects, sizes, strict=True):
        extra = effect(name, rng, torque, time, run, crank, warm)
        left = extra - base @ np.linalg.lstsq(base, extra, rcond=None)[0]
        signed = name in ("datum_drift", "thermal_drift", "load_asymmetry")
        sign = rng.choice([-1.0, 1.0]) if signed else 1.0
        angle = angle + sign * extra * size * sigma / np.linalg.norm(left)
    angle = angle + noise_of(rng, len(torque), family, sigma)
    if step:
        angle = np.round(angle / step) * step
    keep = np.abs(torque) > 0.4
    return cs.Recording.from_arrays(
        torque[keep],
        angle[keep],
        time_s=time[keep],
        run=run[keep],
        crank_deg=crank[keep],
        temperature_c=warm[keep],
        angle_resolution_deg=step,
        drive="reference-87",
    )
