"""Every reason to refuse a variant: one change from the reference drive, its row and its words."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
import cyclosweep._core as _core

NAN, INF = float("nan"), float("inf")

# Status, the one change that deserves it, and words of the explanation.
REFUSED: list[tuple[str, dict[str, float], str]] = [
    ("non_finite_input", {"eccentricity_mm": NAN}, "eccentricity is not a finite number"),
    ("non_finite_input", {"hole_clocking_deg": INF}, "hole_clocking"),
    ("non_finite_input", {"ratio": NAN}, "ratio"),
    ("non_finite_input", {"poisson_ratio": -INF}, "poisson_ratio"),
    ("non_finite_input", {"shaft_2_length_mm": NAN}, "shaft length"),
    ("non_finite_input", {"input_inertia_kg_m2": INF}, "input_inertia"),
    ("non_positive_dimension", {"eccentricity_mm": 0.0}, "eccentricity must be above zero"),
    ("non_positive_dimension", {"output_pin_length_mm": -1.0}, "output_pin_length"),
    ("non_positive_dimension", {"youngs_modulus_gpa": 0.0}, "youngs_modulus"),
    ("non_positive_dimension", {"input_speed_rpm": 0.0}, "input_speed"),
    ("non_positive_dimension", {"output_torque_nm": -5.0}, "output_torque"),
    ("non_positive_dimension", {"input_inertia_kg_m2": 0.0}, "input_inertia"),
    ("non_positive_dimension", {"output_stiffness_nm_per_arcmin": 0.0}, "output_stiffness"),
    ("non_positive_dimension", {"shaft_1_diameter_mm": 0.0}, "shaft diameter"),
    ("non_positive_dimension", {"shaft_6_end_diameter_mm": -1.0}, "shaft end diameter"),
    ("negative_dimension", {"bush_wall_mm": -0.1}, "bush_wall must not be negative"),
    ("negative_dimension", {"free_play_deg": -1.0}, "free_play"),
    ("negative_dimension", {"keyway_coefficient": -1.0}, "keyway_coefficient"),
    ("negative_dimension", {"shaft_1_keyway_depth_mm": -1.0}, "keyway depth"),
    ("ratio_out_of_range", {"ratio": 2}, "3 to 300, found 2"),
    ("ratio_out_of_range", {"ratio": 301}, "3 to 300, found 301"),
    ("ratio_out_of_range", {"ratio": 86.5}, "whole number"),
    ("disc_count_out_of_range", {"disc_count": 0}, "1 to 4, found 0"),
    ("disc_count_out_of_range", {"disc_count": 5}, "1 to 4, found 5"),
    ("pin_count_out_of_range", {"output_pin_count": 2}, "3 to 64, found 2"),
    ("pin_count_out_of_range", {"output_pin_count": 65}, "3 to 64, found 65"),
    ("pin_count_out_of_range", {"output_pin_count": 8.5}, "whole number"),
    ("eccentricity_too_large_for_ring", {"eccentricity_mm": 0.86}, "K1"),
    ("eccentricity_too_large_for_ring", {"eccentricity_mm": 75.0 / 88.0}, "K1"),
    (
        "flange_cuts_pin_circle",
        {"shaft_6_end_diameter_mm": 90.1},
        "90.1 mm, the circle of the output pins",
    ),
    ("disc_exceeds_ring", {"disc_outer_radius_mm": 75.0}, "ring-pin circle"),
    ("hole_never_crosses_pitch_circle", {"output_pin_circle_radius_mm": 0.3}, "pitch circle"),
    ("pin_bore_too_large", {"output_pin_bore_mm": 16.0}, "no wall"),
    ("holes_overlap", {"output_pin_count": 14}, "neighbouring holes"),
    ("hole_breaks_rim", {"disc_outer_radius_mm": 55.0}, "rim"),
    ("hole_breaks_bore", {"disc_bore_radius_mm": 35.0}, "bore"),
    ("poisson_out_of_range", {"poisson_ratio": 0.51}, "0.5"),
    ("poisson_out_of_range", {"poisson_ratio": -1.0}, "-1"),
    ("shaft_step_not_ascending", {"shaft_2_diameter_mm": 49.0}, "steps down"),
    ("keyway_too_deep", {"shaft_1_keyway_depth_mm": 25.0}, "reaches the axis"),
]


def table(drive: cs.Drive, change: dict[str, float]) -> cs.Space:
    """The change between two variants that can be built."""
    (name, value), *_ = change.items()
    known = drive.values()[name]
    good = None if np.isnan(known) else known
    return cs.Space.table(drive, pl.DataFrame({name: [good, value, good]}, strict=False))


@pytest.mark.parametrize(("status", "change", "words"), REFUSED)
def test_one_change_one_reason(
    reference: cs.Drive, status: str, change: dict[str, float], words: str
) -> None:
    space = table(reference, change)
    frame = cs.sweep(space)
    assert frame["status"].to_list() == ["ok", status, "ok"]
    explanation = space.core().explain(1)
    assert explanation is not None
    assert words in explanation
    assert "\n" not in explanation
    assert space.core().explain(0) is None


@pytest.mark.parametrize(("status", "change", "words"), REFUSED)
def test_a_refused_row_keeps_its_place_and_inputs_and_has_null_results(
    reference: cs.Drive, status: str, change: dict[str, float], words: str
) -> None:
    frame = cs.sweep(table(reference, change))
    (name, value), *_ = change.items()
    assert frame["variant"].to_list() == [0, 1, 2]
    kept = frame[name][1]
    assert kept == value or (kept != kept and value != value)
    results = [column for column in frame.columns if column not in ("variant", name, "status")]
    assert all(frame[column][1] is None for column in results)
    assert frame["twist_1tn_deg"].null_count() == 1
    assert frame.row(0)[3:] == frame.row(2)[3:]


@pytest.mark.parametrize(
    ("eccentricity", "pins", "circle"), [(1.2, 60, 72.0), (0.7, 90, 63.0), (0.45, 160, 72.0)]
)
def test_a_cusp_is_refused_whichever_way_its_k1_is_rounded(
    reference: cs.Drive, eccentricity: float, pins: int, circle: float
) -> None:
    changed = reference.replace(
        eccentricity_mm=eccentricity, ratio=pins - 1, disc_outer_radius_mm=circle - 1
    )
    circles = circle * np.array([1 - 1e-9, 1 - 1e-15, 1.0, 1 + 1e-15, 1 + 1e-9])
    frame = cs.sweep(cs.Space.grid(changed, ring_pin_circle_radius_mm=circles))
    refused = frame["status"] == "eccentricity_too_large_for_ring"
    assert refused.to_list() == [True, True, True, True, False]


def test_every_status_is_reached() -> None:
    assert {status for status, _, _ in REFUSED} | {"ok"} == set(_core.status_labels())


def test_every_input_that_cannot_be_is_noticed(reference: cs.Drive) -> None:
    """No input is forgotten: each, made NaN or infinite, refuses the variant."""
    for name in reference.inputs():
        if name == "criterion":
            continue
        optional = name in ("input_inertia_kg_m2", "output_stiffness_nm_per_arcmin")
        for value in (INF, -INF) if optional else (NAN, INF, -INF):
            frame = cs.sweep(table(reference, {name: value}))
            assert frame["status"][1] == "non_finite_input", (name, value)


def test_optional_inputs_may_be_missing(reference: cs.Drive) -> None:
    columns = {"input_inertia_kg_m2": [0.002, None], "output_stiffness_nm_per_arcmin": [None, 9.0]}
    space = cs.Space.table(reference, pl.DataFrame(columns))
    frame = cs.sweep(space)
    assert frame["status"].to_list() == ["ok", "ok"]
    assert frame["natural_frequency_hz"].is_null().to_list() == [False, True]
    assert frame["output_compliance_rad_per_nm"][1] == pytest.approx(math.pi / (9.0 * 10800))
    assert space[0].output_stiffness_nm_per_arcmin is None
    assert space[1].input_inertia_kg_m2 is None


def test_a_drive_without_shaft_needs_its_stiffness(reference: cs.Drive) -> None:
    drive = reference.replace(shaft=(), output_stiffness_nm_per_arcmin=20.0)
    frame = cs.sweep(
        cs.Space.table(drive, pl.DataFrame({"output_stiffness_nm_per_arcmin": [20.0, None]}))
    )
    assert frame["status"].to_list() == ["ok", "non_finite_input"]
    assert frame["shaft_compliance_rad_per_nm"].to_list() == [None, None]


def test_infeasible_values_never_raise_in_bulk(reference: cs.Drive) -> None:
    wild = [NAN, INF, -INF, 0.0, -1.0, 5e-324, 1e-300, 1e300, 1.7e308, 0.5]
    for name in reference.inputs():
        if name != "criterion":
            frame = cs.sweep(cs.Space.grid(reference, **{name: wild}))
            assert frame.height == len(wild)
            assert frame["status"].null_count() == 0


@pytest.mark.parametrize(
    ("limits", "statuses"),
    [
        ({"hole_web_mm": (7.0, None)}, ["ok", "limit_hole_web_mm", "holes_overlap"]),
        ({"output_pin_diameter_mm": (None, 16)}, ["ok", "limit_output_pin_diameter_mm"]),
        ({"ratio": (88, None)}, ["limit_ratio", "limit_ratio", "holes_overlap"]),
        ({"twist_1tn_deg": (None, 10)}, ["limit_twist_1tn_deg", "limit_twist_1tn_deg"]),
        (
            {"ratio": (88, None), "hole_web_mm": (7.0, None)},
            ["limit_ratio", "limit_ratio", "holes_overlap"],
        ),
    ],
)
def test_a_broken_limit_is_the_status(
    reference: cs.Drive, limits: Any, statuses: list[str]
) -> None:
    space = cs.Space.grid(reference, output_pin_diameter_mm=[16, 23, 60])
    frame = cs.sweep(space, limits=limits)
    assert frame["status"].to_list()[: len(statuses)] == statuses
    assert frame["twist_1tn_deg"].is_null().to_list() == [s != "ok" for s in frame["status"]]
    assert set(cast("pl.Enum", frame["status"].dtype).categories) >= {
        f"limit_{name}" for name in limits
    }


@pytest.mark.parametrize("value", [7.85, 15.7, 15.79, 31.31, 0.62, 1 / 3])
def test_a_limit_holds_for_its_own_value(reference: cs.Drive, value: float) -> None:
    """What stands exactly on a limit keeps it, whether the input varies or not."""
    drive = reference.replace(output_pin_length_mm=value)
    limits = {"output_pin_length_mm": (value, value)}
    still = cs.sweep(cs.Space.grid(drive, output_pin_count=[8]), limits=limits)
    moving = cs.sweep(cs.Space.grid(drive, output_pin_length_mm=[value]), limits=limits)
    assert still["status"].to_list() == moving["status"].to_list() == ["ok"]
