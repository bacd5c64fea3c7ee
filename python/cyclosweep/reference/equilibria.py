"""Loaded drives of the component model beside solved cases, limits, identities and other codes."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive
from cyclosweep.design.loaded import LoadedState
from cyclosweep.errors import InputError
from cyclosweep.reference.facts import Fact, Kind, Mark
from cyclosweep.reference.model import Model
from cyclosweep.reference.sources import CYCLOIDGEN, KROL, PROTOTYPE, RATIO_29, SINE_LIMIT, WANG

__all__ = ["facts"]

GROUP = "loaded drives"
_ARCMIN = math.pi / 10_800

_RIGID = {"shaft": (), "output_stiffness_nm_per_arcmin": 1e12, "bush_wall_mm": 0.0}
"""No shaft in series, pins without bushes."""
_SOLVED = {
    "eccentricity_mm": 0.9,
    "ring_pin_circle_radius_mm": 90.0,
    "hole_clocking_deg": 0.0,
    "disc_outer_radius_mm": 86.0,
    "ring_pin_radius_mm": 2.0,
    "disc_width_mm": 12.0,
    "disc_1_reach_mm": 8.0,
    "disc_2_reach_mm": 24.0,
    "eccentric_bearing_stiffness_n_per_mm": 4e5,
    "pin_root_compliance": (1.23, 0.225, 5.11),
}
_GAPS = {"ring_clearance_mm": 0.02, "hole_clearance_mm": 0.05}
_CASES: tuple[tuple[str, dict[str, float], float, float, float | None, float | None], ...] = (
    ("no clearance, 585 N m", {}, 585.0, 2.22227, 4697.802, 336.9843),
    ("no clearance, 292.5 N m", {}, 292.5, 1.15440, None, None),
    ("no clearance, 17.55 N m", {}, 17.55, 0.07903, None, None),
    ("with clearance, 585 N m", _GAPS, 585.0, 8.24617, 5902.888, 467.6715),
    (
        "with clearance and rigid bearings, 585 N m",
        {**_GAPS, "eccentric_bearing_stiffness_n_per_mm": 1e12},
        585.0,
        0.09039018 / 45.0 / _ARCMIN,
        6152.067,
        615.3406,
    ),
)
"""Twist [arcmin], largest output and ring force [N], crank at 0.3 rad."""

_SINE_LIMITS = ((1.0, 3189.54, 0.031895), (10.0, 3243.79, 0.032438))
"""Size of ring and eccentricity over the 87:1 drive's, largest force [N], R phi [mm]."""

_KROL_INNER = {
    "1": (10.0, 5.0, 8.0, 30.0, 303),
    "1LM": (8.2701, 3.5290, 12.4852, 34.784, 509),
    "1SD": (9.1856, 4.8105, 8.3151, 30.0, 341),
    "2": (8.0, 3.0, 5.0, 20.0, 552),
    "2LM": (8.8444, 3.0593, 4.9149, 21.178, 491),
    "2SD": (8.0453, 3.0142, 4.9958, 20.001, 547),
    "3": (10.0, 5.0, 8.0, 30.0, 303),
    "3LM": (8.4674, 3.4925, 11.8874, 34.31, 505),
    "3SD": (9.0349, 4.7901, 8.3506, 30.0, 347),
    "4": (10.0, 5.0, 8.0, 30.0, 303),
    "4LM": (8.3739, 3.5707, 11.9415, 33.681, 505),
    "4SD": (8.8798, 4.7723, 8.3817, 30.0, 352),
}
"""Width, radii of sleeve and hole, pin circle [mm], printed stress [MPa]."""

_WANG = (
    ("optimised", 140.9316, 7.6999, 99.9567, 12.2048, 93067.0, 97303.0),
    ("as built", 141.0, 7.7, 100.0, 12.2, 93229.0, 97472.3),
)
"""Ring circle, ring pin, pin circle, pin [mm], printed volume, ours [mm^3]."""

