"""A sweep slow enough to be interrupted: FOLDER COUNT ROWS_PER_PART ENGINE."""

from __future__ import annotations

import sys
import time

import cyclosweep as cs
from cyclosweep.sweep.dataset import Dataset

_write = Dataset.write


def _slow(self: Dataset, *rest: object) -> object:
    time.sleep(0.05)
    return _write(self, *rest)  # type: ignore[arg-type]


# Spawned workers import this file, too.
Dataset.write = _slow  # type: ignore[method-assign,assignment]


def main() -> None:
    folder, count, rows, engine = sys.argv[1:]
    space = cs.Space.sobol(cs.Drive.reference_87(), int(count), seed=2, eccentricity_mm=(0.3, 0.8))
    cs.sink(space, folder, rows_per_part=int(rows), engine=engine)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
