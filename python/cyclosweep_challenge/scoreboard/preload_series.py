"""Whether the answers to a dose series are in its order: the printed drive's preload in steps."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from cyclosweep_challenge.scoreboard.line import Summary
from cyclosweep_challenge.scoreboard.outcome import Outcome

PRELOADS = {
    1: ("14-07-48", "14-26-23", "14-31-48"),
    2: ("14-52-50", "14-57-29", "15-12-22"),
    3: ("16-23-23", "16-34-37", "16-28-44"),
    4: ("16-46-43", "16-57-04", "16-51-38"),
}
"""Clock in the names of the preload series, by step; positions 1, 5 and 6 in this order."""
POSITIONS = (1, 5, 6)
SAME_PLAY_DEG = 0.02
"""Play by which a step may exceed the one before; the makers' last two are equal [deg]."""
SOURCE = "Volbeda, MSc thesis 2024 (makers' reading by straight lines)"


def preload_summaries(group: str) -> list[Summary]:
    """Check the order of what is read of the loops, and of what is fitted to them."""
    series = tuple(f"conic_{s}pre{p}" for s in PRELOADS for p in POSITIONS)
    return [
        Summary(
            "preload-order",
            group,
            "With the preload, step 1 to 4, friction rises and play falls in order, both read as "
            "the makers do: play from the small ramps.",
            SOURCE,
            series,
            _dose,
        ),
        Summary(
            "preload-order-fitted",
            group,
            "The same of friction without load and free play in the fitted models, which trade "
            "play for the soft start of the contacts.",
            SOURCE,
            series,
            _fitted_dose,
        ),
    ]


def friction_nm(outcome: Outcome) -> float:
    """Friction torque without load that a diagnosis found, as the makers state it [N m]."""
    return outcome.parameters.get("friction_hysteresis.friction_torque_nm", 0.0)


def _dose(outcomes: Mapping[str, Outcome]) -> tuple[bool, str]:
    """Judge whether friction rises and play falls with the preload, as read of the loops."""
    read = [
        _means(outcomes, step, lambda o: o.figures.get("loop_friction_nm", np.nan))
        for step in PRELOADS
    ]
    lost = [
        _means(outcomes, step, lambda o: o.figures.get("lost_motion_deg", np.nan))
        for step in PRELOADS
    ]
    return _in_order(read, lost, "half the width of the loops", "lost motion at 4 N m")


def _fitted_dose(outcomes: Mapping[str, Outcome]) -> tuple[bool, str]:
    """Judge the same of the fitted models."""
    friction = [_means(outcomes, step, friction_nm) for step in PRELOADS]
    play = [_means(outcomes, step, lambda o: 2.0 * (o.play_deg or 0.0)) for step in PRELOADS]
    return _in_order(friction, play, "friction without load", "play")


def _means(outcomes: Mapping[str, Outcome], step: int, value: Callable[[Outcome], float]) -> float:
    """Mean of a value over the positions of one preload step."""
    return float(np.mean([value(outcomes[f"conic_{step}pre{p}"]) for p in POSITIONS]))


def _in_order(
    friction: Sequence[float], play: Sequence[float], of: str, called: str
) -> tuple[bool, str]:
    """Whether friction rises and play falls from step to step, with the figures in words.

    Parameters
    ----------
    friction : sequence of float
        At each step [N m].
    play : sequence of float
        At each step [deg].
    of, called : str
        What stands for friction and for play.
    """
    rises = sorted(friction) == list(friction) and friction[0] > 0.0
    falls = all(after <= before + SAME_PLAY_DEG for before, after in itertools.pairwise(play))
    words = ", ".join(f"{f:.2f}" for f in friction), ", ".join(f"{p:.2f}" for p in play)
    return rises and falls, f"{of} {words[0]} N m; {called} {words[1]} deg"