_CYCLOIDGEN = {
        "ratio": 11, "disc_count": 1, "eccentricity_mm": 1.5, "ring_pin_circle_radius_mm": 50.0,
        "ring_pin_radius_mm": 4.0, "disc_width_mm": 8.0, "output_pin_count": 6,
        "output_pin_diameter_mm": 6.0, "output_pin_circle_radius_mm": 30.0,
        "output_torque_nm": 25.0, "disc_outer_radius_mm": 46.0, "disc_bore_radius_mm": 15.0,
        "youngs_modulus_gpa": 210.0, "hole_clocking_deg": 0.0, "disc_1_reach_mm": 0.01,
        "eccentric_bearing_stiffness_n_per_mm": 1e9,
}  # fmt: skip
_CYCLOIDGEN_FORCES = (161.018, 556.659, 357.344)
"""Forces on the output pins of one disc at 25 N m, crank at 0.3 rad, no clearance."""
_PRINTED = {
    "ratio": 13,
    "disc_count": 1,
    "eccentricity_mm": 1.5,
    "ring_pin_circle_radius_mm": 34.0,
    "ring_pin_radius_mm": 3.5,
    "disc_width_mm": 25.0,
    "hole_clocking_deg": 0.0,
    "output_pin_circle_radius_mm": 20.0,
    "output_pin_diameter_mm": 9.0,
    "output_pin_length_mm": 25.0,
    "disc_outer_radius_mm": 31.95,
    "disc_bore_radius_mm": 11.0,
    "youngs_modulus_gpa": 5.0,
    "poisson_ratio": 0.35,
    "disc_youngs_modulus_gpa": 5.0,
    "disc_poisson_ratio": 0.35,
    "ring_youngs_modulus_gpa": 206.0,
    "output_torque_nm": 25.0,
    "disc_1_reach_mm": 12.5,
}
"""The 13:1 drive of Volbeda's thesis, examples/measured-13-to-1; its moduli are assumed."""
_PRINTED_NM_PER_RAD = 323.5
"""Middle of the measured 310 to 337 N m/rad."""


def facts(model: Model) -> Iterator[Fact]:
    """Compare equilibria of the component model with what others found and what must hold.

    Parameters
    ----------
    model : Model
        The package, or the package with one error put in.

    Yields
    ------
    Fact
        Rows of kind ``independent solution``, ``evidence`` and ``identity``.
    """
    base = Drive.reference_87().replace(**_RIGID)
    yield from _solved(model, base.replace(**_SOLVED))
    yield from _limits(model, base.replace(**_SOLVED))
    yield from _identities(model, base.replace(**_SOLVED, **_GAPS))
    yield from _bearing(model, base)
    yield from _krol_inner(model)
    yield from _wang(model, base)
    yield from _cycloidgen(model, base.replace(**_CYCLOIDGEN))
    yield from _printed(model, base.replace(**_PRINTED))


def _row(
    fact: str, expected: float, computed: float, unit: str, tolerance: float, kind: Kind, note: str,
    mark: Mark = "derived", explanation: str = "", explained: float | None = None,
    source: str = "",
) -> Fact:  # fmt: skip
    return Fact(
        GROUP, fact, expected, computed, unit, mark, kind, tolerance, note, explanation, explained,
        source,
    )  # fmt: skip


def _loaded(model: Model, drive: Drive, torque: float, crank: float) -> LoadedState | None:
    """An equilibrium; None where an error put in makes the drive impossible."""
    try:
        return model.loaded(drive, torque, crank)
    except (InputError, _core.DesignError):
        if not model.broken:
            raise
        return None


def _solved(model: Model, drive: Drive) -> Iterator[Fact]:
    for case, gaps, torque, twist, pin, ring in _CASES:
        state = _loaded(model, drive.replace(**gaps), torque, 0.3)
        found = state.twist_arcmin if state else math.nan
        yield _row(
            f"87:1, {case}: twist", twist, found, "arcmin", 6e-6, "independent solution", "",
            source=PROTOTYPE,
        )  # fmt: skip
        if pin is None or ring is None:
            continue
        forces = [math.nan, math.nan]
        if state:
            forces = [float(state.output_pin_forces_n.max()), float(state.ring_pin_forces_n.max())]
        for what, expected, force in zip(("output", "ring"), (pin, ring), forces, strict=True):
            yield _row(
                f"87:1, {case}: largest {what} force", expected, force, "N", 2e-6 * expected,
                "independent solution", "", source=PROTOTYPE,
            )  # fmt: skip


def _limits(model: Model, drive: Drive) -> Iterator[Fact]:
    """Straight pins of 1e5 N/mm, everything else rigid: the sine rule in the limit."""
    straight = drive.replace(
        disc_width_mm=1e9,
        disc_1_reach_mm=16.0,
        disc_2_reach_mm=16.0,
        eccentric_bearing_stiffness_n_per_mm=1e12,
        pin_root_compliance=(0.0, 0.0, 0.0),
    )
    stiffness = straight.part_study("full").mechanism(straight.study(), 0)["pin_stiffness"][0]
    root = (1e-5 - 1e3 / stiffness) * drive.youngs_modulus_gpa * 1e3 * drive.output_pin_diameter_mm
    crank = math.pi / 2 * drive.ratio / (drive.ratio + 1)
    note = "4 T / (Z R) = 3250 N and 235.62 N m/arcmin in the limit of a large e"
    for size, force, shift in _SINE_LIMITS:
        state = _loaded(
            model,
            straight.replace(
                eccentricity_mm=0.9 * size,
                ring_pin_circle_radius_mm=90.0 * size,
                ring_pin_radius_mm=2.0 * size,
                disc_outer_radius_mm=86.0 * size,
                pin_root_compliance=(root, 0.0, 0.0),
            ),
            585.0,
            crank,
        )
        largest = float(state.output_pin_forces_n.max()) if state else math.nan
        twist = state.twist_arcmin if state else math.nan
        case = f"sine limit, straight pins, e = {0.9 * size:g} mm"
        yield _row(
            f"{case}: largest force", force, largest, "N", 0.006, "independent solution", note,
            source=SINE_LIMIT,
        )  # fmt: skip
        moved = twist * _ARCMIN * drive.output_pin_circle_radius_mm
        yield _row(
            f"{case}: R phi", shift, moved, "mm", 6e-7, "independent solution", note,
            source=SINE_LIMIT,
        )  # fmt: skip
        if size > 1:
            slope = state.tangent_stiffness_nm_per_arcmin if state else math.nan
            yield _row(
                f"{case}: stiffness / 4 k R^2", 1.0, slope / 235.62, "1", 5e-3, "identity", note,
                "identity",
            )  # fmt: skip


