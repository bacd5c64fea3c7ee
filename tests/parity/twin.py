"""The whole model once more, in slow plain Python, written from the paper's formulas.

Nothing here is shared with the core: every hole of every disc is looked at on its own, angles
are in degrees, and windows are found as intervals and then united, counted and integrated.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import cyclosweep as cs

Interval = tuple[float, float]


@dataclass(frozen=True)
class Counts:
    """Active contacts over one turn, and how long the least and the most of them last (deg)."""

    mean: float
    least: int
    most: int
    least_lasts: float
    most_lasts: float


def hole_angles(drive: cs.Drive) -> list[float]:
    """Angle (deg) of each hole at theta = 0: holes symmetric about ring pin 0, then clocked."""
    pitch = 360 / drive.output_pin_count
    return [(j + 0.5) * pitch + drive.hole_clocking_deg for j in range(drive.output_pin_count)]


def delta_deg(drive: cs.Drive) -> float:
    """Return delta = asin(e / (2 R_OP))."""
    return math.degrees(math.asin(drive.eccentricity_mm / (2 * drive.output_pin_circle_radius_mm)))


def recurring(opens: float, closes: float, psi_at_zero: float, ratio: int) -> list[Interval]:
    """Stretches of theta in 0..360 with psi in (opens, closes) modulo a turn.

    psi = psi_at_zero + theta (1 + 1/i), so a window comes back every 360 i / (i + 1).
    """
    spin = 1 + 1 / ratio
    first = math.floor((psi_at_zero - closes) / 360) - 1
    found = []
    for turn in range(first, first + 6):
        start = (opens + 360 * turn - psi_at_zero) / spin
        end = (closes + 360 * turn - psi_at_zero) / spin
        start, end = max(start, 0.0), min(end, 360.0)
        if end > start:
            found.append((start, end))
    return found


def published_windows(drive: cs.Drive) -> list[Interval]:
    """One disc's windows by the reconstruction that matches the published map."""
    delta = delta_deg(drive)
    halves: dict[str, list[float]] = {"left": [], "right": []}
    for angle in hole_angles(drive):
        reduced = 180 - (180 - angle) % 360  # in (-180, 180]
        if reduced <= 0:
            halves["left"].append(reduced)
        else:
            halves["right"].append(-reduced)
    windows = []
    for side, holes in halves.items():
        for phi in holes:
            stretches = recurring(90 + delta, 270 - delta, -phi, drive.ratio)
            if phi != max(holes):
                stretches = [(a, min(b, 180.0)) for a, b in stretches if a < 180]
            if side == "right":
                stretches = [(360 - b, 360 - a) for a, b in stretches]
            windows.extend(stretches)
    return windows


def windows_of(drive: cs.Drive, criterion: str) -> tuple[list[Interval], int]:
    """Windows by a criterion, and how many discs each stands for."""
    if criterion == "published-map":
        return published_windows(drive), drive.disc_count
    delta = delta_deg(drive)
    low, high = (90 + delta, 270 - delta) if criterion == "inside" else (0.0, 180.0)
    windows = []
    for disc in range(drive.disc_count):
        for angle in hole_angles(drive):
            psi_at_zero = 360 * disc / drive.disc_count - angle
            windows.extend(recurring(low, high, psi_at_zero, drive.ratio))
    return windows, 1


def count(drive: cs.Drive, criterion: str) -> Counts:
    """Unite the windows: mean, least and most active contacts over one turn."""
    windows, times = windows_of(drive, criterion)
    mean = times * math.fsum(b - a for a, b in windows) / 360
    edges = sorted({0.0, 360.0, *(edge for window in windows for edge in window)})
    lasts: dict[int, float] = {}
    active, events = 0, sorted([(a, 1) for a, _ in windows] + [(b, -1) for _, b in windows])
    at = 0
    for here, following in itertools.pairwise(edges):
        while at < len(events) and events[at][0] <= here:
            active += events[at][1]
            at += 1
        if following - here > 1e-8:
            lasts[active * times] = max(lasts.get(active * times, 0.0), following - here)
    least, most = min(lasts), max(lasts)
    return Counts(mean, least, most, lasts[least], lasts[most])


