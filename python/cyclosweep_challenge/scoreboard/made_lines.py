"""Lines of recordings that the scoreboard makes: the rows of what failed on other generators."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from cyclosweep.recording import Recording
from cyclosweep_challenge.scoreboard.checks import (
    CONSISTENT,
    FRICTION,
    names,
    names_nothing,
    names_only,
    no_stiffness_to_three_digits,
    removes,
    says_the_drive_changed,
    verdict_in,
    verdict_not,
    within_seconds,
)
from cyclosweep_challenge.scoreboard.line import Check, Line, Summary
from cyclosweep_challenge.scoreboard.made import Recipe, correlated, long_recording, make
from cyclosweep_challenge.scoreboard.made_rig import Law
from cyclosweep_challenge.scoreboard.outcome import Outcome

GROUP = "Made recordings"
SOURCE = "by construction (cyclosweep_challenge/scoreboard/made.py)"
NAMED = ("IDENTIFIED", "MOSTLY_EXPLAINED")
"""Verdicts of a recording whose causes are all named."""
MOST = 0.9
"""Share of the mismatch that the right names remove at least [-]."""
LOUD_DEG = 0.7
"""Size of the single effects, as rms [deg]."""
HIGH = 0.97
"""Autocorrelation of noise at which another algorithm took over."""
CORRELATED_EFFECTS = (
    "creep",
    "overload_softening",
    "thermal_drift",
    "friction_hysteresis",
    "contact_stiffening",
    "transmission_error",
    "datum_drift",
    "load_asymmetry",
)
"""Effects under strongly correlated noise, one recording each, d = 20."""
QUIET = 6
"""Recordings with nothing missing under the same noise."""
POWER = 0.8
"""Share to be found there; a test that knows the effect finds all [-]."""
LADDER = ("contact_stiffening", "overload_softening", "thermal_drift", "creep")
"""Effects whose recording is shown at several signal-to-noise ratios."""
STEPS = (12, 40, 400)
"""Those ratios."""
LONG_ROWS = 200_000
EVERY = (1, 10, 100)
"""Rows of the long recording, and every so many-th of which it is diagnosed."""
SECONDS = 10.0
"""Time for about 3,000 rows with two effects [s]."""
ROWS_PER_SECOND = 100_000 / 90
"""Readings that a diagnosis gets through in a second, at least."""


def _made(recipe: Recipe, recordings: Path) -> Recording:
    """Make a recording; the folder of recordings is not needed."""
    return make(recipe)


def _right(effects: Sequence[str]) -> tuple[Check, ...]:
    """Checks of a recording in which some effects are at work and nothing else."""
    return (
        *CONSISTENT,
        verdict_in(*NAMED),
        names(*effects),
        names_only(*effects),
        removes(MOST),
    )


def _answer(effects: Sequence[str]) -> str:
    """Right answer in words."""
    words = " and ".join(effect.replace("_", " ") for effect in effects)
    return f"{words[0].upper()}{words[1:]}, nothing else; the repair removes the mismatch."


def _line(name: str, asks: str, recipe: Recipe, *, verdict_only: bool = False) -> Line:
    """Line of a recording of the scoreboard's rig."""
    effects = [recipe.friction] if recipe.friction else []
    effects += [*recipe.added, *recipe.added_d]
    return Line(
        name,
        GROUP,
        asks,
        _answer(effects),
        SOURCE,
        partial(_made, recipe),
        _right(effects),
        verdict_only=verdict_only,
    )


