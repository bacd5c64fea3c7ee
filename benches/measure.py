"""Timing on a shared machine: every candidate in turn, several rounds, medians and ratios."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["Timing", "alternate"]


@dataclass(frozen=True)
class Timing:
    """Runs of one candidate.

    Attributes
    ----------
    variants : int
        Variants a run.
    wall_s, cpu_s : list of float
        Wall-clock and processor seconds of each run.
    """

    variants: int
    wall_s: list[float]
    cpu_s: list[float]

    @property
    def rate(self) -> float:
        """Variants a second of wall clock, from the median run."""
        return self.variants / statistics.median(self.wall_s)

    @property
    def best(self) -> float:
        """Variants a second of wall clock, from the fastest run: the least disturbed one."""
        return self.variants / min(self.wall_s)

    @property
    def rate_of_a_core(self) -> float:
        """Variants a second of processor time, from the least disturbed run."""
        return self.variants / min(self.cpu_s)


def alternate(
    candidates: dict[str, tuple[int, Callable[[], object]]], rounds: int
) -> dict[str, Timing]:
    """Run every candidate once to warm up, then all of them in turn ``rounds`` times.

    Parameters
    ----------
    candidates : dict
        Name to (variants a run, what to run).
    rounds : int
        How often.

    Returns
    -------
    dict
        Name to timing.
    """
    timings = {name: Timing(variants, [], []) for name, (variants, _) in candidates.items()}
    for _, run in candidates.values():
        run()
    for _ in range(rounds):
        for name, (_, run) in candidates.items():
            wall, cpu = time.perf_counter(), time.process_time()
            result = run()
            timings[name].wall_s.append(time.perf_counter() - wall)
            timings[name].cpu_s.append(time.process_time() - cpu)
            del result
    return timings