def participation(drive: cs.Drive) -> float:
    """Mean over one turn of the sum of sin^2 over the loaded contacts, per pin."""
    spin = 1 + 1 / drive.ratio

    def primitive(psi: float) -> float:
        return math.radians(psi) / 2 - math.sin(math.radians(2 * psi)) / 4

    total = []
    for disc in range(drive.disc_count):
        for angle in hole_angles(drive):
            psi_at_zero = 360 * disc / drive.disc_count - angle
            for start, end in recurring(0.0, 180.0, psi_at_zero, drive.ratio):
                # Reduced to the window itself, so that the difference keeps its digits.
                a = psi_at_zero + start * spin
                turn = 360 * math.floor(a / 360 + 1e-9)
                b = psi_at_zero + end * spin
                total.append(primitive(b - turn) - primitive(a - turn))
    per_turn = math.radians(360 * spin)
    return math.fsum(total) / per_turn / drive.output_pin_count


def shaft_compliance(drive: cs.Drive) -> float:
    """Eqs. (4)-(7) in rad/(N m): segments in series and a shoulder where the diameter rises."""
    shear = drive.youngs_modulus_gpa * 1e9 / (2 * (1 + drive.poisson_ratio))
    terms = []
    before = None
    for segment in drive.shaft:
        d, length = segment.diameter_mm / 1e3, segment.length_mm / 1e3
        flange = d
        if isinstance(segment, cs.Keyway):
            depth = segment.keyway_depth_mm / 1e3
            terms.append((length + drive.keyway_coefficient * depth * length / d) / d**4)
        elif isinstance(segment, cs.Cylinder):
            terms.append(length / d**4)
        else:
            flange = segment.end_diameter_mm / 1e3
            s = d / flange
            terms.append(length * (1 + s + s**2) / (3 * d**3 * flange))
        if before is not None and d > before:
            terms.append((1 / before**3 - 1 / d**3) / 8)
        before = flange
    return 32 / (math.pi * shear) * math.fsum(terms)


def pin_compliance(drive: cs.Drive) -> float:
    """Eqs. (8)-(10) in rad/(N m): delta / (F R^2) of a Timoshenko cantilever."""
    modulus = drive.youngs_modulus_gpa * 1e9
    nu = drive.poisson_ratio
    d, bore = drive.output_pin_diameter_mm / 1e3, drive.output_pin_bore_mm / 1e3
    length, radius = drive.output_pin_length_mm / 1e3, drive.output_pin_circle_radius_mm / 1e3
    area = math.pi / 4 * (d**2 - bore**2)
    second_moment = math.pi / 64 * (d**4 - bore**4)
    m2 = (bore / d) ** 2
    kappa = 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)
    shear = modulus / (2 * (1 + nu))
    flexibility = length**3 / (3 * modulus * second_moment) + length / (kappa * shear * area)
    return flexibility / radius**2


def largest_pin_force(drive: cs.Drive) -> float:
    """Look for the largest force (N) on one contact over a turn; forces go with sin(psi)."""
    radius = drive.output_pin_circle_radius_mm / 1e3
    contacts = drive.disc_count * drive.output_pin_count
    if contacts % 2 == 0:
        return 4 * drive.output_torque_nm / (contacts * radius)

    def force(theta: float) -> float:
        sines = [
            math.sin(theta + math.tau * (disc / drive.disc_count - pin / drive.output_pin_count))
            for disc in range(drive.disc_count)
            for pin in range(drive.output_pin_count)
        ]
        loaded = [sine for sine in sines if sine > 0]
        return max(loaded) / math.fsum(sine**2 for sine in loaded)

    # Every position repeats after a step of the lattice on which all holes stand.
    step = math.tau / math.lcm(drive.disc_count, drive.output_pin_count)
    grid = [step * k / 200 for k in range(201)]
    best = max(grid, key=force)
    low, high = best - step / 200, best + step / 200
    for _ in range(60):
        left, right = low + (high - low) / 3, high - (high - low) / 3
        low, high = (left, high) if force(left) < force(right) else (low, right)
    return force((low + high) / 2) * drive.output_torque_nm / radius


