"""What excites the modes of a drive's train: orders of the input speed, and where they meet."""

from __future__ import annotations

import math

import numpy as np
import polars as pl

from cyclosweep.design.loaded import loaded_state
from cyclosweep.design.published import PublishedDrive
from cyclosweep.dynamics.modes import Modes
from cyclosweep.errors import InputError

__all__ = ["campbell", "excitation_orders"]

HARMONICS = 2
"""Harmonics of each source; higher ones of the transmission error are below a tenth of these."""

_SAMPLES = 256
"""Crank angles of one turn at which the component model's twist is taken; the highest order of a
ratio 119 has two of them a wave."""


def excitation_orders(drive: PublishedDrive, samples: int = _SAMPLES) -> pl.DataFrame:
    """Orders of the input speed at which a drive's twist pulsates under constant torque.

    The eccentric turns once; the discs pass an output pin ``N_OP (1 + 1/i)`` times and a ring pin
    ``i + 1`` times in one turn of the input. A harmonic whose waves of the discs cancel each other
    (their eccentrics stand 360/n degrees apart) does not add up.

    Parameters
    ----------
    drive : Drive
        The drive.
    samples : int
        Crank angles at which the component model is solved.

    Returns
    -------
    polars.DataFrame
        ``source``, ``harmonic``, ``order`` (waves in one turn of the input), ``adds_up``, and
        ``twist_arcmin``: amplitude of the twist at the rated torque by the component model
        [arcmin at the output]; null for a drive without one.
    """
    pins = drive.output_pin_count
    sources = (
        ("eccentric", 1.0, 1),
        ("output pins", pins * (1 + 1 / drive.ratio), pins),
        ("ring pins", float(drive.ratio + 1), drive.ratio + 1),
    )
    rows = [
        (name, h, h * order, (h * waves) % drive.disc_count == 0)
        for name, order, waves in sources
        for h in range(1, HARMONICS + 1)
    ]
    amplitudes = _amplitudes(drive, [order for _, _, order, _ in rows], samples)
    return pl.DataFrame(
        [(*row, amplitude) for row, amplitude in zip(rows, amplitudes, strict=True)],
        schema={
            "source": pl.String,
            "harmonic": pl.Int64,
            "order": pl.Float64,
            "adds_up": pl.Boolean,
            "twist_arcmin": pl.Float64,
        },
        orient="row",
    )


def _amplitudes(drive: PublishedDrive, orders: list[float], samples: int) -> list[float | None]:
    """Amplitudes of waves fitted to the loaded twist over one turn of the crank [arcmin]."""
    if drive.part_study().explain(drive.study(), 0) is not None:
        return [None] * len(orders)
    study, parts = drive.accepted("full")
    crank = np.linspace(0.0, math.tau, samples, endpoint=False)
    torque = drive.output_torque_nm
    states = [loaded_state(study, parts, torque, float(angle), "full") for angle in crank]
    twist = np.array([state.twist_arcmin for state in states])
    waves = [np.ones(samples)]
    for order in orders:
        waves += [np.cos(order * crank), np.sin(order * crank)]
    fitted, *_ = np.linalg.lstsq(np.stack(waves, axis=1), twist, rcond=None)
    return [float(np.hypot(*fitted[1 + 2 * k : 3 + 2 * k])) for k in range(len(orders))]


def campbell(modes: Modes, orders: pl.DataFrame, largest_speed_rpm: float) -> pl.DataFrame:
    """Input speeds at which an order excites a mode.

    Parameters
    ----------
    modes : Modes
        Natural frequencies.
    orders : polars.DataFrame
        As :func:`excitation_orders` gives them.
    largest_speed_rpm : float
        Speeds above it are left out [rpm].

    Returns
    -------
    polars.DataFrame
        ``speed_rpm``, ``mode``, ``frequency_hz``, ``source``, ``order``, ``adds_up``, the slowest
        first.

    Raises
    ------
    InputError
        For a speed that is not above zero.
    """
    if not largest_speed_rpm > 0.0:
        raise InputError(f"speed: found {largest_speed_rpm:g} rpm, expected a number above zero")
    rows = [
        (60 * float(frequency) / order, mode, float(frequency), source, order, adds_up)
        for mode, frequency in enumerate(modes.frequencies_hz, 1)
        for source, order, adds_up in orders.select("source", "order", "adds_up").iter_rows()
        if 0 < 60 * frequency / order <= largest_speed_rpm
    ]
    return pl.DataFrame(
        rows,
        schema={
            "speed_rpm": pl.Float64,
            "mode": pl.Int64,
            "frequency_hz": pl.Float64,
            "source": pl.String,
            "order": pl.Float64,
            "adds_up": pl.Boolean,
        },
        orient="row",
    ).sort("speed_rpm")
