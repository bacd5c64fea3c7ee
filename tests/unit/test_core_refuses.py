"""What is not a number is refused by the compiled core with a plain message; nothing panics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import cyclosweep._core as _core

ZERO = np.zeros(3)
FRESH = np.zeros(3, dtype=bool)
BAD = np.array([0.0, 1.0, math.nan])
SLIP, SHARE = np.array([0.1]), np.array([1.0])


def test_slip_state_refuses_nan() -> None:
    ones = np.ones(3)
    with pytest.raises(ValueError, match="angle is not a number at place 2"):
        _core.slip_state(BAD, FRESH, ZERO, ones, SLIP, SHARE)
    with pytest.raises(ValueError, match="stretch is not a number at place 2"):
        _core.slip_state(ZERO, FRESH, ZERO, BAD, SLIP, SHARE)
    with pytest.raises(ValueError, match="slip_angle must not be negative, found -1"):
        _core.slip_state(ZERO, FRESH, ZERO, ones, -np.ones(1), SHARE)
    with pytest.raises(ValueError, match="arrays differ in length: 3 and 2"):
        _core.slip_state(ZERO, FRESH, ZERO, ones[:2], SLIP, SHARE)


@pytest.mark.parametrize("infinite", [math.inf, -math.inf])
def test_slip_state_refuses_what_would_give_nan(infinite: float) -> None:
    ones, none = np.ones(3), np.zeros(1)
    with pytest.raises(ValueError, match="angle is infinite at place 0"):
        _core.slip_state(np.array([infinite, 0.0, 1.0]), FRESH, ZERO, ones, SLIP, SHARE)
    with pytest.raises(ValueError, match="share is infinite at place 0"):
        _core.slip_state(ZERO, FRESH, ZERO, ones, SLIP, infinite * SHARE)
    with pytest.raises(ValueError, match="slip_angle must be above zero at place 0"):
        _core.slip_state(np.arange(3.0), FRESH, ZERO, ones, none, SHARE)
    with pytest.raises(ValueError, match="stretch must be above zero at place 0"):
        _core.slip_state(np.arange(3.0), FRESH, ZERO, ZERO, SLIP, SHARE)


@pytest.mark.parametrize("name", ["torque", "offset", "share"])
def test_solve_slip_refuses_infinite_loads(name: str) -> None:
    arrays = {"torque": ZERO, "offset": ZERO, "restart": FRESH, "start_angle": ZERO}
    arrays |= {"slip_angle": SLIP, "share": SHARE}
    arrays[name] = np.full(len(arrays[name]), math.inf)
    with pytest.raises(ValueError, match=f"{name} is infinite at place 0"):
        _core.solve_slip(*arrays.values(), free_play=1.0, compliance=2.0, limit=0.1)


@pytest.mark.parametrize("share", [-0.1, 1.1, math.nan])
def test_slip_state_refuses_a_share_that_is_none(share: float) -> None:
    with pytest.raises(ValueError, match="forgetting"):
        _core.slip_state(ZERO, FRESH, ZERO, np.ones(3), SLIP, SHARE, forgetting=share)


def test_slip_state_of_nothing_is_nothing() -> None:
    none = np.zeros(0)
    assert len(_core.slip_state(none, np.zeros(0, dtype=bool), none, none, SLIP, SHARE)) == 0
    of_no_elements = _core.slip_state(ZERO, FRESH, ZERO, np.ones(3), none, none)
    np.testing.assert_array_equal(of_no_elements, ZERO)


def test_play_refuses_nan_and_a_negative_width() -> None:
    with pytest.raises(ValueError, match="signal is not a number at place 2"):
        _core.play(BAD, 1.0, FRESH, ZERO)
    with pytest.raises(ValueError, match="half_width must not be negative"):
        _core.play(ZERO, -1.0, FRESH, ZERO)


@pytest.mark.parametrize("name", ["torque", "offset", "share", "limit", "free_play"])
def test_solve_slip_refuses_nan(name: str) -> None:
    arrays = {"torque": ZERO, "offset": ZERO, "restart": FRESH, "start_angle": ZERO}
    arrays |= {"slip_angle": SLIP, "share": SHARE}
    numbers: dict[str, Any] = {"free_play": 1.0, "compliance": 2.0, "limit": 0.1}
    if name in numbers:
        numbers[name] = math.nan
    else:
        arrays[name] = np.full(len(arrays[name]), math.nan)
    with pytest.raises(ValueError, match=f"{name} is not a number"):
        _core.solve_slip(*arrays.values(), **numbers)
