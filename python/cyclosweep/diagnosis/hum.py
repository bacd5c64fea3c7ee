"""A hum of unknown frequency: the periodogram of the residual, with its own look-elsewhere price."""

from itertools import pairwise

import numpy as np

from cyclosweep.diagnosis.freeform import FreeForm, clock_of
from cyclosweep.effects.history import Flags, Floats, History

FAMILY = "hum"
CYCLES = 4.0
"""A hum makes at least this many cycles within the usual run; slower waves are other shapes' job."""


def find_hum(history: History, fitted: Flags, residual: Floats) -> tuple[float, FreeForm | None]:
    """Evidence of the strongest sinusoid in a white residual, and its columns.

    Returns
    -------
    evidence : float
        Half the chi-squared gain less the log of the number of frequencies looked at.
    form : FreeForm or None
        Cosine and sine of that frequency.
    """
    clock = clock_of(history)[fitted]
    count = len(clock)
    steps = np.diff(clock)
    positive = steps[steps > 0]
    if count < 60 or len(positive) == 0:
        return 0.0, None
    step = float(np.median(positive))
    cell = np.round((clock - clock[0]) / step).astype(np.int64)
    if cell[-1] > 60 * count:
        cell = np.arange(count)
        step = float((clock[-1] - clock[0]) / max(count - 1, 1))
    length = 1 << int(np.ceil(np.log2(2 * (cell[-1] + 1))))
    series = np.bincount(cell, residual, minlength=length)[:length]
    power = np.abs(np.fft.rfft(series)) ** 2 / count
    frequency = np.fft.rfftfreq(length, step)
    samples = count / max(int(np.count_nonzero(history.restart & fitted)), 1)
    usable = frequency > CYCLES / (samples * step)
    if not np.any(usable):
        return 0.0, None
    power = power / np.maximum(_floor(power), 1.0)
    best = int(np.argmax(np.where(usable, power, 0.0)))
    looked = max(count / 2.0 * np.mean(usable), 1.0)
    value = float(power[best] - np.log(3.5 * looked) - 1.0)
    chosen = float(frequency[best])

    def waves(h: History) -> Floats:
        angle = 2 * np.pi * chosen * clock_of(h)
        return np.column_stack([np.cos(angle), np.sin(angle)])

    unit = "Hz" if history.time_s is not None else "cycles a row"
    return max(value, 0.0), FreeForm(FAMILY, f"at {chosen:.4g} {unit}, all along", waves)


def _floor(power: Floats) -> Floats:
    """Level of the noise around each frequency, where the whitening was not perfect."""
    width = max(len(power) // 24, 16)
    count = max(len(power) // width, 1)
    edges = np.linspace(0, len(power), count + 1).astype(int)
    level = [float(np.median(power[a:b])) / np.log(2.0) for a, b in pairwise(edges)]
    return np.interp(np.arange(len(power)), 0.5 * (edges[1:] + edges[:-1]), level)


def null_hum(count: int, rng: np.random.Generator) -> Floats:
    """Evidence of the strongest sinusoid in white noise: a Gumbel variable."""
    return np.maximum(-np.log(-np.log(rng.uniform(1e-12, 1.0, count))) - 1.0, 0.0)
