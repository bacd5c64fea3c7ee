"""Types of the dictionaries that `Diagnosis.effects` and `Diagnosis.mismatch` return."""

from typing import NotRequired, TypedDict

from cyclosweep.result.mismatch import Direction

__all__ = ["EffectContent", "MismatchContent", "ParameterContent", "RegionContent", "SizeContent"]


class ParameterContent(TypedDict):
    """One fitted parameter of an effect; see :class:`cyclosweep.result.EffectParameter`."""

    estimate: float
    std_error: float | None
    unit: str
    meaning: str


class SizeContent(TypedDict):
    """Largest twist of an effect [deg]; see :class:`cyclosweep.result.Size`."""

    estimate: float
    ci95: list[float]


class EffectContent(TypedDict):
    """An effect that was accepted by name; see :class:`cyclosweep.result.FoundEffect`."""

    name: str
    physics: str
    source: str
    parameters: dict[str, ParameterContent]
    size_deg: SizeContent
    size_arcmin: float | None
    size_nm: float | None
    reached_nm: NotRequired[float]
    rms_deg: float | None
    p_value: float | None
    e_value: float | None
    detectability: float | None


class RegionContent(TypedDict):
    """A part of a recording whose residual is no noise; see :class:`cyclosweep.result.Region`."""

    torque_nm: list[float] | None
    direction: Direction | None
    run: list[int] | None
    time_s: list[float] | None
    readings: NotRequired[list[int]]
    crank_deg: list[float] | None
    temperature_c: list[float] | None
    repaired: bool
    mean_residual_deg: float
    share_of_excess: float | None
    p_value: float | None


class MismatchContent(TypedDict):
    """Global test and the regions that differ; see :class:`cyclosweep.result.Mismatch`."""

    p_value: float | None
    evidence: float | None
    threshold: float | None
    regions: list[RegionContent]
