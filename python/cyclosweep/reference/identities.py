"""Limits and identities that the formulas of the shaft and of the assembly must keep."""

from __future__ import annotations

import math
from collections.abc import Iterator

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive
from cyclosweep.reference.facts import Fact, Mark

__all__ = ["facts"]

GROUP = "limits and identities"
_SHEAR_MODULUS = 206e9 / 2.6
_D, _L = 0.05, 0.06
# Extra length of a shoulder over the small diameter: D/d, by finite differences of the
# axisymmetric problem.
_SHOULDER = ((1.25, 0.045), (1.5, 0.085), (2.0, 0.125), (3.0, 0.149))


def _cylinder(length: float, diameter: float) -> float:
    return 32 * length / (math.pi * _SHEAR_MODULUS * diameter**4)


def facts(drive: Drive) -> Iterator[Fact]:
    """Check the formulas against their limits.

    Parameters
    ----------
    drive : Drive
        Drive for the assembly's identities.

    Yields
    ------
    Fact
        Compliances relative to the limit, so that each should read 1.
    """

    def unity(fact: str, value: float, tolerance: float, mark: Mark = "identity") -> Fact:
        return Fact(GROUP, fact, 1.0, value, "1", mark, tolerance)

    from scipy.integrate import quad

    keyway = _core.keyway_compliance(_L, _D, 0.0, 10.0, _SHEAR_MODULUS)
    yield unity("Eq. (5) without depth / cylinder", keyway / _cylinder(_L, _D), 1e-12)
    step = _core.step_compliance(_L, _D * (1 - 1e-12), _L, _D, _SHEAR_MODULUS)
    yield unity("Eq. (6) as d -> D / cylinder", step / _cylinder(2 * _L, _D), 1e-9)
    frustum = _core.frustum_compliance(_L, _D, 0.08, _SHEAR_MODULUS)
    integral, _ = quad(lambda x: (_D + (0.08 - _D) * x / _L) ** -4.0, 0, _L)
    whole = 32 / (math.pi * _SHEAR_MODULUS) * integral
    yield unity("Eq. (7) / its integral", frustum / whole, 1e-9)
    even = _core.frustum_compliance(_L, _D, _D, _SHEAR_MODULUS)
    yield unity("Eq. (7) as D -> d / cylinder", even / _cylinder(_L, _D), 1e-12)

    results = {
        name: math.nan if value is None else value
        for name, value in drive.evaluate((1.0, 2.0)).items()
    }
    output = results["output_compliance_rad_per_nm"]
    if drive.output_stiffness_nm_per_arcmin is None:  # a given stiffness replaces Eq. (11)
        parallel = results["shaft_compliance_rad_per_nm"] + (
            results["pin_compliance_rad_per_nm"] / drive.output_pin_count
        )
        yield unity("Eq. (11): C_OS / (C_OS^t + C_OP / N_OP)", output / parallel, 1e-12)
    reflected = results["reflected_compliance_rad_per_nm"]
    yield unity("Eq. (12): C*_OS / (C_OS i^2)", reflected / (output * drive.ratio**2), 1e-12)
    once = results["twist_1tn_deg"] - drive.free_play_deg
    twice = results["twist_2tn_deg"] - drive.free_play_deg
    yield unity("Eq. (13): linear in the load", twice / (2 * once), 1e-12)

    yield from _against_better_models()


def _against_better_models() -> Iterator[Fact]:
    """Rows that compare the printed formulas with numerical solutions; nothing is decided."""
    note = "finite differences of the axisymmetric problem; the formula is the paper's"
    for ratio, extra in _SHOULDER:
        plain = _cylinder(_L, _D) + _cylinder(_L, ratio * _D)
        shoulder = _core.step_compliance(_L, _D, _L, ratio * _D, _SHEAR_MODULUS) - plain
        length = shoulder * math.pi * _SHEAR_MODULUS * _D**4 / 32
        yield Fact(
            GROUP,
            f"Eq. (6): extra length of a shoulder / d at D/d = {ratio:g}",
            extra,
            length / _D,
            "1",
            "reading",
            None,
            note,
        )
    depth = 5.5e-3
    printed, thin = (
        _core.keyway_compliance(_L, _D, depth, k, _SHEAR_MODULUS) / _cylinder(_L, _D)
        for k in (10.0, 1.25)
    )
    yield Fact(
        GROUP,
        "Eq. (5): keyway of 5.5 mm in 50 mm / cylinder",
        round(thin, 4),
        printed,
        "1",
        "reading",
        None,
        "first by k = 1.25, a Saint-Venant torsion solution; second by k = 10 as printed",
    )
