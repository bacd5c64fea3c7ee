"""Where a diagnosis comes from: versions, recording, drive, seed."""

import numpy as np

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive
from cyclosweep.recording import Recording


def provenance_of(recording: Recording, drive: Drive, seed: int) -> dict[str, str]:
    """Return versions, names, seed and hash that stand at the end of a report.

    Parameters
    ----------
    recording : Recording
        What was diagnosed.
    drive : Drive
        The drive it was taken on.
    seed : int
        Seed of every random draw.

    Returns
    -------
    dict of str to str
    """
    known = {
        "cyclosweep": _core.__version__,
        "numpy": np.__version__,
        "recording": str(recording.path or recording.name),
        "drive": drive.name,
        "seed": str(seed),
    }
    if recording.sha256:
        known["sha256"] = recording.sha256
    return known
