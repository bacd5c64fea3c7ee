"""Effects that were found, the explanations they form, and what was not found or cannot be."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from cyclosweep.result.part import LEFT_OUT, Part

Measure = Literal["largest twist", "root mean square"]
"""What the size of something without a name is."""
LIMIT_REACHED = 0.9
"""Share of the limit of a friction from which it is reached: the law of the slip elements comes
close to its limit only where nearly all of them slide."""
Outcome = Literal["accepted", "ruled out", "undecided", "not testable"]
"""How an effect of the library fared."""


def is_reached(reached_nm: float, limit_nm: float) -> bool:
    """Whether a recording shows the limit of a friction, or the law is extrapolated to it.

    Parameters
    ----------
    reached_nm : float
        Largest friction torque along the fitted path [N m].
    limit_nm : float
        Limit of the law [N m].

    Returns
    -------
    bool

    Examples
    --------
    >>> is_reached(3.8, 5.3)
    False
    """
    return reached_nm >= LIMIT_REACHED * limit_nm


@dataclass(frozen=True, kw_only=True, slots=True)
class EffectParameter(Part):
    """One fitted parameter of an effect."""

    estimate: float
    """Value that fits the recording."""
    std_error: float | None = None
    """Standard error of the estimate; null where the recording does not determine it."""
    unit: str = ""
    """Unit of estimate and standard error."""
    meaning: str = ""
    """What the parameter is."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Size(Part):
    """Largest twist of an effect after stiffness, play and datum are calibrated again [deg]."""

    estimate: float
    """Best estimate [deg]."""
    ci95: tuple[float, float]
    """Interval that holds the size with 95 % confidence [deg]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FoundEffect(Part):
    """An effect that was accepted by name."""

    name: str
    """Name in the vocabulary of effects."""
    physics: str = ""
    """What goes on in the drive."""
    source: str = ""
    """Publication that describes it."""
    parameters: Mapping[str, EffectParameter] = field(default_factory=dict)
    """Fitted parameters by name."""
    size_deg: Size
    """Largest twist that it adds [deg]."""
    size_arcmin: float | None = None
    """The same [arcmin]."""
    size_nm: float | None = None
    """Torque that would twist the calibrated drive as far [N m]."""
    reached_nm: float | None = field(default=None, metadata=LEFT_OUT)
    """Largest torque that it takes along the fitted path, where it is a friction; less than the
    limit of its law where the recording does not make all of it slide [N m]."""
    rms_deg: float | None = None
    """Root mean square of its twist over the fitted data [deg]."""
    p_value: float | None = None
    """Probability of as much evidence where it is absent."""
    e_value: float | None = None
    """Evidence from data not used for the choice; 100 is strong, null where there are none."""
    detectability: float | None = None
    """Signal-to-noise ratio, calibration and all other effects taken out."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Explanation(Part):
    """A set of causes that explains the recording, with its probability."""

    effects: tuple[str, ...] = ()
    """Effects of the vocabulary."""
    without_name: tuple[str, ...] = ()
    """Shapes beside them that belong to no effect of the vocabulary."""
    probability: float
    """Probability among the explanations that were considered."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bound(Part):
    """How large an effect that was not found can be at most."""

    name: str
    """Name in the vocabulary of effects."""
    upper95_deg: float
    """95 % upper bound of its size after calibration [deg]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Untestable(Part):
    """Something that the recording cannot show, and what would show it."""

    name: str
    """Effect or property of the rig."""
    reason: str = ""
    """Why it cannot be seen."""
    needs: str = ""
    """What would show it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Remainder(Part):
    """What is missing from the model and belongs to no effect of the vocabulary."""

    shape: str
    """What it looks like."""
    place: str = ""
    """Where it is."""
    size_deg: float
    """How large it is, by `measure` [deg]."""
    measure: Measure | None = field(default=None, metadata=LEFT_OUT)
    """Which measure `size_deg` is: ``largest twist`` of its shape, or ``root mean square`` of all
    that the model misses, as the errors of fits are; absent where the shape says it, as a step."""


@dataclass(frozen=True, kw_only=True, slots=True)
class BehaviourClass(Part):
    """A class of behaviour that the recording shows, whatever law is behind it."""

    behaviour: str
    """What the twist looks like."""
    laws: tuple[str, ...] = ()
    """Effects whose laws stand for it and are named; empty where no law of the vocabulary does."""
    missed_share: float | None = None
    """What these laws miss inside the class over what both explain, as root mean squares."""
    visibility: float | None = None
    """Signal-to-noise ratio of what no named law explains of it; null where laws stand for it."""
    stand_ins: tuple[str, ...] = ()
    """Effects by which the repaired model represents it, which are not named."""
    candidates: tuple[str, ...] = ()
    """Effects of the vocabulary of this class that were not named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """One effect of the library: whether it was accepted, and its size or how large it could be.

    Attributes
    ----------
    name : str
        Name in the vocabulary of effects.
    outcome : str
        ``accepted``, ``ruled out``, ``undecided`` or ``not testable``.
    absorbed_share : float or None
        Share of its signature that a refitted baseline hides.
    size_deg, ci95_deg : float, (float, float), or None
        Size of the effect [deg] and its 95 % interval.
    p_value, e_value : float or None
        Evidence of the scan and of the held-out data.
    smallest_detectable_deg : float or None
        Size that this recording would show [deg].
    """

    name: str
    outcome: Outcome
    absorbed_share: float | None = None
    size_deg: float | None = None
    ci95_deg: tuple[float, float] | None = None
    p_value: float | None = None
    e_value: float | None = None
    smallest_detectable_deg: float | None = None
