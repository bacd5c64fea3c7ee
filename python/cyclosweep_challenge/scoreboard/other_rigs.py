"""Lines of recordings of devices that are no cycloidal drives."""

from __future__ import annotations

import cyclosweep as cs
from cyclosweep_challenge.scoreboard.checks import (
    CONSISTENT,
    FRICTION,
    NOT_DETERMINED,
    names,
    names_one_of,
    says,
    says_the_drive_changed,
    verdict_in,
    verdict_not,
)
from cyclosweep_challenge.scoreboard.line import Check, Line

GROUP = "Other devices"
FOLDER = "other-rigs"
CURVES = ("contact_stiffening", "overload_softening", "clearance_takeup", "load_asymmetry")
"""Effects that make a spring nonlinear without a loop."""

WALL = (
    "A reinforced-concrete wall in shear, growing cycles to failure: it yields, pinches and "
    "degrades."
)
WALL_ANSWER = (
    "Friction-like loops and softening are named, and that the specimen changes while it is "
    "tested is said; never that nothing is missing."
)
WALL_CHECKS = (
    verdict_not("NOTHING_MISSING"),
    names_one_of(*FRICTION),
    names("overload_softening"),
    says_the_drive_changed(),
)
DAMPER = (
    "A band brake with backlash: Coulomb friction that depends on the side of the band; the "
    "displacement is driven, so that while it slides the torque does not fix the twist."
)
DAMPER_ANSWER = (
    "Friction is named, that the torque does not determine the twist is said, and no stiffness "
    "is below zero."
)
DAMPER_CHECKS = (
    verdict_not("NOTHING_MISSING"),
    names_one_of(*FRICTION),
    says(NOT_DETERMINED, "says that the torque does not determine the twist"),
)
FOOT_DUAL = "A prosthetic foot whose two cams switch at the ends of travel: a cause on no list."
FOOT_DUAL_ANSWER = (
    "Unknown, or mostly explained with a remainder; never that the named effects are all."
)
FOOT_CAM = "The same foot with one cam: one nonlinear spring with loss; one loop to and fro."
FOOT_CAM_ANSWER = (
    "Friction and a nonlinear spring are named; that they are all only where noise is left."
)


def _line(name: str, asks: str, answer: str, source: str, checks: tuple[Check, ...]) -> Line:
    """Line of one file of the folder."""
    file = f"{FOLDER}/{name}.csv"
    return Line(
        name,
        GROUP,
        asks,
        answer,
        source,
        lambda shared: cs.Recording.read(shared / file),
        (*CONSISTENT, *checks),
        file=file,
    )


def other_rig_lines() -> list[Line]:
    """Lines of the other devices."""
    wall = "cslotboom/hysteresis, TS1 shear experiment"
    damper = "ARTS-Laboratory, friction damper with backlash (data set's description)"
    foot = "Quraishi et al., Wearable Technologies 2021"
    return [
        _line("wall-no-clock", f"{WALL} No clock.", WALL_ANSWER, wall, WALL_CHECKS),
        _line(
            "wall-row-clock", f"{WALL} The row's index as clock.", WALL_ANSWER, wall, WALL_CHECKS
        ),
        _line("damper-30lb-1in-0.5Hz", DAMPER, DAMPER_ANSWER, damper, DAMPER_CHECKS),
        _line("damper-36lb-1in-0.25Hz", DAMPER, DAMPER_ANSWER, damper, DAMPER_CHECKS),
        _line(
            "foot-cam1-x33",
            FOOT_CAM,
            FOOT_CAM_ANSWER,
            foot,
            (verdict_not("NOTHING_MISSING"), names_one_of(*FRICTION), names_one_of(*CURVES)),
        ),
        _line(
            "foot-dual-x33",
            FOOT_DUAL,
            FOOT_DUAL_ANSWER,
            foot,
            (verdict_in("UNKNOWN_PHYSICS", "MOSTLY_EXPLAINED"),),
        ),
    ]
