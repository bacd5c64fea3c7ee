"""One effect, or one unnamed shape, as part of a structure that is fitted."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.hypotheses.unnamed_shapes import UnnamedShape
from cyclosweep.simulation.effects import Effect, Shape
from cyclosweep.simulation.effects.conditioning import CONDITIONING
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.order_names import travels
from cyclosweep.simulation.effects.slip import friction_limit_nm
from cyclosweep.simulation.effects.slip_start import lies_behind_play
from cyclosweep.simulation.effects.viscous_drag import holds_friction


@dataclass(frozen=True, eq=False)
class Term:
    """One effect with its shape, or one unnamed shape, in a structure.

    Attributes
    ----------
    effect : Effect or None
        The effect; None for an unnamed shape.
    shape : mapping of str to float
        Values of the parameters that enter the twist nonlinearly.
    unnamed : UnnamedShape or None
        The unnamed shape.
    amplitude : float
        Friction limit of an effect on slip elements [N m, or a share of the torque]. Amplitudes of
        all other effects enter linearly and belong to the fit.
    in_series : bool
        An elastic effect lies in series with the part that friction holds: its twist follows from
        the applied torque, not from the elastic one.
    """

    effect: Effect | None
    shape: Shape
    unnamed: UnnamedShape | None = None
    amplitude: float = 0.0
    in_series: bool = False

    @property
    def name(self) -> str:
        """Name of the effect, or family of the unnamed shape."""
        if self.effect is not None:
            return self.effect.name
        assert self.unnamed is not None
        return self.unnamed.family

    @property
    def family(self) -> str:
        """Family of effects alike, or of the unnamed shape."""
        return self.name if self.effect is None else self.effect.family

    @property
    def slips(self) -> bool:
        """Whether it is friction on slip elements."""
        return self.effect is not None and self.effect.slips

    @property
    def elastic(self) -> bool:
        """Whether it belongs to the elastic law: its twist follows from the elastic torque."""
        if self.effect is not None:
            return self.effect.elastic and not self.in_series
        return self.unnamed is not None and self.unnamed.elastic

    @property
    def is_whole_spring(self) -> bool:
        """Whether the whole drive may follow its law, so that nothing need be left of the line."""
        return self.effect is not None and self.elastic and self.effect.whole_spring in self.shape

    @property
    def lies_beyond_friction(self) -> bool:
        """Whether it turns the measured shaft without turning the part that friction holds.

        What is elastic twists that part; along the travel of the mesh the part itself turns, and
        what drag holds back it does not turn either.
        """
        is_drag = self.effect is not None and self.effect.is_drag
        lags = is_drag and holds_friction(self.shape)
        return not (self.elastic or lags or travels(self.shape))

    @property
    def place_in_words(self) -> tuple[str, ...]:
        """Sentences on where the effect lies beside friction and play, and how it began.

        None where that is usual.
        """
        if self.in_series:
            return (
                f"{self.name} follows the applied torque, not what friction leaves of it: the part "
                "that gives way lies between the friction and the load.",
            )
        found = []
        if self.slips and lies_behind_play(self.shape):
            found.append(
                f"{self.name} does not slide while the play is crossed: it lies on the other side "
                "of the play than the shaft that was measured."
            )
        if self.slips and CONDITIONING in self.shape:
            last = "negative" if self.shape[CONDITIONING] < 0.0 else "positive"
            found.append(
                f"{self.name} did not begin fresh: the drive looks as if it was loaded to and fro "
                f"before the first reading, and left from the {last} side."
            )
        return tuple(found)

    def columns(self, history: History) -> Floats:
        """Columns for unit amplitudes [deg]."""
        if self.in_series:
            history = history.under_applied_torque
        if self.effect is not None:
            return self.effect.columns(history, self.shape)
        assert self.unnamed is not None
        return self.unnamed.make(history)

    def friction_limit(self, history: History) -> Floats:
        """Limit of a friction along the path, shape (n,) [N m]."""
        assert self.effect is not None
        limits = self.effect.friction_limits(self.shape)
        load = np.abs(history.elastic_nm)
        return np.asarray(self.amplitude * friction_limit_nm(self.shape, limits, load))
