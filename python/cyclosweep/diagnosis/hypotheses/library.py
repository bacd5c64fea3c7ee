"""All hypotheses of one recording as columns of twist: effects by name and unnamed shapes."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.hypotheses.unnamed_shapes import UnnamedShape, unnamed_shapes
from cyclosweep.simulation.effects import Effect, Shape
from cyclosweep.simulation.effects.history import Flags, Floats, History, Ints


@dataclass(frozen=True, eq=False)
class Signature:
    """One shape of one hypothesis, and where its columns stand among all of the library's.

    Attributes
    ----------
    hypothesis : str
        Name of the effect, or family of the unnamed shape.
    effect : Effect or None
        The effect; None for an unnamed shape.
    shape : dict
        Shape parameters of the effect.
    unnamed : UnnamedShape or None
        The unnamed shape; None for an effect.
    first, stop : int
        First column, and the one after the last.
    signs : ndarray, shape (stop - first,)
        +1 where the amplitude cannot be negative, else 0.
    scale : ndarray, shape (stop - first,)
        Root mean square by which each column was divided [deg].
    """

    hypothesis: str
    effect: Effect | None
    shape: Shape
    unnamed: UnnamedShape | None
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
    """Signatures of all hypotheses, and their columns.

    Attributes
    ----------
    signatures : tuple of Signature
        In the order of their columns.
    columns : ndarray, shape (fitted, k)
        Twist on the fitted rows, each column divided by its root mean square.
    untestable : dict of str to str
        Effects that the recording cannot show, each with the reason.
    unbounded : dict of str to str
        Effects that it may show, but of which it gives no upper bound, each with the reason.
    """

    signatures: tuple[Signature, ...]
    columns: Floats
    untestable: dict[str, str]
    unbounded: dict[str, str] = field(default_factory=dict)

    @cached_property
    def single(self) -> tuple[Ints, Ints, Floats]:
        """Index, column and sign of every signature of one column."""
        found = [(k, s) for k, s in enumerate(self.signatures) if s.stop - s.first == 1]
        return (
            np.array([k for k, _ in found], dtype=np.int64),
            np.array([s.first for _, s in found], dtype=np.int64),
            np.array([s.signs[0] for _, s in found], dtype=np.float64),
        )

    @cached_property
    def several(self) -> tuple[int, ...]:
        """Indices of the signatures of several columns."""
        return tuple(k for k, s in enumerate(self.signatures) if s.stop - s.first != 1)

    @cached_property
    def effects(self) -> dict[str, Signature]:
        """First signature of every effect that the recording can show, by name."""
        found: dict[str, Signature] = {}
        for signature in self.signatures:
            if signature.named:
                found.setdefault(signature.hypothesis, signature)
        return found


def build_library(history: History, fitted: Flags, effects: Sequence[Effect]) -> Library:
    """Columns of every shape of every effect that the recording can show, and of unnamed shapes.

    Parameters
    ----------
    history : History
        All n rows of the recording.
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.
    effects : sequence of Effect
        Effects that are considered.

    Returns
    -------
    Library
    """
    signatures: list[Signature] = []
    parts: list[Floats] = []
    untestable: dict[str, str] = {}
    unbounded: dict[str, str] = {}

    def add(
        name: str,
        made: Floats,
        signs: Floats,
        effect: Effect | None = None,
        shape: Shape | None = None,
        unnamed: UnnamedShape | None = None,
    ) -> None:
        """Add the columns of one shape, unless the fitted rows show nothing of them.

        Parameters
        ----------
        name : str
            Name of the hypothesis.
        made : ndarray, shape (n, k)
            Twist for unit amplitudes [deg].
        signs : ndarray, shape (k,)
            +1 where the amplitude cannot be negative, else 0.
        effect, shape, unnamed : optional
            As in `Signature`.
        """
        kept = made[fitted]
        if not np.all(np.isfinite(kept)) or not np.any(kept):
            return
        scale = np.sqrt(np.mean(kept**2, axis=0))
        parts.append(np.divide(kept, scale, out=np.zeros_like(kept), where=scale > 0))
        first = signatures[-1].stop if signatures else 0
        stop = first + kept.shape[1]
        values = dict(shape or {})
        signatures.append(Signature(name, effect, values, unnamed, first, stop, signs, scale))

    for effect in effects:
        reason = effect.untestable(history)
        if reason is not None:
            untestable[effect.name] = reason
            continue
        reason = effect.unbounded(history)
        if reason is not None:
            unbounded[effect.name] = reason
        for shape in effect.shapes(history):
            made = effect.columns(history, shape)
            add(effect.name, made, _signs(effect, shape, made.shape[1]), effect, shape)
    for unnamed in unnamed_shapes(history, fitted):
        made = unnamed.make(history)
        signs = np.full(made.shape[1], 1.0 if unnamed.positive else 0.0)
        add(unnamed.family, made, signs, unnamed=unnamed)
    columns = np.column_stack(parts) if parts else np.zeros((int(fitted.sum()), 0))
    return Library(tuple(signatures), columns, untestable, unbounded)


def _signs(effect: Effect, shape: Shape, count: int) -> Floats:
    """+1 for each amplitude that cannot be negative, else 0.

    Parameters
    ----------
    effect : Effect
    shape : mapping of str to float
        Shape parameters.
    count : int
        Number of columns.

    Returns
    -------
    ndarray, shape (count,)
    """
    signs = np.zeros(count)
    lower = [parameter.lower for parameter in effect.amplitudes(shape)][:count]
    signs[: len(lower)] = np.where(np.array(lower) >= 0, 1.0, 0.0)
    return signs
