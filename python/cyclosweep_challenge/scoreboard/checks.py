"""Checks that a right answer holds, and those that every answer holds against itself."""

from __future__ import annotations

import math
import re

from cyclosweep_challenge.scoreboard.line import Check
from cyclosweep_challenge.scoreboard.outcome import FAILURE, Outcome

FRICTION = ("friction_hysteresis", "load_dependent_friction")
"""Effects that make a loop without a rate effect."""
POSITION = ("transmission_error", "phase_dependent_compliance")
"""Effects tied to the position of the mesh."""
WITHIN_NOISE = 2.0
"""Largest error over the stated noise at which a verdict may say that nothing is left [-]."""
WORSE = 1.02
"""Largest error after the repair over that before it, on readings not fitted [-]."""
THREE_DIGITS = 0.005
"""Relative standard error below which a compliance is stated to three digits [-]."""
CHANGED = r"not stationary|drive (itself )?changed|changed (between|from|while|during)|drift"
"""How a diagnosis may say that the drive changed while it was tested."""
NOT_DETERMINED = (
    r"twist is not determined|not determined by (the )?torque|torque does not (fix|determine)"
    r"|does not (fix|determine) the (twist|angle)"
)
"""How a diagnosis may say that the torque does not fix the twist."""


def verdict_in(*verdicts: str) -> Check:
    """Check that the verdict is one of some."""
    return Check(f"verdict {' or '.join(verdicts)}", lambda o: o.verdict in verdicts)


def verdict_not(*verdicts: str) -> Check:
    """Check that there is a verdict and that it is none of some."""
    return Check(
        f"verdict never {' nor '.join(verdicts)}",
        lambda o: o.verdict not in (*verdicts, FAILURE),
    )


def names(*effects: str) -> Check:
    """Check that every one of some effects is named."""
    return Check(f"names {_list(effects)}", lambda o: set(effects) <= set(o.named))


def names_one_of(*effects: str) -> Check:
    """Check that at least one of some effects is named."""
    return Check(f"names {_list(effects, 'or')}", lambda o: bool(set(effects) & set(o.named)))


def names_only(*effects: str) -> Check:
    """Check that no effect but some is named."""
    return Check(f"no name but {_list(effects)}", lambda o: set(o.named) <= set(effects))


def names_nothing() -> Check:
    """Check that no effect is named."""
    return Check("no effect named", lambda o: not o.named)


def explains(share: float) -> Check:
    """Check that the stated share of the mismatch that is explained is large enough."""
    return Check(
        f"explains at least {100 * share:.0f} % of the mismatch",
        lambda o: o.share is not None and o.share >= share,
    )


def removes(share: float) -> Check:
    """Check that the repair takes away a share of the mismatch, by the errors themselves."""
    return Check(
        f"the repair removes at least {100 * share:.0f} % of the mismatch",
        lambda o: removed(o) >= share,
    )


def removed(outcome: Outcome) -> float:
    """Share of the mean square mismatch beyond the noise that the repair removes [-]."""
    before, after = outcome.rms_calibrated_deg, outcome.rms_repaired_deg
    if before is None or after is None or not before > 0.0:
        return -math.inf
    noise = min(outcome.noise_deg or 0.0, before, after)
    if before <= noise:
        return -math.inf
    return 1.0 - (after**2 - noise**2) / (before**2 - noise**2)


def says(pattern: str, words: str) -> Check:
    """Check that the diagnosis says something, in its statement or elsewhere."""
    return Check(words, lambda o: re.search(pattern, o.text, re.IGNORECASE) is not None)


def says_the_drive_changed() -> Check:
    """Check that the diagnosis says that the drive changed while it was tested."""
    return Check(
        "says that the drive changed while it was tested",
        lambda o: o.stationary is False or re.search(CHANGED, o.statement, re.I) is not None,
    )


def no_stiffness_to_three_digits() -> Check:
    """Check that no compliance is stated as if it were known to three digits."""

    def holds(outcome: Outcome) -> bool:
        scale, error = outcome.scale_repaired, outcome.scale_error
        vague = scale is None or error is None or error >= THREE_DIGITS * abs(scale)
        return vague and re.search(r"compliance [-+]\d+\.\d %", outcome.statement) is None

    return Check("states no stiffness to three digits", holds)


def figure_at_most(name: str, most: float, words: str) -> Check:
    """Check that a figure of the line was measured and is small enough."""
    return Check(f"{words} at most {most:g}", lambda o: o.figures.get(name, math.inf) <= most)


def within_noise() -> Check:
    """Check that what the repaired model leaves is no larger than the noise may be."""
    return Check(
        f"leaves at most {WITHIN_NOISE:g} times the noise",
        lambda o: _is_noise(o.rms_repaired_deg, o),
    )


def _is_noise(error_deg: float | None, outcome: Outcome) -> bool:
    """Whether an error is known and no larger than the noise of an outcome may be [deg]."""
    if error_deg is None or outcome.noise_deg is None:
        return False
    return error_deg <= WITHIN_NOISE * outcome.noise_deg


def within_seconds(most: float) -> Check:
    """Check that the diagnosis took no longer than it may [s]."""
    return Check(f"at most {most:g} s", lambda o: o.seconds <= most)


def _agrees_with_noise(outcome: Outcome) -> bool:
    """Whether a verdict that leaves nothing open agrees with the errors it states."""
    if outcome.verdict == "NOTHING_MISSING":
        return _is_noise(outcome.rms_calibrated_deg, outcome)
    if outcome.verdict == "IDENTIFIED":
        return _is_noise(outcome.rms_repaired_deg, outcome)
    return True


def _forecasts_no_worse(outcome: Outcome) -> bool:
    """Whether the repaired model is no worse than the calibrated one on readings not fitted."""
    before, after = outcome.held_calibrated_deg, outcome.held_repaired_deg
    if not before or after is None or not outcome.named:
        return True
    return after <= WORSE * before


def _positive(outcome: Outcome) -> bool:
    """Whether no compliance is zero or below."""
    scales = (outcome.scale_calibrated, outcome.scale_repaired)
    return all(scale is None or scale > 0.0 for scale in scales)


CONSISTENT = (
    Check("there is an answer", lambda o: o.verdict != FAILURE),
    Check("no stiffness at or below zero", _positive),
    Check("nothing is said to be left only where the error is noise", _agrees_with_noise),
    Check("the repaired model forecasts no worse than the calibrated one", _forecasts_no_worse),
)
"""What every answer holds, whatever the recording."""


def _list(effects: tuple[str, ...], last: str = "and") -> str:
    """Names in a row."""
    words = [effect.replace("_", " ") for effect in effects]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}"
