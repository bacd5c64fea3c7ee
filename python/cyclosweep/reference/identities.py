"""Limits and identities that the formulas of shaft, pins and assembly keep: checks of the code.

Every number comes from the evaluation of a drive, as a user's does, and is set against what the
formula says by hand, so that most rows should read 1.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial

from cyclosweep.design.drive import Cylinder, Drive, Frustum, Keyway
from cyclosweep.reference.facts import Fact, Mark
from cyclosweep.reference.model import Model

__all__ = ["cylinder_compliance", "facts", "with_shaft"]

GROUP = "limits and identities"
_DIAMETER, _LENGTH, _END = 50.0, 60.0, 70.0
"""Shaft on which the formulas are tried [mm]."""


def with_shaft(drive: Drive, *segments: Keyway | Cylinder | Frustum) -> Drive:
    """Return the drive with another shaft, its segments from the free end to the flange."""
    return drive.replace(shaft=list(segments))


def cylinder_compliance(drive: Drive, diameter_mm: float, length_mm: float) -> float:
    """Compliance l / (G J) of a round bar of the drive's material, by hand [rad/(N m)].

    Parameters
    ----------
    drive : Drive
        Drive whose Young's modulus and Poisson's ratio count.
    diameter_mm, length_mm : float
        Dimensions [mm].
    """
    shear_modulus = drive.youngs_modulus_gpa * 1e9 / (2 * (1 + drive.poisson_ratio))
    return 32 * length_mm * 1e-3 / (math.pi * shear_modulus * (diameter_mm * 1e-3) ** 4)


def _row(
    fact: str,
    value: float,
    tolerance: float,
    expected: float = 1.0,
    unit: str = "1",
    mark: Mark = "identity",
    note: str = "",
) -> Fact:
    return Fact(GROUP, fact, expected, value, unit, mark, "identity", tolerance, note)


def facts(model: Model) -> Iterator[Fact]:
    """Check the formulas against their limits.

    Parameters
    ----------
    model : Model
        The package, or the package with one error put in.

    Yields
    ------
    Fact
        Counted rows of kind ``identity``.
    """
    drive = Drive.reference_87()
    yield from _shaft(model, drive)
    yield from _pin(model, drive)
    yield from _assembly(model, drive)
    yield from _geometry(model, drive)


def _shaft(model: Model, drive: Drive) -> Iterator[Fact]:
    from scipy.integrate import quad

    def compliance(*segments: Keyway | Cylinder | Frustum) -> float:
        return model.shaft_compliance(with_shaft(drive, *segments))

    def cylinder(length: float, diameter: float = _DIAMETER) -> Cylinder:
        return Cylinder(diameter_mm=diameter, length_mm=length)

    by_hand: Callable[[float], float] = partial(cylinder_compliance, drive, _DIAMETER)
    keyway = partial(Keyway, diameter_mm=_DIAMETER, length_mm=_LENGTH)
    smooth = compliance(keyway(keyway_depth_mm=0.0))
    yield _row("Eq. (5) without depth / cylinder", smooth / by_hand(_LENGTH), 1e-12)
    depth = 0.11 * _DIAMETER
    extra = compliance(keyway(keyway_depth_mm=depth)) / by_hand(_LENGTH) - 1
    yield _row(
        "Eq. (5): coefficient k read back from a keyway",
        extra * _DIAMETER / depth,
        1e-10,
        10.0,
        mark="reading",
        note="10 is the printed coefficient, about 75 % sure",
    )
    almost = compliance(cylinder(_LENGTH, _DIAMETER * (1 - 1e-12)), cylinder(_LENGTH))
    yield _row("Eq. (6) as d -> D / cylinder", almost / by_hand(2 * _LENGTH), 1e-9)
    split = compliance(cylinder(0.4 * _LENGTH), cylinder(0.6 * _LENGTH))
    yield _row("Eq. (6): a segment cut in two / whole", split / by_hand(_LENGTH), 1e-12)
    frustum = partial(Frustum, diameter_mm=_DIAMETER, length_mm=_LENGTH)
    integral, _ = quad(lambda x: (1 + (_END / _DIAMETER - 1) * x) ** -4.0, 0, 1)
    cone = compliance(frustum(end_diameter_mm=_END))
    yield _row("Eq. (7) / its integral", cone / (integral * by_hand(_LENGTH)), 1e-9)
    even = compliance(frustum(end_diameter_mm=_DIAMETER))
    yield _row("Eq. (7) as D -> d / cylinder", even / by_hand(_LENGTH), 1e-12)
    whole, parts = model.shaft_compliance(drive), _in_series(compliance, drive.shaft)
    yield _row(
        "Eq. (4): whole shaft / its segments and shoulders one by one",
        whole / parts,
        1e-9,
        note="a shoulder is what a pair of segments has beyond the two alone",
    )


def _in_series(
    compliance: Callable[..., float], segments: Sequence[Keyway | Cylinder | Frustum]
) -> float:
    alone = [compliance(segment) for segment in segments]
    pairs = itertools.pairwise(segments)
    shoulders = [
        compliance(before, after) - alone[k] - alone[k + 1]
        for k, (before, after) in enumerate(pairs)
    ]
    return math.fsum(alone) + math.fsum(shoulders)


def _pin(model: Model, drive: Drive) -> Iterator[Fact]:
    diameter, radius = (
        drive.output_pin_diameter_mm * 1e-3,
        drive.output_pin_circle_radius_mm * 1e-3,
    )
    modulus = drive.youngs_modulus_gpa * 1e9

    def deflection(length_mm: float) -> float:
        """Deflection of a pin per unit force [m/N]."""
        changed = drive.replace(output_pin_length_mm=length_mm)
        return model.evaluate(changed)["pin_compliance_rad_per_nm"] * radius**2

    slender_mm = 100 * drive.output_pin_diameter_mm
    bending = 64 * (slender_mm * 1e-3) ** 3 / (3 * math.pi * modulus * diameter**4)
    yield _row(
        "Eqs. (8)-(10): C_OP R^2 of a slender pin / L^3 / (3 E I)",
        deflection(slender_mm) / bending,
        1e-4,
        note="a pin 100 times as long as thick: shear is 0.006 % of its deflection",
    )
    # The deflection is a L^3 + b L with b = 1 / (kappa G A).
    length = drive.output_pin_length_mm
    shear = (8 * deflection(length) - deflection(2 * length)) / 6
    shear_modulus = modulus / (2 * (1 + drive.poisson_ratio))
    area = math.pi / 4 * diameter**2
    kappa = length * 1e-3 / (shear_modulus * area * shear) if shear > 1e-15 else math.inf
    yield _row(
        "Eqs. (8)-(10): shear coefficient read back from the pin",
        kappa,
        5e-4,
        0.886,
        mark="published",
        note="Cowper 1966 for a round section at nu = 0.3, whose formula the package uses",
    )
    lightly = model.evaluate(drive.replace(output_torque_nm=drive.output_torque_nm / 100))
    column = "pin_compliance_rad_per_nm"
    yield _row(
        "Eqs. (8)-(10): C_OP / C_OP of a drive rated at a hundredth",
        model.evaluate(drive)[column] / lightly[column],
        1e-12,
        note="T_O* is the torque of one pin and the pin is linear: the rating cancels out",
    )
    results = model.evaluate(drive)
    eta = results["torque_transfer_efficiency"]
    alone = results["torque_per_pin_nm"] * eta * drive.output_pin_count
    yield _row("Eqs. (1), (2): T_O* eta_OP N_OP / T_O", alone / drive.output_torque_nm, 1e-12)
    force = results["force_per_pin_n"] * radius / results["torque_per_pin_nm"]
    yield _row("Eq. (9): F_n R_OP / T_O*", force, 1e-12)
    stress = (
        32e-6 * results["pin_force_max_n"] * drive.output_pin_length_mm * 1e-3
        / (math.pi * diameter**3)
    )  # fmt: skip
    column = "pin_bending_stress_mpa"
    torque, one_disc = drive.output_torque_nm, drive.replace(disc_count=1, output_pin_count=5)
    worst = torque / (radius * (1 + 2 * math.sin(math.radians(18)) ** 2))
    yield _row(
        "statics: force on one of five pins of one disc / T_O / (R_OP (1 + 2 sin^2 18))",
        model.evaluate(one_disc)["pin_force_max_n"] / worst,
        1e-12,
        note="10,915 N at 585 N m on 45 mm: one pin stands at 90 deg, two more carry at 18 deg",
    )
    yield _row("root stress of the pin / 32 F L / (pi d^3)", results[column] / stress, 1e-12)


def _assembly(model: Model, drive: Drive) -> Iterator[Fact]:
    results = model.evaluate(drive, (1.0, 2.0))
    shaft, pin = results["shaft_compliance_rad_per_nm"], results["pin_compliance_rad_per_nm"]
    output = results["output_compliance_rad_per_nm"]
    pins = drive.output_pin_count
    yield _row("Eq. (11): C_OS / (C_OS^t + C_OP / N_OP)", output / (shaft + pin / pins), 1e-12)
    share = results["pin_participation_statics"]
    yield _row("statics: share of two discs of eight pins", share, 1e-12, 0.5)
    by_statics = results["output_compliance_statics_rad_per_nm"]
    yield _row(
        "statics: C_OS / (C_OS^t + 2 C_OP / N_OP)", by_statics / (shaft + 2 * pin / pins), 1e-12
    )
    reflected = results["reflected_compliance_rad_per_nm"]
    yield _row("Eq. (12): C*_OS / (C_OS i^2)", reflected / (output * drive.ratio**2), 1e-12)
    stiffness = results["reflected_stiffness_nm_per_rad"]
    yield _row("K*_OS C*_OS", stiffness * reflected, 1e-12)
    per_arcmin = results["output_stiffness_nm_per_arcmin"]
    yield _row(
        "stiffness in N m/arcmin * C_OS * 10800 / pi", per_arcmin * output * 10800 / math.pi, 1e-12
    )
    once = results["twist_1tn_deg"] - drive.free_play_deg
    twice = results["twist_2tn_deg"] - drive.free_play_deg
    eta = results["torque_transfer_efficiency"]
    by_hand = math.degrees(eta * reflected * drive.nominal_torque_nm)
    yield _row("Eq. (13): (theta' - gamma) / (eta C*_OS T_N)", once / by_hand, 1e-6)
    yield _row("Eq. (13): linear in the load", twice / (2 * once), 1e-6)
    frequency, inertia = results["natural_frequency_hz"], drive.input_inertia_kg_m2
    assert inertia is not None
    squared = (math.tau * frequency) ** 2 * inertia
    yield _row("natural frequency: (2 pi f)^2 J / K*_OS", squared / stiffness, 1e-12)
    with_efficiency = results["natural_frequency_with_efficiency_hz"]
    yield _row(
        "natural frequency with efficiency: eta (f_eta / f)^2",
        eta * (with_efficiency / frequency) ** 2,
        1e-12,
    )
    chosen = model.evaluate(drive.replace(criterion="statics"))
    twist = chosen["twist_1tn_deg"] - drive.free_play_deg
    compliance = chosen["output_compliance_statics_rad_per_nm"] * drive.ratio**2
    yield _row(
        "statics: (theta' - gamma) / (C_OS by statics i^2 T_N)",
        twist / math.degrees(compliance * drive.nominal_torque_nm),
        1e-6,
    )
    efficiency = model.change_drive(drive).overall_efficiency
    yield _row(
        "overall efficiency",
        efficiency,
        5e-5,
        0.9265,
        mark="derived",
        note="585 / (87 * 7.2575), from published numbers alone",
    )


def _geometry(model: Model, drive: Drive) -> Iterator[Fact]:
    hole = drive.output_pin_diameter_mm + 2 * drive.bush_wall_mm + 2 * drive.eccentricity_mm
    found = model.evaluate(drive)["hole_diameter_mm"]
    yield _row("hole / (pin + 2 bush walls + 2 e)", found / hole, 1e-12)