def _friction_lines() -> list[Line]:
    """Friction alone and friction with something that rides on it."""
    plain = "friction_hysteresis"
    laws: tuple[tuple[int, Law, str], ...] = (
        (18101, "jenkins", "the presliding of an elastic-plastic block"),
        (18102, "dahl", "Dahl's presliding"),
        (18103, "bouc-wen", "Bouc and Wen's presliding"),
    )
    lines = [
        _line(
            f"coulomb-{law}",
            f"Coulomb friction with {words}, loop of {LOUD_DEG:g} deg rms, noise 0.05 deg.",
            Recipe(seed, friction=plain, law=law, friction_rms_deg=LOUD_DEG),
        )
        for seed, law, words in laws
    ]
    for name, effect, seed in (
        ("large-friction-side-load", "load_asymmetry", 18111),
        ("large-friction-thermal", "thermal_drift", 18112),
    ):
        lines.append(
            _line(
                name,
                "Friction of 4.4 deg rms (Dahl) with a second effect of 0.4 deg, noise 0.2 deg.",
                Recipe(seed, 0.2, plain, friction_rms_deg=4.4, added={effect: 0.4}),
            )
        )
    lines.append(
        _line(
            "friction-16-percent",
            "Friction at 16 % of the largest torque (Bouc and Wen) with stiffening of 0.4 deg, "
            "noise 0.2 deg.",
            Recipe(
                18113,
                0.2,
                plain,
                "bouc-wen",
                friction_part=0.16,
                added={"contact_stiffening": 0.4},
            ),
        )
    )
    for effect, seed in (("creep", 18121), ("thermal_drift", 18122)):
        lines.append(
            _line(
                f"load-friction-{effect.replace('_', '-')}",
                "Load-dependent friction of 1 deg rms (Dahl) with a second effect of d = 60, "
                "noise 0.2 deg.",
                Recipe(
                    seed,
                    0.2,
                    "load_dependent_friction",
                    friction_rms_deg=1.0,
                    added_d={effect: 60.0},
                ),
            )
        )
    for part, effect, seed in (
        (0.02, "contact_stiffening", 18131),
        (0.06, "thermal_drift", 18132),
        (0.12, "datum_drift", 18133),
    ):
        lines.append(
            _line(
                f"friction-{100 * part:.0f}-percent-{effect.replace('_', '-')}",
                f"Friction at {100 * part:.0f} % of the largest torque (Dahl) with a second "
                "effect of d = 150, noise 0.05 deg.",
                Recipe(seed, 0.05, plain, "dahl", 3.0, friction_part=part, added_d={effect: 150.0}),
            )
        )
    return lines


def _single_lines() -> list[Line]:
    """Single effects far above the noise, and one recording at several ratios."""
    lines = [
        _line(
            f"loud-{effect.replace('_', '-')}",
            f"{words}, {LOUD_DEG:g} deg rms, noise 0.05 deg.",
            Recipe(seed, added={effect: LOUD_DEG}),
        )
        for effect, words, seed in (
            ("clearance_takeup", "Pins that come into contact one after another", 18141),
            ("load_asymmetry", "A side load, even in torque and saturating", 18142),
            ("datum_drift", "A zero that moves to and fro between the runs", 18143),
        )
    ]
    for number, effect in enumerate(LADDER):
        for d in STEPS:
            lines.append(
                _line(
                    f"{effect.replace('_', '-')}-d{d}",
                    f"One effect of another law at d = {d}, noise 0.05 deg.",
                    Recipe(18150 + number, added_d={effect: float(d)}),
                    verdict_only=True,
                )
            )
    return lines


def _correlated_lines() -> list[Line]:
    """Lines under noise of high autocorrelation."""

    def read(recordings: Path, seed: int, effect: str) -> Recording:
        return correlated(seed, effect, 20.0, HIGH)

    lines = [
        Line(
            f"ar97-{effect.replace('_', '-')}",
            GROUP,
            f"The challenge's rig, noise of autocorrelation {HIGH:g}, one effect of d = 20.",
            f"{effect.replace('_', ' ').capitalize()}, or at least that something is missing and "
            "no other name.",
            SOURCE,
            partial(read, seed=18200 + number, effect=effect),
            (
                *CONSISTENT,
                verdict_not("NOTHING_MISSING", "INSUFFICIENT_DATA", "DATA_FAULT"),
                names_only(effect),
            ),
            verdict_only=True,
        )
        for number, effect in enumerate(CORRELATED_EFFECTS)
    ]
    lines += [
        Line(
            f"ar97-nothing-{number + 1}",
            GROUP,
            f"The challenge's rig, noise of autocorrelation {HIGH:g}, nothing missing.",
            "Nothing missing, or that the data do not suffice; no name.",
            SOURCE,
            partial(read, seed=18250 + number, effect=""),
            (*CONSISTENT, verdict_in("NOTHING_MISSING", "INSUFFICIENT_DATA"), names_nothing()),
            verdict_only=True,
        )
        for number in range(QUIET)
    ]
    return lines


