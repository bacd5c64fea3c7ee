"""Results of a drive as a function of some of its inputs, on arrays, as an optimiser calls it."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive
from cyclosweep.design.parts import Engine
from cyclosweep.errors import InputError, did_you_mean, names_of, one_of
from cyclosweep.sweep.axes import WHOLE, known_input
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Study

__all__ = ["Evaluator"]

Reals = npt.NDArray[np.float64]


class Evaluator:
    """Some results of a drive as a function of some of its inputs.

    One design takes about 25 us, 50 with results of the component model, and a thousand together
    less than 0.1 ms: no :class:`~cyclosweep.Drive` is made for them. Can be pickled, for optimisers
    that work in several processes.

    Parameters
    ----------
    drive : Drive
        What does not vary.
    inputs : sequence of str
        Inputs that vary, in the order of the arguments' columns; each an axis of a study but
        ``criterion``.
    outputs : str or sequence of str
        Results, in the order of the values' columns; one name alone gives values without that
        dimension. Results of the component model are among them, those of the torsional train are
        not.
    loads_tn : sequence of float, optional
        Loads [T_N] at which twists are computed; 1, 2, 3, 4 and 4.5 by default.
    solver : {"quadratic", "full"}
        How the component model finds its equilibria.

    Raises
    ------
    InputError
        For an unknown input, result or solver, or no input or result.

    Examples
    --------
    >>> twist = Evaluator(Drive.reference_87(), ["output_pin_diameter_mm"], "twist_1tn_deg")
    >>> round(twist([16.0]), 1)
    47.8
    >>> twist([[14.0], [16.0], [90.0]]).round(1)
    array([51.6, 47.8,  nan])
    """

    def __init__(
        self,
        drive: Drive,
        inputs: Sequence[str],
        outputs: str | Sequence[str],
        *,
        loads_tn: Sequence[float] | None = None,
        solver: Engine = "quadratic",
    ) -> None:
        if not isinstance(drive, Drive):
            raise InputError(f"drive: found {drive!r}, expected a Drive")
        self.drive = drive
        self.inputs = names_of("inputs", inputs)
        self.outputs = names_of("outputs", outputs, or_one=True)
        self._alone = isinstance(outputs, str)
        self._solver: Engine = one_of("solver", solver, get_args(Engine))
        for name in self.inputs:
            if known_input(drive, name) == "criterion":
                raise InputError("criterion: found as an input, expected drive.replace(criterion=)")
        point = Space.grid(drive, **{name: [1.0] for name in self.inputs})
        study = Study.of(point, loads_tn=loads_tn, model="components")
        self._loads = study.loads_tn
        known = dict(_core.output_table(list(self._loads)))
        for name in self.outputs:
            if name not in known and name not in _PARTS:
                hint = did_you_mean(name, [*known, *_PARTS])
                raise InputError(f"outputs: no result {name!r} of a design{hint}")
        self._of_parts = [name for name in self.outputs if name in _PARTS]
        self._published = [name for name in self.outputs if name not in _PARTS]
        self._order = [[*self._published, *self._of_parts].index(name) for name in self.outputs]
        self._base = [item for item in drive.values().items() if item[0] not in self.inputs]
        self._kinds = [segment.kind for segment in drive.shaft]
        self._statuses = study.statuses

    def __call__(self, x: npt.ArrayLike) -> Any:
        """Compute the results of one design or of many.

        Parameters
        ----------
        x : array_like, shape (inputs,) or (designs, inputs)
            Values of the inputs, each in its own unit.

        Returns
        -------
        ndarray, shape (outputs,) or (designs, outputs)
            Results in their units; NaN for a design that cannot be built, and where a result does
            not apply. Of a single output without the last dimension: a float for one design.

        Raises
        ------
        InputError
            For values that are no numbers or not one for each input.
        """
        designs, single = self._designs(x)
        values = self._evaluated(designs)[1][self._order].T
        if self._alone:
            return float(values[0, 0]) if single else values[:, 0]
        return values[0] if single else values

    def status(self, x: npt.ArrayLike) -> Any:
        """Whether designs can be built: ``ok``, or the reason as in the column ``status``.

        Parameters
        ----------
        x : array_like, shape (inputs,) or (designs, inputs)
            Values of the inputs.

        Returns
        -------
        str or list of str
        """
        designs, single = self._designs(x)
        found = [self._statuses[code] for code in self._evaluated(designs)[0]]
        return found[0] if single else found

    def drive_at(self, x: npt.ArrayLike) -> Drive:
        """Return the drive of one design.

        Parameters
        ----------
        x : array_like, shape (inputs,)
            Values of the inputs; those of counts are rounded to whole numbers.

        Returns
        -------
        Drive

        Raises
        ------
        InputError
            For a value that is not allowed.
        """
        designs, single = self._designs(x)
        if not single:
            raise InputError(f"drive_at: found {len(designs)} designs, expected one")
        values = zip(self.inputs, designs[0].tolist(), strict=True)
        return self.drive.replace(**{n: round(v) if n in WHOLE else v for n, v in values})

    def __repr__(self) -> str:
        return (
            f"<Evaluator of {self.drive.name}: {', '.join(self.outputs)} of "
            f"{', '.join(self.inputs)}>"
        )

    def __getstate__(self) -> dict[str, Any]:
        return {key: value for key, value in self.__dict__.items() if key != "_part_core"}

    @functools.cached_property
    def _part_core(self) -> _core.PartStudy:
        """The core's component model; made on first use and never pickled."""
        return self.drive.part_study(self._solver)

    def _designs(self, x: npt.ArrayLike) -> tuple[Reals, bool]:
        """Designs as rows, and whether there was one alone."""
        try:
            given = np.asarray(x, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"x: found {x!r}, expected numbers") from None
        single = given.ndim == 1
        designs = given[None, :] if single else given
        if designs.ndim == 2 and not len(designs):
            raise InputError(f"x: found no designs, shape {given.shape}, expected at least one")
        if designs.ndim != 2 or designs.shape[1] != len(self.inputs):
            raise InputError(
                f"x: found shape {given.shape}, expected ({len(self.inputs)},) or "
                f"(designs, {len(self.inputs)}): {', '.join(self.inputs)}"
            )
        return designs, single

    def _evaluated(self, designs: Reals) -> tuple[npt.NDArray[np.uint8], Reals]:
        """Statuses, and results of the published model before those of the component model."""
        count = len(designs)
        columns = np.ascontiguousarray(designs.T)
        axes = [(name, "list", column) for name, column in zip(self.inputs, columns, strict=True)]
        study = _core.Study(self._base, self._kinds, axes, "table", count, 0, list(self._loads), [])
        status, any_refused, values = study.evaluate_range(0, count, self._published)
        if self._of_parts:
            status, any_refused, solved = self._part_core.evaluate_range(
                study, 0, count, self._of_parts
            )
            values = np.concatenate([values, solved])
        if any_refused:
            values[:, status != 0] = np.nan
        return status, values


_PARTS = frozenset(name for name, kind in _core.part_output_table() if kind != "solver")
"""Results of the component model that are numbers."""
