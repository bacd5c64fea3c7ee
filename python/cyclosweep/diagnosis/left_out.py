"""Readings under load that the settings leave out of the fit, by the key that does so."""

import numpy as np

from cyclosweep.recording import Recording


def left_out_by_settings(recording: Recording) -> dict[str, int]:
    """Count the readings under load that are not fitted because the settings say so.

    Parameters
    ----------
    recording : Recording
        What was measured.

    Returns
    -------
    dict of str to int
        By the key of the settings, or the attribute of a recording of arrays; a reading may be
        left out by two of them. Keys that leave none out are absent.
    """
    loaded = recording.torque_nm != 0.0
    counts: dict[str, int] = {}
    saturated = any(fault.kind == "saturation" for fault in recording.faults)
    if recording.unscored is not None and not saturated:  # which leaves samples unscored, too
        key = "unscored" if recording.path is None else "[score] abs_max"
        counts[key] = int(np.count_nonzero(loaded & recording.unscored))
    for key in ("conditioning_runs", "holdout_runs"):
        rows = loaded & recording.in_runs(getattr(recording, key))
        counts[key] = int(np.count_nonzero(rows))
    return {key: count for key, count in counts.items() if count}


def in_words(left_out: dict[str, int]) -> str:
    """Say how many readings each key leaves out.

    Examples
    --------
    >>> in_words({"[score] abs_max": 360, "holdout_runs": 120})
    '[score] abs_max leaves out 360, holdout_runs 120'
    """
    (first, count), *others = left_out.items()
    return ", ".join([f"{first} leaves out {count}", *(f"{key} {n}" for key, n in others)])