def _other_lines() -> list[Line]:
    """A drive that changes, and a long recording."""

    def long(recordings: Path, every: int) -> Recording:
        return long_recording(LONG_ROWS, every)

    lines = [
        Line(
            "changing-drive",
            GROUP,
            "Friction of 1 deg rms (Dahl) and a compliance that grows by 15 % from the first run "
            "to the last, noise 0.05 deg.",
            "The drive changed while it was tested; no stiffness to three digits.",
            SOURCE,
            partial(
                _made,
                Recipe(
                    18161,
                    friction="friction_hysteresis",
                    friction_rms_deg=1.0,
                    stiffness_loss=0.15,
                ),
            ),
            (
                *CONSISTENT,
                verdict_not("NOTHING_MISSING", "IDENTIFIED"),
                says_the_drive_changed(),
                no_stiffness_to_three_digits(),
            ),
        )
    ]
    effect = FRICTION[0]
    for every in EVERY:
        rows = LONG_ROWS // every
        words = "" if every == 1 else f", every {every}th row of it"
        lines.append(
            Line(
                f"long-{rows}",
                GROUP,
                f"{LONG_ROWS:,} rows of the library's own simulation{words}: friction of "
                "0.15 deg, noise 0.05 deg.",
                _answer((effect,)),
                SOURCE,
                partial(long, every=every),
                (*_right((effect,)), within_seconds(max(rows / ROWS_PER_SECOND, 30.0))),
                verdict_only=True,
            )
        )
    return lines


def made_lines() -> list[Line]:
    """Lines of all made recordings."""
    return [*_friction_lines(), *_single_lines(), *_correlated_lines(), *_other_lines()]


ALARMS = ("IDENTIFIED", "AMBIGUOUS", "MOSTLY_EXPLAINED", "UNKNOWN_PHYSICS")
"""Verdicts by which something is missing."""


def _found(outcomes: Mapping[str, Outcome]) -> tuple[bool, str]:
    """Judge how many effects were noticed under correlated noise."""
    count = sum(o.verdict in ALARMS for o in outcomes.values())
    return count >= POWER * len(outcomes), f"{count} of {len(outcomes)}"


def _same(outcomes: Mapping[str, Outcome]) -> tuple[bool, str]:
    """Judge whether all rows of a file and some of them get the same answer."""
    answers = {(o.verdict, o.named) for o in outcomes.values()}
    words = "; ".join(f"{name}: {o.verdict}" for name, o in outcomes.items())
    return len(answers) == 1, words


def _no_worse(outcomes: Mapping[str, Outcome]) -> tuple[bool, str]:
    """Judge whether more signal never takes a name away."""
    words, right = [], True
    for effect in LADDER:
        stem = effect.replace("_", "-")
        hits = [outcomes[f"{stem}-d{d}"].named == (effect,) for d in STEPS]
        right &= sorted(hits) == hits
        words.append(f"{effect.replace('_', ' ')} {''.join('+' if hit else '-' for hit in hits)}")
    return right, ", ".join(words)


def _fast(outcomes: Mapping[str, Outcome]) -> tuple[bool, str]:
    """Judge how long the slowest diagnosis took."""
    slowest = max(outcomes, key=lambda name: outcomes[name].seconds)
    seconds = outcomes[slowest].seconds
    return seconds <= SECONDS, f"slowest {seconds:.1f} s ({slowest})"


def made_summaries() -> list[Summary]:
    """Checks over several made recordings."""
    steps = ", ".join(map(str, STEPS))
    two = [line.name for line in _friction_lines() if not line.name.startswith("coulomb")]
    return [
        Summary(
            "two-effects-seconds",
            GROUP,
            f"3,000 rows with two effects, whole report: at most {SECONDS:g} s (processor time of "
            "one thread).",
            "the targets of the diagnosis",
            two,
            _fast,
        ),
        Summary(
            "ar97-power",
            GROUP,
            f"Autocorrelation {HIGH:g}, d = 20: at least {100 * POWER:.0f} % noticed (a test that "
            "knows the effect notices all).",
            SOURCE,
            tuple(f"ar97-{e.replace('_', '-')}" for e in CORRELATED_EFFECTS),
            _found,
        ),
        Summary(
            "more-signal-no-worse",
            GROUP,
            f"The same recording at d = {steps}: a name that was right stays (+ named alone).",
            SOURCE,
            tuple(f"{e.replace('_', '-')}-d{d}" for e in LADDER for d in STEPS),
            _no_worse,
        ),
        Summary(
            "long-same-answer",
            GROUP,
            "All rows, every tenth and every hundredth: the same verdict and names.",
            SOURCE,
            tuple(f"long-{LONG_ROWS // every}" for every in EVERY),
            _same,
        ),
    ]