def root_stress_mpa(drive: cs.Drive, force: float) -> float:
    """F L / W of a hollow round section."""
    d, bore = drive.output_pin_diameter_mm, drive.output_pin_bore_mm
    section_modulus = math.pi * (d**4 - bore**4) / (32 * d)
    return force * drive.output_pin_length_mm / section_modulus


def webs_mm(drive: cs.Drive) -> tuple[float, float, float]:
    """Material between holes, to the rim and to the bore."""
    hole = hole_diameter_mm(drive)
    circle = drive.output_pin_circle_radius_mm
    chord = 2 * circle * math.sin(math.pi / drive.output_pin_count)
    return (
        chord - hole,
        drive.disc_outer_radius_mm - (circle + hole / 2),
        (circle - hole / 2) - drive.disc_bore_radius_mm,
    )


def hole_diameter_mm(drive: cs.Drive) -> float:
    """Pin, two walls of its bush, and room for the eccentricity each side."""
    return drive.output_pin_diameter_mm + 2 * drive.bush_wall_mm + 2 * drive.eccentricity_mm


def evaluate(drive: cs.Drive, loads_tn: tuple[float, ...]) -> dict[str, float | None]:
    """Every result column of a sweep for one drive that can be built."""
    counts = {name: count(drive, name) for name in ("published-map", "inside", "statics")}
    contacts = drive.disc_count * drive.output_pin_count
    eta = {name: found.mean / (contacts / 2) for name, found in counts.items()}
    chosen = counts[drive.criterion]
    share = participation(drive) if drive.disc_count <= 2 else None

    output: float | None
    by_statics: float | None
    pin = pin_compliance(drive)
    shaft = shaft_compliance(drive) if drive.shaft else None
    per_arcmin = 60 * 180 / math.pi
    if drive.output_stiffness_nm_per_arcmin is not None:
        output = by_statics = 1 / (drive.output_stiffness_nm_per_arcmin * per_arcmin)
        factor = 1.0
    else:
        assert shaft is not None
        by_statics = None if share is None else shaft + pin / (drive.output_pin_count * share)
        if drive.criterion == "statics":
            output, factor = by_statics, 1.0
        else:
            output, factor = shaft + pin / drive.output_pin_count, eta[drive.criterion]
    reflected = None if output is None else output * drive.ratio**2
    nominal = drive.input_power_kw * 1000 / (drive.input_speed_rpm * 2 * math.pi / 60)
    radius = drive.output_pin_circle_radius_mm / 1e3
    force = largest_pin_force(drive)
    inertia = drive.input_inertia_kg_m2

    columns: dict[str, float | None] = {
        "active_pins_mean": chosen.mean,
        "active_pins_min": chosen.least,
        "active_pins_max": chosen.most,
        "torque_transfer_efficiency": eta[drive.criterion],
        "torque_transfer_efficiency_inside": eta["inside"],
        "torque_transfer_efficiency_published_map": eta["published-map"],
        "pin_participation_statics": share,
        "statics_applicable": drive.disc_count <= 2,
        "hole_diameter_mm": hole_diameter_mm(drive),
        "hole_web_mm": min(webs_mm(drive)),
        "short_width_coefficient": drive.eccentricity_mm
        * (drive.ratio + 1)
        / drive.ring_pin_circle_radius_mm,
        "nominal_torque_nm": nominal,
        "natural_frequency_hz": frequency(reflected, inertia),
        "natural_frequency_with_efficiency_hz": frequency(
            None if reflected is None else factor * reflected, inertia
        ),
        "shaft_compliance_rad_per_nm": shaft,
        "pin_compliance_rad_per_nm": pin,
        "output_compliance_rad_per_nm": output,
        "output_compliance_statics_rad_per_nm": by_statics,
        "reflected_compliance_rad_per_nm": reflected,
        "reflected_stiffness_nm_per_rad": None if reflected is None else 1 / reflected,
        "output_stiffness_nm_per_arcmin": None if output is None else 1 / (output * per_arcmin),
        "compliance_factor": factor,
        "torque_per_pin_nm": drive.output_torque_nm / chosen.mean,
        "force_per_pin_n": drive.output_torque_nm / chosen.mean / radius,
        "pin_force_max_n": force,
        "pin_bending_stress_mpa": root_stress_mpa(drive, force),
    }
    for load in loads_tn:
        name = f"twist_{load:g}tn_deg".replace(".", "p").replace("-", "minus_")
        columns[name] = None
        if reflected is not None:
            elastic = math.degrees(factor * reflected * load * nominal)
            columns[name] = elastic + math.copysign(drive.free_play_deg, load)
    return columns


