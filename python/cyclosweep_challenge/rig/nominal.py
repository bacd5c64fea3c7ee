"""The reference drive as its makers state it; every specimen departs from these figures."""

from __future__ import annotations

RATIO = 87
OUTPUT_PINS = 8
DISCS = 2
RATED_INPUT_TORQUE_NM = 7.2575
FREE_PLAY_DEG = 28.0
COMPLIANCE_DEG_PER_NM = 19.8 / RATED_INPUT_TORQUE_NM
SMALLEST_TORQUE_NM = 0.06 * RATED_INPUT_TORQUE_NM
"""Below this the hanging weights do not settle the shaft and nothing is read [N m]."""
