"""Processor time of one design and of a thousand, as an optimiser asks for them."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

import cyclosweep as cs

ROUNDS = 7
"""Rounds of which the fastest counts: the others were interrupted."""


def microseconds(call: Callable[[], object], calls: int) -> float:
    """Processor time of one call, the fastest of some rounds [us]."""
    call()
    fastest = np.inf
    for _ in range(ROUNDS):
        start = time.process_time()
        for _ in range(calls):
            call()
        fastest = min(fastest, (time.process_time() - start) / calls)
    return float(fastest) * 1e6


def main() -> None:
    """Print a line for each way to evaluate."""
    drive = cs.Drive.reference_87().replace(ring_pin_radius_mm=2.0, disc_width_mm=12.0)
    inputs = ["eccentricity_mm", "output_pin_diameter_mm"]
    published = cs.Evaluator(drive, inputs, ["output_stiffness_nm_per_arcmin", "hole_web_mm"])
    parts = cs.Evaluator(drive, inputs, ["hole_web_mm", "ring_contact_pressure_max_mpa"])
    one = [0.62, 16.0]
    draws = np.random.default_rng(1)
    many = np.column_stack([draws.uniform(0.5, 0.7, 1000), draws.uniform(14.0, 18.0, 1000)])
    print(f"Evaluator, one design             {microseconds(lambda: published(one), 500):8.1f} us")
    print(f"Evaluator, 1000 designs           {microseconds(lambda: published(many), 100):8.1f} us")
    print(f"Evaluator, components, one design {microseconds(lambda: parts(one), 200):8.1f} us")
    print(f"drive.evaluate()                  {microseconds(drive.evaluate, 200):8.1f} us")
    print(
        "drive.replace(...).evaluate()     "
        f"{microseconds(lambda: drive.replace(eccentricity_mm=0.61).evaluate(), 200):8.1f} us"
    )


if __name__ == "__main__":
    main()
