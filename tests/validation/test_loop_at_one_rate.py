"""Friction in loops at one rate: what follows the clock could make such loops, too."""

import numpy as np
from scipy.optimize import brentq

import cyclosweep as cs

TOP_NM, COMPLIANCE, PLAY_DEG = 11.0, 3.8, 0.9
LIMIT_NM, SLIP_DEG = 0.5, 3.5


def _opening_loop(applied_nm: float, before: tuple[float, float]) -> tuple[float, float]:
    """Elastic torque [N m] and state of Bouc and Wen's friction whose limit grows, then levels off.

    The limit is no power of the load: ``|T| / (|T| + T_max / 2)``.
    """
    at_deg, state = before

    def bouc_wen(elastic_nm: float) -> float:
        way, now = COMPLIANCE * elastic_nm - at_deg, state
        for _ in range(20):
            now += way / 20 / SLIP_DEG * (1 - abs(now) ** 1.5 * (0.5 + 0.5 * np.sign(way * now)))
        return now

    def excess(elastic_nm: float) -> float:
        load = abs(elastic_nm)
        limit = LIMIT_NM * load / (load + 0.5 * TOP_NM)
        return elastic_nm + limit * bouc_wen(elastic_nm) - applied_nm

    elastic = brentq(excess, applied_nm - 2 * LIMIT_NM, applied_nm + 2 * LIMIT_NM)
    return elastic, bouc_wen(elastic)


def test_a_loop_that_opens_with_the_load_is_no_creep_where_the_rate_is_one() -> None:
    torque = TOP_NM * np.sin(2 * np.pi * np.linspace(0.0, 1.0, 1_800))
    elastic, held = np.empty_like(torque), (0.0, 0.0)
    for row, applied in enumerate(torque):
        elastic[row], state = _opening_loop(applied, held)
        held = (COMPLIANCE * elastic[row], state)
    noise = 0.06 * np.random.default_rng(7).normal(size=len(torque))
    recording = cs.Recording.from_arrays(
        torque,
        PLAY_DEG * np.sign(elastic) + COMPLIANCE * elastic + noise,
        time_s=np.linspace(0.0, 528.0, len(torque)),
        drive="reference-87",
        side="input",
    )
    found = cs.diagnose(recording, full=False)
    assert [effect["name"] for effect in found.effects] == ["load_dependent_friction"]
    assert found.verdict in ("IDENTIFIED", "MOSTLY_EXPLAINED")
