"""Models with one deliberate error each, and which counted rows of the validation each breaks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import polars as pl

from cyclosweep.dynamics.spring import TrainSpring
from cyclosweep.dynamics.train import Train
from cyclosweep.errors import InputError, did_you_mean, instance_of
from cyclosweep.reference.model import Model, Results, assembled

if TYPE_CHECKING:
    from cyclosweep.design.drive import Drive
    from cyclosweep.design.loaded import LoadedState

__all__ = ["BROKEN_MODELS", "broken_model"]


def _lengths_as_metres(drive: Drive) -> Drive:
    table = drive.model_dump(exclude_none=True)
    for part in (table, *table["shaft"]):
        for name, value in part.items():
            if name.endswith("_mm"):
                is_list = isinstance(value, tuple)
                part[name] = [1e3 * gap for gap in value] if is_list else 1e3 * value
    return type(drive).model_validate(table)


def _without_second_segment(drive: Drive) -> Drive:
    return drive.replace(shaft=[*drive.shaft[:1], *drive.shaft[2:]]) if drive.shaft[1:] else drive


def _frustums_as_cylinders(drive: Drive) -> Drive:
    changes = {
        f"shaft_{number}_end_diameter_mm": segment.diameter_mm
        for number, segment in enumerate(drive.shaft, start=1)
        if segment.kind == "frustum"
    }
    return drive.replace(**changes)


def _no_shear(drive: Drive, results: Results) -> Results:
    # The deflection is a L^3 + b L; a pin twice as long tells a from b.
    longer = drive.replace(output_pin_length_mm=2 * drive.output_pin_length_mm).evaluate()
    twice = longer["pin_compliance_rad_per_nm"]
    assert twice is not None
    bending = (twice - 2 * results["pin_compliance_rad_per_nm"]) / 6
    return assembled(drive, results, pin_compliance=bending)


def _no_reflection(drive: Drive, results: Results) -> Results:
    return assembled(drive, results, reflection=drive.ratio**-2)


def _no_efficiency(drive: Drive, results: Results) -> Results:
    return assembled(drive, results, efficiency=1 / results["compliance_factor"])


def _arc_tangent(drive: Drive, results: Results) -> Results:
    torque = drive.output_torque_nm
    compliance = math.atan(results["pin_compliance_rad_per_nm"] * torque) / torque
    moved = assembled(drive, results, pin_compliance=compliance)
    force = 1e3 * torque / drive.output_pin_circle_radius_mm
    return {**moved, "torque_per_pin_nm": torque, "force_per_pin_n": force}


def _one_disc_carries_all(drive: Drive, results: Results) -> Results:
    factor = drive.disc_count
    moved = {"pin_force_max_n", "pin_bending_stress_mpa"}
    return {name: value * (factor if name in moved else 1) for name, value in results.items()}


def _force_of_even_pins(drive: Drive, results: Results) -> Results:
    contacts = drive.disc_count * drive.output_pin_count
    force = 4e3 * drive.output_torque_nm / (contacts * drive.output_pin_circle_radius_mm)
    stress = results["pin_bending_stress_mpa"] * force / results["pin_force_max_n"]
    return {**results, "pin_force_max_n": force, "pin_bending_stress_mpa": stress}


def _circular_frequency(_: Drive, results: Results) -> Results:
    return {
        name: value * (math.tau if name.startswith("natural_frequency") else 1)
        for name, value in results.items()
    }


def _free_play_with_every_load(drive: Drive, results: Results) -> Results:
    twists = [name for name in results if name.startswith("twist_")]
    once = results[twists[0]] - drive.free_play_deg
    loads = {name: (results[name] - drive.free_play_deg) / once for name in twists}
    more = {name: results[name] + (load - 1) * drive.free_play_deg for name, load in loads.items()}
    return {**results, **more}


def _shares_by_sine(drive: Drive, results: Results) -> Results:
    if math.isnan(results["pin_participation_statics"]):
        return results
    share = drive.disc_count / math.pi  # mean of sin over a turn, zero where a hole does not push
    moved = {**results, "pin_participation_statics": share}
    if drive.output_stiffness_nm_per_arcmin is not None:
        return moved
    pin = results["pin_compliance_rad_per_nm"] / (share * drive.output_pin_count)
    compliance = results["shaft_compliance_rad_per_nm"] + pin
    moved["output_compliance_statics_rad_per_nm"] = compliance
    by_statics = drive.criterion == "statics"
    return assembled(drive, moved, output_compliance=compliance) if by_statics else moved


def _stiffness_not_reflected(_: Drive, results: Results) -> Results:
    stiffness = 1 / results["output_compliance_rad_per_nm"]
    return {**results, "reflected_stiffness_nm_per_rad": stiffness}


def _degrees_for_arcminutes(_: Drive, results: Results) -> Results:
    stiffness = results["output_stiffness_nm_per_arcmin"]
    return {**results, "output_stiffness_nm_per_arcmin": 60 * stiffness}


def _without_root(drive: Drive, torque: float, crank: float) -> LoadedState:
    state = drive.loaded(torque, crank)
    return replace(state, budget=state.budget.filter(pl.col("component") != "pin root"))


def _play_taken_for_its_half(train: Train) -> Train:
    springs = [
        TrainSpring.linear(spring.slopes_nm_per_rad[-1], 2 * spring.gap_rad, spring.friction)
        for spring in train.springs
    ]
    return _with_springs(train, springs, train.ratios)


def _springs_in_series_with_themselves(train: Train) -> Train:
    springs = [
        TrainSpring(
            spring.knees_rad,
            tuple(slope / 2 for slope in spring.slopes_nm_per_rad),
            spring.unloaded_rad,
            spring.friction,
        )
        for spring in train.springs
    ]
    return _with_springs(train, springs, train.ratios)


def _ends_not_held(train: Train) -> Train:
    if not train.grounded:
        return train
    names = (*train.names, "far_end")
    inertias = (*train.inertias_kg_m2, train.inertias_kg_m2[-1])
    return Train(inertias, springs=train.springs, ratios=train.ratios, names=names)


def _with_springs(train: Train, springs: Sequence[TrainSpring], ratios: Sequence[float]) -> Train:
    return Train(
        train.inertias_kg_m2,
        grounded=train.grounded,
        springs=springs,
        ratios=ratios,
        names=train.names,
        spring_names=train.spring_names,
    )


BROKEN_MODELS: tuple[Model, ...] = (
    Model(
        "E halved",
        "Young's modulus is half of what the drive states",
        lambda d: d.replace(youngs_modulus_gpa=d.youngs_modulus_gpa / 2),
    ),
    Model(
        "e halved",
        "the eccentricity is half of what the drive states",
        lambda d: d.replace(eccentricity_mm=d.eccentricity_mm / 2),
    ),
    Model(
        "a pin less",
        "one output pin fewer than the drive states",
        lambda d: d.replace(output_pin_count=d.output_pin_count - 1),
    ),
    Model(
        "k = 1.25",
        "the keyway coefficient of Eq. (5) is 1.25 instead of the printed 10",
        lambda d: d.replace(keyway_coefficient=1.25),
    ),
    Model("i^2 forgotten", "Eq. (12) without the ratio squared", change_results=_no_reflection),
    Model("eta dropped", "Eq. (13) without the efficiency", change_results=_no_efficiency),
    Model(
        "a step left out",
        "the shaft's second segment is missing in Eq. (4)",
        _without_second_segment,
    ),
    Model(
        "shear left out",
        "the pin's deflection in Eqs. (8)-(10) is by bending alone",
        change_results=_no_shear,
    ),
    Model(
        "metres for millimetres",
        "every length in mm is taken as one in m",
        _lengths_as_metres,
    ),
    Model(
        "rated torque on one pin",
        "Eqs. (8)-(10) with the whole rated torque on one pin and the arc tangent kept",
        change_results=_arc_tangent,
    ),
    Model(
        "one disc carries all",
        "the pin's force as if one disc carried the whole torque",
        change_results=_one_disc_carries_all,
    ),
    Model(
        "odd pins as even",
        "the pin's force as 4 T_O / (n N_OP R_OP) for odd numbers of pins too",
        change_results=_force_of_even_pins,
    ),
    Model(
        "frustum as a cylinder",
        "Eq. (7) with the smaller diameter all along",
        _frustums_as_cylinders,
    ),
    Model(
        "speed in rad/s",
        "the input speed in rpm is taken as one in rad/s",
        lambda d: d.replace(input_speed_rpm=d.input_speed_rpm * 30 / math.pi),
    ),
    Model(
        "2 pi forgotten",
        "the natural frequency in rad/s instead of Hz",
        change_results=_circular_frequency,
    ),
    Model(
        "free play with every load",
        "the free play is added once for every nominal torque",
        change_results=_free_play_with_every_load,
    ),
    Model(
        "shares by sine alone",
        "statics with the contacts' lever arms left out: sine where sine squared is meant",
        change_results=_shares_by_sine,
    ),
    Model(
        "stiffness not reflected",
        "the stiffness at the output where the one at the input is meant",
        change_results=_stiffness_not_reflected,
    ),
    Model(
        "degrees for arc minutes",
        "the stiffness in N m/deg where N m/arcmin is meant",
        change_results=_degrees_for_arcminutes,
    ),
    Model(
        "crank in degrees",
        "the crank's angle in rad is taken as one in degrees",
        solve=lambda drive, torque, crank: drive.loaded(torque, math.radians(crank)),
    ),
    Model(
        "tare left in",
        "5 N m of tare are left in the torque on a loaded drive",
        solve=lambda drive, torque, crank: drive.loaded(torque + 5.0, crank),
    ),
    Model(
        "pin root left out",
        "the parts of a loaded drive's twist without the pins' root",
        solve=_without_root,
    ),
    Model(
        "play taken for its half",
        "the whole play of a train's spring to each side, instead of half of it",
        change_train=_play_taken_for_its_half,
    ),
    Model(
        "train too soft",
        "every spring of a train with half of its stiffness",
        change_train=_springs_in_series_with_themselves,
    ),
    Model(
        "end not held",
        "a locked output of a train as an inertia that swings",
        change_train=_ends_not_held,
    ),
)
"""Each must break at least one counted row that the package itself meets."""


def broken_model(name: str) -> Model:
    """Return the model with a given error.

    Parameters
    ----------
    name : str
        Name of one of :data:`BROKEN_MODELS`.

    Raises
    ------
    InputError
        For another name; the message lists those there are.
    """
    known = {model.name: model for model in BROKEN_MODELS}
    instance_of("broken model", name, str)
    if name not in known:
        raise InputError(
            f"broken model {name!r}: no such model, expected one of {', '.join(known)}"
            f"{did_you_mean(name, known)}"
        )
    return known[name]
