"""Check of an answer against itself: statements in it that cannot both hold."""

from collections.abc import Iterator
from dataclasses import dataclass

from cyclosweep.result.answer import Answer
from cyclosweep.result.calibration_words import is_hidden_by_friction

LEVEL = 0.05
"""Probability below which an interval of 95 % cannot hold zero."""
ROUNDING = 1e-6
"""Share by which parts of a whole may exceed it in floating point."""
NONE_NEEDED = "none needed"
"""Next experiment where everything is known that was asked."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """Ranges that were recorded.

    Attributes
    ----------
    angle_deg, torque_nm : float
        From the least to the largest reading [deg], [N m].
    """

    angle_deg: float
    torque_nm: float


def contradictions(answer: Answer, recorded: Recorded | None = None) -> tuple[str, ...]:
    """List the statements of an answer that contradict each other; none in a sound answer.

    Parameters
    ----------
    answer : Answer
        The whole answer of a diagnosis.
    recorded : Recorded, optional
        Ranges of the recording, which no effect exceeds.

    Returns
    -------
    tuple of str
        One sentence each.

    Examples
    --------
    >>> contradictions(Answer(verdict="NOTHING_MISSING"))
    ()
    """
    return (
        *_of_effects(answer),
        *_of_sizes(answer, recorded),
        *_of_regions(answer),
        *_of_remainder(answer),
        *_of_play(answer),
        *_of_next_experiment(answer),
    )


def _of_effects(answer: Answer) -> Iterator[str]:
    """Effects that are found and not found, or certain and perhaps zero."""
    named = {effect.name for effect in answer.effects}
    if named and answer.verdict == "NOTHING_MISSING":
        yield "nothing is missing, and effects are named"
    for bound in (*answer.ruled_out, *answer.undecided):
        if bound.name in named:
            yield f"{bound.name} is named, and stands among what was not found"
    for effect in answer.effects:
        zero = effect.size_deg.ci95[0] <= 0.0
        if zero and effect.p_value is not None and effect.p_value < LEVEL:
            yield (
                f"the interval of {effect.name} holds zero, and its probability by chance is "
                f"{effect.p_value:.2g}"
            )


def _of_sizes(answer: Answer, recorded: Recorded | None) -> Iterator[str]:
    """Effects that turn the shaft by more than it turned, and take more torque than there was.

    A friction that takes most of the torque holds back more twist than is left to be seen: it is
    within the torque.
    """
    if recorded is None:
        return
    for effect in answer.effects:
        size, torque = effect.size_deg.estimate, effect.size_nm
        within_torque = torque is not None and abs(torque) <= recorded.torque_nm
        if size > recorded.angle_deg and not within_torque:
            yield (
                f"{effect.name} has a size of {size:.3g} deg, and all of the recording lies within "
                f"{recorded.angle_deg:.3g} deg"
            )


def _of_regions(answer: Answer) -> Iterator[str]:
    """Places that together are more than all of the misfit."""
    shares = [region.share_of_excess or 0.0 for region in answer.mismatch.regions]
    if sum(shares) > 1.0 + ROUNDING:
        yield f"the places of the mismatch make up {100 * sum(shares):.0f} % of it"


def _of_remainder(answer: Answer) -> Iterator[str]:
    """More than there was, or steps that repeat in one sentence and do not in another."""
    steps = [finding.text for finding in answer.findings if finding.topic == "staircase"]
    repeated = any("repeat at the same positions" in text for text in steps)
    rest = answer.unknown
    if rest is None:
        return
    before = answer.baseline.rmse_deg
    all_of_it = rest.measure == "root mean square"
    if all_of_it and before is not None and rest.size_deg > before * (1.0 + ROUNDING):
        yield (
            f"what is left, {rest.size_deg:.3g} deg, is more than the calibrated model misses, "
            f"{before:.3g} deg"
        )
    if repeated and rest.shape == "misfit of the model":
        yield f"steps repeat at the same positions, and a misfit remains {rest.place}"


def _of_play(answer: Answer) -> Iterator[str]:
    """Play or stiffness that is given in one place and refused in another."""
    read = answer.play_and_stiffness
    if read is None:
        return
    for topic, value in (
        ("play", read.free_play_deg),
        ("stiffness", read.stiffness_at_output_nm_per_arcmin),
    ):
        if value is not None and is_hidden_by_friction(answer.findings, topic):
            yield f"the {topic} is given, and friction is said to hide it"


def _of_next_experiment(answer: Answer) -> Iterator[str]:
    """An experiment to show what is named, or none where something is open."""
    plan = answer.next_experiment
    if plan is None:
        return
    named = {effect.name for effect in answer.effects}
    if len(plan.separates) == 1 and plan.separates[0] in named:
        yield f"the next experiment is to show {plan.separates[0]}, which is named already"
    if plan.program == NONE_NEEDED and (answer.plausibility or answer.unknown is not None):
        yield "no experiment is needed, and something is to be checked or remains without a name"
