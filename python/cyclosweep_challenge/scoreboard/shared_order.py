"""Order of the steps of one measured file beside that of all other files of the same rig."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from cyclosweep.diagnosis.series_steps import legs_as_data, steps_in_common
from cyclosweep.errors import InputError
from cyclosweep.recording import Recording
from cyclosweep.result.series import StepsInCommon

Files = tuple[tuple[str, Callable[[Path], Recording]], ...]
"""What reads each file, by the name of its line."""
RATIO = 13.0
"""Reduction of the printed drive."""


def order_of_others(
    recordings: Path, files: Mapping[str, Callable[[Path], Recording]], name: str
) -> Mapping[str, float]:
    """Order that the steps of all other files share, and the clearest order of this one.

    Parameters
    ----------
    recordings : pathlib.Path
        Shared folder of recordings.
    files : mapping of str to callable
        What reads each file, by the name of its line.
    name : str
        Name of the line that is left out.

    Returns
    -------
    mapping
        ``others_order`` with ``others_chance``, the share of random staircases with as clear an
        order, and ``own_order``, which has ``own_apart`` as its resolution; empty where there are
        too few files.
    """
    steps = _steps_of_all(recordings, tuple(files.items()))
    common = steps_in_common({each: one for each, one in steps.items() if each != name})
    together = _together(recordings, tuple(files.items()))
    if common is None or together is None:
        return {}
    own = together.own.get(name)
    return {
        "others_order": common.order,
        "others_chance": common.chance,
        "own_order": math.nan if own is None else own.order,
        "own_apart": together.apart,
    }


@cache
def _steps_of_all(recordings: Path, files: Files) -> dict[str, dict[str, Any]]:
    """Torque along the legs of the files that are there."""
    found = {}
    for name, read in files:
        with suppress(InputError):
            steps = legs_as_data(read(recordings), RATIO)
            if steps is not None:
                found[name] = steps
    return found


@cache
def _together(recordings: Path, files: Files) -> StepsInCommon | None:
    """Order that the steps of all files share."""
    return steps_in_common(_steps_of_all(recordings, files))
