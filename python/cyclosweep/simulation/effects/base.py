"""What every effect is: physics in words, its parameters, and its response to a load history."""

from collections.abc import Sequence
from typing import ClassVar

from cyclosweep.simulation.effects.bounds import within_load, within_recording
from cyclosweep.simulation.effects.former_names import FormerNames
from cyclosweep.simulation.effects.history import Flags, Floats, History
from cyclosweep.simulation.effects.parameters import (
    Parameter,
    Shape,
    ShapeForm,
    in_form,
    listed,
    spread,
)
from cyclosweep.simulation.effects.slip_elements import Elements, elements_of

__all__ = ["Effect", "Parameter", "Shape", "ShapeForm", "listed", "spread"]

COLUMNS = {"time_s": "a clock", "crank_deg": "the mesh position", "temperature_c": "a temperature"}
"""What an effect may need of a recording, in words."""


class Effect(FormerNames):
    """A kind of physics that the published model leaves out.

    A subclass states the physics and gives its response as columns that enter the twist linearly,
    for any value of the shape parameters. Registering an instance with
    `cyclosweep.simulation.effects.register` is all it takes to have a new effect diagnosed.

    Attributes
    ----------
    name, physics, source, tell_tale : str
        Name in the vocabulary; two sentences; literature; what betrays it in a recording.
    family : str
        Class of look-alikes, named in the report where the recording cannot go further.
    needs : tuple of str
        Columns without which the effect cannot be tested.
    shown_by : str
        What a programme has to have so that the effect shows.
    shape_parameters : tuple of Parameter
        Parameters that enter nonlinearly and are refined by the fit.
    forms : tuple of ShapeForm
        What a shape may consist of, by which a shape in a file is checked. An effect that states
        none takes any, and all its shape parameters have to be there.
    slips : bool
        The effect is a friction torque on slip elements, solved in the angle; such an effect
        derives from `cyclosweep.simulation.effects.slip.FrictionEffect`.
    elastic : bool
        The twist is a function of the elastic torque alone: part of the drive's elastic law.
    is_drag : bool
        The twist is what a drag torque takes from the elastic parts: its columns are minus the drag
        times `History.drag_compliance`.
    dense : bool
        The grid of shapes is their prior: they weigh the same, and the evidence is averaged.
    vector : bool
        The amplitudes are the components of one vector of unknown direction.
    whole_spring : str
        Shape parameter of a law that the whole drive may follow, with no line beside it.
    """

    name: ClassVar[str]
    physics: ClassVar[str]
    source: ClassVar[str]
    tell_tale: ClassVar[str]
    family: ClassVar[str]
    needs: ClassVar[tuple[str, ...]] = ()
    shown_by: ClassVar[str] = "another programme"
    shape_parameters: ClassVar[tuple[Parameter, ...]] = ()
    forms: ClassVar[tuple[ShapeForm, ...]] = ()
    slips: ClassVar[bool] = False
    elastic: ClassVar[bool] = False
    is_drag: ClassVar[bool] = False
    dense: ClassVar[bool] = False
    vector: ClassVar[bool] = False
    whole_spring: ClassVar[str] = ""

    def shapes(self, history: History) -> Sequence[Shape]:
        """Grid of shapes over which the effect is looked for in this recording."""
        raise NotImplementedError

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist for unit amplitudes [deg], one column an amplitude.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.

        Returns
        -------
        ndarray, shape (n, k)
        """
        raise NotImplementedError

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Parameters that multiply the columns, with their signs as bounds."""
        raise NotImplementedError

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Shape parameter with bounds as narrow as the recording allows.

        Parameters
        ----------
        parameter : Parameter
            One of ``shape_parameters``.
        history : History
            Load history of the recording.

        Returns
        -------
        Parameter
            The same with other bounds.
        """
        return within_recording(parameter, history)

    def amplitude_bounds(self, history: History, shape: Shape) -> tuple[Parameter, ...]:
        """Amplitudes with bounds as narrow as the recording allows.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.

        Returns
        -------
        tuple of Parameter
        """
        amplitudes = self.amplitudes(shape)
        if not self.slips:
            return amplitudes
        return within_load(amplitudes, self.friction_limits(shape), history)

    def friction_limits(self, shape: Shape) -> tuple[float, float]:
        """Limit of a friction of unit amplitude, for effects that slip.

        Parameters
        ----------
        shape : mapping
            Shape of the effect.

        Returns
        -------
        tuple of float
            Limit without load [N m], and in proportion to the transmitted torque.
        """
        return 1.0, 0.0

    def slip_elements(self, shape: Shape) -> Elements:
        """Slip elements of a friction, for effects that slip: presliding distances and shares."""
        return elements_of(shape)

    def far_apart(self, shape: Shape, other: Shape) -> bool:
        """Whether two shapes of the grid are so unlike that a fit is started from both.

        Parameters
        ----------
        shape : mapping
            Shape of the effect.
        other : mapping
            Shape with which another fit starts.

        Returns
        -------
        bool
        """
        return False

    def usual_start(
        self, history: History, limit_share: float, slip_share: float
    ) -> tuple[Shape, float] | None:
        """Where a fit of whole loops starts, for effects that such loops usually show.

        Parameters
        ----------
        history : History
            Load history of the recording.
        limit_share : float
            Friction limit to start from, over the largest torque.
        slip_share : float
            Presliding distance to start from, over the largest elastic twist.

        Returns
        -------
        tuple of shape and amplitude, or None
            None for an effect that is looked for only in what the usual ones leave.
        """
        return None

    def known_shape(self, shape: Shape) -> Shape:
        """Return a shape with its parameters in the effect's own order.

        Parameters
        ----------
        shape : mapping
            Shape parameters by name, in any order.

        Returns
        -------
        mapping

        Raises
        ------
        InputError
            A shape parameter is unknown or missing.
        """
        own = tuple(parameter.name for parameter in self.shape_parameters)
        others = tuple(name for name in shape if name not in own)
        return in_form(shape, self.forms or (ShapeForm(own, others),))

    def fewer_amplitudes(self, shape: Shape) -> bool:
        """Whether a model may hold only the first of the amplitudes that the shape names."""
        return False

    def variants(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Shapes alike at first sight, between which only a joint fit decides.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.

        Returns
        -------
        sequence of mapping
            The shape itself is one of them.
        """
        return [shape]

    def refinements(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Shapes unlike that of an accepted effect in one respect, to be tried in its place.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Fitted shape.

        Returns
        -------
        sequence of mapping
        """
        return self.variants(history, shape)

    def penalty(self, shape: Shape) -> float:
        """Log prior odds against a shape so free that it holds other effects whole [nat]."""
        return 0.0

    def expected(self, history: History, shape: Shape) -> Floats | None:
        """Prior size of amplitudes, for those that the recording leaves open.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.

        Returns
        -------
        ndarray, shape (k,), or None
            None where nothing is expected.
        """
        return None

    def portable(
        self, history: History, shape: Shape, amplitudes: Floats
    ) -> tuple[Shape, Sequence[float]]:
        """Shape and amplitudes by which another programme can be predicted.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.
        amplitudes : ndarray, shape (k,)
            Fitted amplitudes, each in its own unit.

        Returns
        -------
        shape, amplitudes : mapping and sequence of float
        """
        return shape, amplitudes.tolist()

    def consistent(self, history: History, shape: Shape, amplitudes: Floats) -> Shape:
        """Shape in which what follows from the amplitudes agrees with them.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.
        amplitudes : ndarray, shape (k,)
            Fitted amplitudes, each in its own unit.

        Returns
        -------
        mapping
        """
        return shape

    def is_recognised(self, history: History, shape: Shape, amplitudes: Floats) -> bool:
        """Whether what was found is this effect's own, and not just any shape of its class.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Shape of the effect.
        amplitudes : ndarray, shape (k,)
            Fitted amplitudes, each in its own unit.

        Returns
        -------
        bool
        """
        return True

    def found_law(self, history: History, shape: Shape, amplitudes: Floats) -> str:
        """Sentence on which of several laws of the effect was found; empty for one law.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Fitted shape.
        amplitudes : ndarray, shape (k,)
            Fitted amplitudes.
        """
        return ""

    def notes(self, history: History, shape: Shape, amplitudes: Floats) -> tuple[str, ...]:
        """Sentences that a user of the repaired model should know.

        Parameters
        ----------
        history : History
            Load history of the recording.
        shape : mapping
            Fitted shape.
        amplitudes : ndarray, shape (k,)
            Fitted amplitudes.
        """
        return ()

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Shape with what a search found besides it.

        Parameters
        ----------
        shape : mapping
            Shape of the effect.
        found : mapping
            Shape that explains more of what is left.

        Returns
        -------
        mapping or None
            None where the effect cannot hold both.
        """
        return None

    def reduced(self, shape: Shape, wrong: Flags) -> Shape | None:
        """Shape without the parts whose amplitudes have the wrong sign.

        Parameters
        ----------
        shape : mapping
            Shape of the effect.
        wrong : ndarray of bool, shape (k,)
            Amplitudes that lie outside their bounds.

        Returns
        -------
        mapping or None
            None if no part is left.
        """
        return None

    def unbounded(self, history: History) -> str | None:
        """Reason why no upper bound can be given of an effect that is looked for; else None."""

    def untestable(self, history: History) -> str | None:
        """Reason why this recording cannot show the effect; None where it can."""
        for column in self.needs:
            if getattr(history, column) is None:
                return f"the recording has no {column}: it needs {COLUMNS.get(column, column)}"
        return None
