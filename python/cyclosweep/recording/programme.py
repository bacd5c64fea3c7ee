"""Load programmes for another drive or rig: scaled to its largest load, as a sheet to fill in."""

from dataclasses import replace

import numpy as np
import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.errors import InputError
from cyclosweep.recording.recording import Recording
from cyclosweep.recording.units import KILOPOND_N

__all__ = ["beyond_fit", "beyond_rating", "scaled_programme", "sheet_of"]

SAME_LOAD = 0.05
"""Share of the largest torque by which a programme may go beyond a recording of the same load."""
WEIGHT_DIGITS = 3
"""Digits of a weight in kg: a gram on a lever is less than any friction of a rig."""


def scaled_programme(programme: Recording, largest_nm: float) -> Recording:
    """Scale a load programme so that its largest torque is another.

    Parameters
    ----------
    programme : Recording
        The programme.
    largest_nm : float
        Largest magnitude that it is to reach [N m].

    Returns
    -------
    Recording
        The same order, clock and positions; rates of torque change with the torque.

    Raises
    ------
    InputError
        The torque is no number above zero, or the programme has no load to scale.

    Examples
    --------
    >>> scaled_programme(Recording.from_arrays([0.0, 6.0, -12.0]), 4.0).torque_nm
    array([ 0.,  2., -4.])
    """
    if not (np.isfinite(largest_nm) and largest_nm > 0):
        raise InputError(f"largest load: found {largest_nm:g} N m, expected a number above zero")
    largest = float(np.abs(programme.torque_nm).max(initial=0.0))
    if largest == 0:
        raise InputError("largest load: the programme has no load that could be scaled")
    return replace(programme, torque_nm=programme.torque_nm * (largest_nm / largest))


def beyond_rating(programme: Recording, drive: Drive) -> str | None:
    """Say that a programme loads a drive beyond its rating.

    Parameters
    ----------
    programme : Recording
        The programme.
    drive : Drive
        The drive.

    Returns
    -------
    str or None
        None where it does not.
    """
    rated = drive.nominal_torque_nm if programme.side == "input" else drive.output_torque_nm
    largest = float(np.abs(programme.torque_nm).max(initial=0.0))
    if largest <= rated * (1 + 1e-9):
        return None
    return (
        f"the programme reaches {largest:.4g} N m at the {programme.side} shaft, "
        f"{largest / rated:.3g} times the {rated:.4g} N m that {drive.name} is rated for; "
        f"--largest-load-nm {rated:.4g} scales it"
    )


def beyond_fit(programme: Recording, fitted_torque_nm: tuple[float, float] | None) -> str | None:
    """Say that a programme loads a repaired model beyond the recording that it was fitted to.

    Parameters
    ----------
    programme : Recording
        The programme, at the model's shaft.
    fitted_torque_nm : tuple of float and float, or None
        Least and greatest torque of that recording [N m]; None where there was none.

    Returns
    -------
    str or None
        None where it does not.
    """
    if fitted_torque_nm is None or not len(programme):
        return None
    least, greatest = fitted_torque_nm
    margin = SAME_LOAD * max(abs(least), abs(greatest))
    lowest, highest = float(programme.torque_nm.min()), float(programme.torque_nm.max())
    if lowest >= min(least, 0.0) - margin and highest <= max(greatest, 0.0) + margin:
        return None
    return (
        f"the programme goes from {lowest:.4g} to {highest:.4g} N m, the model was fitted to a "
        f"recording from {least:.4g} to {greatest:.4g} N m: the twist beyond it is extrapolated"
    )


def sheet_of(programme: Recording, lever_arm_m: float | None = None) -> pl.DataFrame:
    """Lay a programme out as a sheet in which readings are filled in by hand.

    Parameters
    ----------
    programme : Recording
        The programme.
    lever_arm_m : float, optional
        Arm on which weights are hung [m]; the sheet then has weights in kg instead of torques.

    Returns
    -------
    polars.DataFrame
        ``No.``, what the programme says of run, position, clock and temperature, the load, and
        ``Angle (deg)``, empty. Negative loads are hung on the other side.

    Raises
    ------
    InputError
        For a lever arm that is no number above zero.
    """
    if lever_arm_m is not None and not (np.isfinite(lever_arm_m) and lever_arm_m > 0):
        raise InputError(f"lever arm: found {lever_arm_m:g} m, expected a number above zero")
    if lever_arm_m is None:
        load = pl.Series("Torque (N m)", programme.torque_nm).round(6)
    else:
        weights = programme.torque_nm / (KILOPOND_N * lever_arm_m)
        load = pl.Series("Weight (kg)", np.round(weights, WEIGHT_DIGITS) + 0.0)
    columns = [pl.Series("No.", np.arange(1, len(programme) + 1)), pl.Series("run", programme.run)]
    for name in ("crank_deg", "time_s", "temperature_c"):
        values = getattr(programme, name)
        if values is not None:
            columns.append(pl.Series(name, values))
    empty = pl.Series("Angle (deg)", [None] * len(programme), dtype=pl.Float64)
    return pl.DataFrame([*columns, load, empty])