def _identities(model: Model, drive: Drive) -> Iterator[Fact]:
    def identity(fact: str, computed: float, note: str) -> Fact:
        return _row(fact, 1.0, computed, "1", 1e-10, "identity", note, "identity")

    def twist(changed: Drive, torque: float, crank: float) -> float:
        state = _loaded(model, changed, torque, crank)
        return state.twist_arcmin if state else math.nan

    one = drive.replace(disc_count=1, disc_2_reach_mm=None)
    state = _loaded(model, one, 300.0, 0.7)
    lever = drive.eccentricity_mm * drive.ratio
    across = _across(one, state, 0.7) if state else math.nan
    yield identity(
        "ring force across the eccentricity / (T / (e N))",
        across * lever / 300e3,
        "one disc, with clearance; whatever the sharing and the law",
    )
    parts = float(state.budget["twist_arcmin"].sum()) if state else math.nan
    yield identity(
        "work of every part / torque times twist",
        parts / (state.twist_arcmin if state else math.nan),
        "energy balance of the equilibrium",
    )
    pitch = 2 * math.pi / (drive.ratio + 1)
    turned = drive.replace(hole_clocking_deg=math.degrees(pitch) * (1 + 1 / drive.ratio))
    there = twist(drive, 400.0, 0.7)
    yield identity(
        "twist a ring pitch further, holes turned along / twist",
        twist(turned, 400.0, 0.7 + pitch) / there,
        "the whole figure turned is the same drive",
    )
    yield identity(
        "twist under the mirrored torque at the mirrored crank / - twist",
        -twist(drive, -400.0, -0.7) / there,
        "the drive's mirror image",
    )
    double = drive.replace(
        youngs_modulus_gpa=2 * drive.youngs_modulus_gpa,
        eccentric_bearing_stiffness_n_per_mm=8e5,
    )
    yield identity(
        "twist of a drive twice as stiff under twice the torque / twist",
        twist(double, 800.0, 0.7) / there,
        "Young's modulus and bearings doubled; doubled widths alone go by width^0.8 in the law",
    )


def _across(drive: Drive, state: LoadedState, crank: float) -> float:
    """The ring's force on the first disc square to the eccentricity [N]."""
    pins = drive.ratio + 1
    angles = 2 * math.pi * np.arange(pins) / pins
    outward = np.stack([np.cos(angles), np.sin(angles)])
    along = np.array([math.cos(crank), math.sin(crank)])
    normals = (
        drive.eccentricity_mm * pins * along[:, None] - drive.ring_pin_circle_radius_mm * outward
    )
    normals /= np.linalg.norm(normals, axis=0)
    forces = state.ring_pin_forces_n[0]
    if len(forces) != pins:
        return math.nan
    return abs(float(forces @ (-along[1] * normals[0] + along[0] * normals[1])))


def _bearing(model: Model, base: Drive) -> Iterator[Fact]:
    drive = base.replace(
        ratio=29, eccentricity_mm=1.25, ring_pin_circle_radius_mm=52.5, hole_clocking_deg=0.0,
        output_pin_count=4, output_pin_circle_radius_mm=34.0, output_torque_nm=116.0,
        disc_outer_radius_mm=50.0, disc_bore_radius_mm=15.0, output_pin_diameter_mm=16.0,
        ring_pin_radius_mm=3.5, disc_width_mm=13.5, eccentric_bearing_stiffness_n_per_mm=1e9,
        disc_1_reach_mm=0.01, disc_2_reach_mm=0.01,
    )  # fmt: skip
    state = _loaded(model, drive, 116.0, 0.0)
    found = abs(float(state.disc_translation_mm[0, 1])) * 1e9 if state else math.nan
    yield _row(
        "29:1: bearing force across the eccentricity, at 0 deg", 1599.97, found, "N", 0.1,
        "independent solution", "of 1599.97 / 1150.51 / 1970.68 N", "published", source=RATIO_29,
    )  # fmt: skip


