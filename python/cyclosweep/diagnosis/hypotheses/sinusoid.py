"""A wave of unknown frequency: in time (also in proportion to torque), or along the twist.

The periodogram of the residual shows it; the number of frequencies looked at is its price.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from cyclosweep.diagnosis.hypotheses.freeform import FreeForm, clock_of
from cyclosweep.simulation.effects.history import Flags, Floats, History

HUM = "hum"
RIPPLE = "ripple along the twist"
LOADED = "hum in proportion to torque"
FAMILIES = (HUM, RIPPLE, LOADED)
CYCLES = 1.5
"""A hum makes at least this many cycles within the usual run, a ripple within the range of twist.
Slower waves are the job of other shapes."""
FINEST = 250
"""Most ripples within the range of twist that are looked for."""
CAUTION = 1.0
"""Log prior odds against a wave."""


def find_wave(history: History, fitted: Flags, residual: Floats) -> tuple[float, FreeForm | None]:
    """Evidence of the strongest sinusoid in a white residual, and its columns.

    Returns
    -------
    evidence : float
        Half the chi-squared gain less the log of the number of frequencies looked at.
    form : FreeForm or None
        Cosine and sine of that frequency.
    """
    found = [
        _hum(history, fitted, residual),
        _hum(history, fitted, residual, loaded=True),
        _ripple(history, fitted, residual),
    ]
    return max(found, key=lambda pair: pair[0])


def _hum(
    history: History, fitted: Flags, residual: Floats, *, loaded: bool = False
) -> tuple[float, FreeForm | None]:
    clock = clock_of(history)[fitted]
    count = len(clock)
    steps = np.diff(clock)
    positive = steps[steps > 0]
    if count < 60 or len(positive) == 0:
        return 0.0, None
    # Runs may be sampled at different rates: the fast ones tell the high frequencies apart.
    step = float(np.quantile(positive, 0.1))
    cell = np.round((clock - clock[0]) / step)
    if cell[-1] > 60 * count:
        cell = np.arange(count, dtype=np.float64)
        step = float((clock[-1] - clock[0]) / max(count - 1, 1))
    runs = max(int(np.count_nonzero(history.restart & fitted)), 1)
    samples = count / runs * float(np.median(positive)) / step
    unit = "Hz" if history.time_s is not None else "cycles a row"
    return _strongest(
        cell.astype(np.int64),
        residual,
        lowest=CYCLES / samples,
        highest=0.5,
        unit=step,
        family=LOADED if loaded else HUM,
        place="at {:.4g} " + unit + ", all along",
        clock=clock_of,
        factor=(lambda h: h.applied_nm / h.largest_torque_nm) if loaded else None,
        scale=history.applied_nm[fitted] if loaded else None,
    )


def _ripple(history: History, fitted: Flags, residual: Floats) -> tuple[float, FreeForm | None]:
    twist = history.angle_deg[fitted] - history.side[fitted] * history.free_play_deg
    span = float(np.ptp(twist))
    if len(twist) < 60 or span <= 0:
        return 0.0, None
    cells = 8 * FINEST
    step = span / cells
    cell = np.floor((twist - twist.min()) / step).astype(np.int64)
    return _strongest(
        cell,
        residual,
        lowest=CYCLES / cells,
        highest=FINEST / cells,
        unit=step,
        family=RIPPLE,
        place="with {:.4g} cycles a degree, over the whole range",
        clock=lambda h: h.angle_deg - h.side * h.free_play_deg,
    )


def _strongest(
    cell: np.ndarray,
    residual: Floats,
    *,
    lowest: float,
    highest: float,
    unit: float,
    family: str,
    place: str,
    clock: Callable[[History], Floats],
    factor: Callable[[History], Floats] | None = None,
    scale: Floats | None = None,
) -> tuple[float, FreeForm | None]:
    """Strongest frequency between two limits [cycles a cell]."""
    count = len(residual)
    if scale is not None:
        residual = residual * scale / np.sqrt(np.mean(scale**2))
    length = 1 << int(np.ceil(np.log2(2 * (int(cell.max()) + 1))))
    series = np.bincount(cell, residual, minlength=length)[:length]
    power = np.abs(np.fft.rfft(series)) ** 2 / count
    frequency = np.fft.rfftfreq(length)
    usable = (frequency > lowest) & (frequency < highest)
    if np.count_nonzero(usable) < 8:
        return 0.0, None
    power = power / np.maximum(_floor(power), 1.0)
    best = int(np.argmax(np.where(usable, power, 0.0)))
    independent = max(float(np.mean(usable)) * (int(cell.max()) + 1) / 2.0, 1.0)
    value = float(power[best] - np.log(3.5 * independent) - CAUTION)
    chosen = float(frequency[best]) / unit

    def columns(h: History) -> Floats:
        angle = 2 * np.pi * chosen * clock(h)
        waves = np.column_stack([np.cos(angle), np.sin(angle)])
        return waves if factor is None else waves * factor(h)[:, None]

    return max(value, 0.0), FreeForm(family, place.format(chosen), columns)


def _floor(power: Floats) -> Floats:
    """Level of the noise around each frequency, where the whitening was not perfect."""
    width = max(len(power) // 24, 16)
    count = max(len(power) // width, 1)
    edges = np.linspace(0, len(power), count + 1).astype(int)
    level = [float(np.median(power[a:b])) / np.log(2.0) for a, b in pairwise(edges)]
    middle = 0.5 * (edges[1:] + edges[:-1])
    return np.asarray(np.interp(np.arange(len(power)), middle, level), dtype=np.float64)


def null_wave(count: int, rng: np.random.Generator) -> Floats:
    """Evidence of the strongest sinusoid in white noise: the largest of three Gumbel variables."""
    gumbel = -np.log(-np.log(rng.uniform(1e-12, 1.0, (3, count))))
    return np.asarray(np.maximum(gumbel.max(axis=0) - CAUTION, 0.0))
