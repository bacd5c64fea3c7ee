"""Lines of a rig that sets the angle: readings within the play, held off zero by friction."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from cyclosweep.recording import Recording
from cyclosweep_challenge.scoreboard.checks import (
    CONSISTENT,
    names,
    names_nothing,
    names_only,
    verdict_in,
    within_noise,
)
from cyclosweep_challenge.scoreboard.line import Check, Line
from cyclosweep_challenge.scoreboard.made_lines import NAMED
from cyclosweep_challenge.scoreboard.made_rig import Friction
from cyclosweep_challenge.scoreboard.turned_rig import TurnedLoops, turned

GROUP = "Made recordings of a rig that sets the angle"
SOURCE = "by construction (cyclosweep_challenge/scoreboard/turned_rig.py)"
COULOMB = "friction_hysteresis"


def _made(loops: TurnedLoops, recordings: Path) -> Recording:
    """Make a recording; the folder of recordings is not needed."""
    return turned(loops)


def _line(name: str, asks: str, loops: TurnedLoops, effects: tuple[str, ...]) -> Line:
    """Line of some loops with the effects that are at work in them."""
    words = " and ".join(effects).replace("_", " ")
    checks: tuple[Check, ...]
    if effects:
        checks = verdict_in(*NAMED), names(*effects), names_only(*effects), within_noise()
    else:
        checks = verdict_in("NOTHING_MISSING"), names_nothing()
    answer = f"Named: {words}, nothing else; within the noise." if effects else "Nothing missing."
    make = partial(_made, loops)
    return Line(name, GROUP, asks, answer, SOURCE, make, (*CONSISTENT, *checks), verdict_only=True)


def turned_lines() -> list[Line]:
    """Return the lines."""
    both = COULOMB, "load_dependent_friction"
    return [
        _line("turned-nothing", "No friction at all.", TurnedLoops(5_100), ()),
        _line(
            "turned-dahl",
            "Friction of 7 % of the torque after Dahl.",
            TurnedLoops(5_101, friction=Friction(constant_nm=2.0)),
            (COULOMB,),
        ),
        _line(
            "turned-jenkins",
            "The same as a Jenkins element, loops of 10, 20 and 30 N m.",
            TurnedLoops(5_102, (10.0, 20.0, 30.0), friction=Friction("jenkins", constant_nm=2.0)),
            (COULOMB,),
        ),
        _line(
            "turned-bouc-wen",
            "Friction of 17 % after Bouc and Wen, presliding 8 deg.",
            TurnedLoops(5_103, friction=Friction("bouc-wen", 8.0, 5.0)),
            (COULOMB,),
        ),
        _line(
            "turned-small-play",
            "A loop that is wider than the play of 2 deg.",
            TurnedLoops(5_104, play_deg=2.0, friction=Friction(constant_nm=2.0)),
            (COULOMB,),
        ),
        _line(
            "turned-opening-loop",
            "Friction that grows with the load, and a little that does not.",
            TurnedLoops(5_105, friction=Friction(constant_nm=0.2, share=0.08)),
            both,
        ),
        _line(
            "turned-few-readings",
            "60 readings a loop.",
            TurnedLoops(5_106, readings=60, friction=Friction(constant_nm=2.0)),
            (COULOMB,),
        ),
        _line(
            "turned-torque-noise",
            "The angle is exact, and the torque is read with a noise of 0.02 N m.",
            TurnedLoops(
                5_107, noise_deg=0.0, torque_noise_nm=0.02, friction=Friction(constant_nm=2.0)
            ),
            (COULOMB,),
        ),
    ]
