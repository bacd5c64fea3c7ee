"""All hypotheses of one recording, each by columns: named effects and unnamed shapes."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cyclosweep.diagnosis.hypotheses.freeform import FreeForm, freeforms
from cyclosweep.simulation.effects import Effect, Shape
from cyclosweep.simulation.effects.history import Flags, Floats, History


@dataclass(frozen=True, eq=False)
class Signature:
    """One shape of one hypothesis: its columns among all of the library's.

    Attributes
    ----------
    hypothesis : str
        Name of the effect, or the family of the free form.
    effect : Effect or None
        The effect; None for a shape without a name.
    shape : dict
        Shape parameters of the effect.
    free : FreeForm or None
        The shape without a name.
    first, stop : int
        Columns of the signature.
    signs : ndarray
        +1 where the amplitude cannot be negative, else 0.
    scale : ndarray
        Root mean square by which each column was divided [deg].
    """

    hypothesis: str
    effect: Effect | None
    shape: Shape
    free: FreeForm | None
    first: int
    stop: int
    signs: Floats
    scale: Floats

    @property
    def named(self) -> bool:
        """Whether the signature belongs to a named effect."""
        return self.effect is not None


@dataclass(frozen=True, eq=False)
class Library:
    """Blocks and their columns on the fitted rows [deg]."""

    signatures: tuple[Signature, ...]
    columns: Floats
    untestable: dict[str, str] = field(default_factory=dict)

    def of(self, signature: Signature) -> Floats:
        """Columns of one signature."""
        return self.columns[:, signature.first : signature.stop]


def build_library(
    history: History, fitted: Flags, effects: Sequence[Effect], *, with_freeforms: bool = True
) -> Library:
    """Columns of every shape of every effect that the recording can show, and of the free forms."""
    signatures: list[Signature] = []
    parts: list[Floats] = []
    untestable: dict[str, str] = {}
    first = 0

    def add(
        name: str, effect: Effect | None, shape: Shape, free: FreeForm | None, made: Floats
    ) -> None:
        nonlocal first
        kept = made[fitted]
        if not np.all(np.isfinite(kept)) or not np.any(kept):
            return
        signs = np.zeros(kept.shape[1])
        if free is not None and free.positive:
            signs[:] = 1.0
        if effect is not None:
            lower = [p.lower for p in effect.amplitudes(shape)][: len(signs)]
            signs[: len(lower)] = np.where(np.array(lower) >= 0, 1.0, 0.0)
        scale = np.sqrt(np.mean(kept**2, axis=0))
        parts.append(np.divide(kept, scale, out=np.zeros_like(kept), where=scale > 0))
        stop = first + kept.shape[1]
        signatures.append(Signature(name, effect, dict(shape), free, first, stop, signs, scale))
        first = stop

    for effect in effects:
        reason = effect.untestable(history)
        if reason is not None:
            untestable[effect.name] = reason
            continue
        for shape in effect.shapes(history):
            add(effect.name, effect, shape, None, effect.columns(history, shape))
    if with_freeforms:
        for free in freeforms(history, fitted):
            add(free.family, None, {}, free, free.make(history))
    columns = np.column_stack(parts) if parts else np.zeros((int(fitted.sum()), 0))
    return Library(tuple(signatures), columns, untestable)