def _krol_inner(model: Model) -> Iterator[Fact]:
    drive = model.change_drive(
        Drive.reference_87().replace(youngs_modulus_gpa=200.0, poisson_ratio=0.3)
    )
    steel = (drive.youngs_modulus_gpa, drive.poisson_ratio)
    for design, (width, sleeve, hole, circle, printed) in _KROL_INNER.items():
        force = 2 * 1550.0 * 15 * math.cos(2 * math.pi / 8) / (math.pi * circle)
        stress = _core.line_contact(force, width, (sleeve, -hole), steel, steel)[1]
        yield _row(
            f"Krol et al. 2019, design {design}: stress at the inner pins", printed, stress, "MPa",
            1.0, "evidence", "force 2 Mh zs cos(2 pi / zi) / (pi Rw) of theirs", "published",
            source=KROL,
        )  # fmt: skip


def _wang(model: Model, base: Drive) -> Iterator[Fact]:
    for case, ring, pin, circle, inner, printed, ours in _WANG:
        drive = base.replace(
            ratio=43, disc_count=1, eccentricity_mm=0.875 * ring / 88,
            ring_pin_circle_radius_mm=ring / 2, ring_pin_radius_mm=pin / 2, disc_width_mm=11.0,
            output_pin_count=8, output_pin_circle_radius_mm=circle / 2,
            output_pin_diameter_mm=inner, bush_wall_mm=3.0, disc_outer_radius_mm=70.0,
            disc_bore_radius_mm=26.75, output_torque_nm=100.0, disc_density_kg_m3=1000.0,
        )  # fmt: skip
        try:
            changed = model.change_drive(drive)
            _, _, columns = changed.part_study("full").evaluate_range(
                changed.study(), 0, 1, ["disc_mass_kg"]
            )
            volume = float(columns[0, 0]) * 1e6
        except InputError:
            volume = math.nan
        yield _row(
            f"Wang et al. 2016, {case}: volume of a disc", printed, volume, "mm^3",
            5e-4 * printed, "evidence", "", "published",
            "4.6 % more than theirs, whose last term 2 a zc B is no area of lobes: between the "
            "root circle and the profile lie 505 mm^2, they add 120; ours is the profile's own "
            "area",
            ours,
            WANG,
        )  # fmt: skip


def _cycloidgen(model: Model, drive: Drive) -> Iterator[Fact]:
    state = _loaded(model, drive, 25.0, 0.3)
    forces = [] if state is None else [force for force in state.output_pin_forces_n[0] if force > 0]
    found = sorted(forces) if len(forces) == 3 else [math.nan] * 3
    for expected, force in zip(sorted(_CYCLOIDGEN_FORCES), found, strict=True):
        yield _row(
            f"cycloidgen 8.0.0, 11:1 at 25 N m a disc: output force of {expected:g} N", expected,
            force, "N", 0.03 * expected, "independent solution",
            "code-to-code, no truth; straight lines of centres there, exact ones here",
            source=CYCLOIDGEN,
        )  # fmt: skip


def _printed(model: Model, drive: Drive) -> Iterator[Fact]:
    source = (
        "measured 310 to 337 by Volbeda (MSc thesis, 2024); modulus of the prints assumed, 5 GPa"
    )
    shaft = ({"kind": "cylinder", "diameter_mm": 20.0, "length_mm": 40.0},)
    results = model.evaluate(drive.replace(shaft=shaft, output_stiffness_nm_per_arcmin=None))
    pin = results["pin_compliance_rad_per_nm"]
    share = results["pin_participation_statics"]
    for rule, number in (("Eq. (11)", 1.0), ("statics", share)):
        yield Fact(
            GROUP, f"13:1 printed drive, published model by {rule}: stiffness of the pins",
            _PRINTED_NM_PER_RAD, drive.output_pin_count * number / pin, "N m/rad", "assumed",
            "comparison", None, f"{source}; pins over their whole length, no shaft",
        )  # fmt: skip
    for material, modulus in (("printed pins", 5.0), ("steel pins", 206.0)):
        state = _loaded(model, drive.replace(youngs_modulus_gpa=modulus), 12.5, 0.3)
        slope = state.tangent_stiffness_nm_per_arcmin / _ARCMIN if state else math.nan
        yield Fact(
            GROUP, f"13:1 printed drive, component model, {material}: stiffness",
            _PRINTED_NM_PER_RAD, slope, "N m/rad", "assumed", "comparison", None,
            f"{source}; at half of 25 N m, pins loaded at the disc's middle; housing and joints "
            "not in it",
        )  # fmt: skip
