"""Random drives that can be built, of every shape the library knows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

import cyclosweep as cs


def random_drives(seed: int, count: int, **fixed: Any) -> Iterator[cs.Drive]:
    """Yield ``count`` drives; ``fixed`` overrides what would be drawn."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        yield random_drive(rng, name=f"random-{seed}-{number}", **fixed)


def random_drive(rng: np.random.Generator, **fixed: Any) -> cs.Drive:
    """Draw one drive that can be built."""
    ratio = fixed.pop("ratio", int(rng.integers(3, 301)))
    pins = fixed.pop("output_pin_count", int(rng.integers(3, 65)))
    ring = rng.uniform(20, 300)
    rim = ring * rng.uniform(0.8, 0.99)
    circle = rim * rng.uniform(0.3, 0.75)
    hub = circle * rng.uniform(0, 0.6)
    room = 2 * min(circle * np.sin(np.pi / pins), rim - circle, circle - hub)
    e = min(rng.uniform(0.05, 0.95) * ring / (ratio + 1), rng.uniform(0.02, 0.13) * room)
    pin = (room * rng.uniform(0.3, 0.95) - 2 * e) * rng.uniform(0.5, 1)
    wall = max(0.0, (room * 0.96 - 2 * e - pin) / 2) * rng.choice([0.0, 0.5])
    shaft = random_shaft(rng, 2 * circle) if rng.random() < 0.85 else ()
    stiffness = rng.uniform(0.05, 500) if not shaft or rng.random() < 0.1 else None
    drawn: dict[str, Any] = {
        "ratio": ratio,
        "disc_count": int(rng.integers(1, 5)),
        "eccentricity_mm": e,
        "ring_pin_circle_radius_mm": ring,
        "hole_clocking_deg": rng.uniform(-400, 400),
        "output_pin_count": pins,
        "output_pin_circle_radius_mm": circle,
        "output_pin_diameter_mm": pin,
        "output_pin_bore_mm": pin * rng.uniform(0, 0.95) if rng.random() < 0.5 else 0.0,
        "output_pin_length_mm": rng.uniform(0.2, 8) * pin,
        "bush_wall_mm": wall,
        "disc_outer_radius_mm": rim,
        "disc_bore_radius_mm": hub,
        "youngs_modulus_gpa": rng.uniform(2, 400),
        "poisson_ratio": rng.uniform(0, 0.5),
        "keyway_coefficient": rng.choice([0.0, 1.25, 10.0]),
        "input_power_kw": rng.uniform(0.01, 20),
        "input_speed_rpm": rng.uniform(100, 6000),
        "output_torque_nm": rng.uniform(1, 5000),
        "free_play_deg": rng.uniform(0, 40),
        "input_inertia_kg_m2": rng.uniform(1e-5, 0.1) if rng.random() < 0.5 else None,
        "output_stiffness_nm_per_arcmin": stiffness,
        "criterion": str(rng.choice(["published-map", "inside", "statics"])),
        "shaft": shaft,
    }
    plain = {k: v.item() if isinstance(v, np.generic) else v for k, v in drawn.items()}
    return cs.Drive(**{**plain, **fixed})


def random_shaft(
    rng: np.random.Generator, largest: float
) -> tuple[cs.Keyway | cs.Cylinder | cs.Frustum, ...]:
    """Draw one to six segments whose diameter never falls and ends at ``largest`` (mm) at most."""
    segments: list[cs.Keyway | cs.Cylinder | cs.Frustum] = []
    diameter = float(rng.uniform(5, 80))
    for _ in range(int(rng.integers(1, 7))):
        length = float(rng.uniform(1, 120))
        kind = rng.choice(["keyway", "cylinder", "frustum"])
        if kind == "keyway":
            depth = diameter * float(rng.uniform(0, 0.45))
            segments.append(
                cs.Keyway(diameter_mm=diameter, length_mm=length, keyway_depth_mm=depth)
            )
        elif kind == "cylinder":
            segments.append(cs.Cylinder(diameter_mm=diameter, length_mm=length))
        else:
            end = diameter * float(rng.uniform(0.5, 2))
            segments.append(cs.Frustum(diameter_mm=diameter, end_diameter_mm=end, length_mm=length))
            diameter = end
        flange = diameter
        diameter *= float(rng.choice([1.0, rng.uniform(1, 1.8)]))
    return tuple(thinner(segment, min(1.0, 0.99 * largest / flange)) for segment in segments)


def thinner(
    segment: cs.Keyway | cs.Cylinder | cs.Frustum, scale: float
) -> cs.Keyway | cs.Cylinder | cs.Frustum:
    """Return the segment with every diameter and depth multiplied by ``scale``."""
    fields = {"diameter_mm", "end_diameter_mm", "keyway_depth_mm"} & segment.model_dump().keys()
    return segment.model_copy(update={name: getattr(segment, name) * scale for name in fields})