def frequency(compliance: float | None, inertia: float | None) -> float | None:
    """First natural frequency (Hz) of an inertia on a spring, where there are both."""
    if compliance is None or inertia is None:
        return None
    return math.sqrt(1 / (compliance * inertia)) / (2 * math.pi)


def refusals(values: dict[str, float], kinds: Sequence[str]) -> set[str]:
    """Every status that a variant's inputs deserve, whichever is met first; empty when none.

    ``values`` in the user's units as :meth:`cyclosweep.Drive.values` names them.
    """
    reasons: set[str] = set()
    add = reasons.add
    optional = {"input_inertia_kg_m2", "output_stiffness_nm_per_arcmin"}
    zero_allowed = {
        "output_pin_bore_mm",
        "bush_wall_mm",
        "disc_bore_radius_mm",
        "keyway_coefficient",
        "free_play_deg",
    }
    any_sign = {"hole_clocking_deg", "poisson_ratio", "criterion"}
    counted = {
        "ratio": (3, 300, "ratio_out_of_range"),
        "disc_count": (1, 4, "disc_count_out_of_range"),
        "output_pin_count": (3, 64, "pin_count_out_of_range"),
    }
    for name, value in values.items():
        if math.isnan(value) and name in optional and (kinds or "stiffness" not in name):
            continue
        if not math.isfinite(value):
            add("non_finite_input")
        elif name in counted:
            low, high, reason = counted[name]
            if not (low <= value <= high and value == int(value)):
                add(reason)
        elif name in zero_allowed or name.endswith("keyway_depth_mm"):
            if value < 0:
                add("negative_dimension")
        elif name not in any_sign and value <= 0:
            add("non_positive_dimension")
    if not -1 < values["poisson_ratio"] <= 0.5:
        add("poisson_out_of_range")

    e, circle = values["eccentricity_mm"], values["output_pin_circle_radius_mm"]
    ring, rim = values["ring_pin_circle_radius_mm"], values["disc_outer_radius_mm"]
    if e * (values["ratio"] + 1) >= ring * (1 - 1e-12):
        add("eccentricity_too_large_for_ring")
    if rim >= ring:
        add("disc_exceeds_ring")
    if e >= 2 * circle:
        add("hole_never_crosses_pitch_circle")
    if values["output_pin_bore_mm"] >= values["output_pin_diameter_mm"]:
        add("pin_bore_too_large")
    radius = values["output_pin_diameter_mm"] / 2 + values["bush_wall_mm"] + e
    if (
        values["output_pin_count"] > 0
        and circle * math.sin(math.pi / values["output_pin_count"]) <= radius
    ):
        add("holes_overlap")
    if circle + radius >= rim:
        add("hole_breaks_rim")
    if circle - radius <= values["disc_bore_radius_mm"]:
        add("hole_breaks_bore")

    before = -math.inf
    for number, kind in enumerate(kinds, start=1):
        diameter = values[f"shaft_{number}_diameter_mm"]
        if diameter < before:
            add("shaft_step_not_ascending")
        if kind == "keyway" and values[f"shaft_{number}_keyway_depth_mm"] >= diameter / 2:
            add("keyway_too_deep")
        before = values[f"shaft_{number}_end_diameter_mm"] if kind == "frustum" else diameter
    if before > 2 * circle:
        add("flange_cuts_pin_circle")
    return reasons
