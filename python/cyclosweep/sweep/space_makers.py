"""Spaces made for a purpose: about one drive, for Sobol indices, from and to SALib."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Self, cast

from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import whole_number
from cyclosweep.errors import InputError
from cyclosweep.sweep.salib_problem import distributions_of, problem_of
from cyclosweep.sweep.tolerances import Tolerances, pieces

if TYPE_CHECKING:
    from cyclosweep.sweep.axes import Axis

__all__ = ["SpaceMakers"]


class SpaceMakers:
    """What :class:`~cyclosweep.sweep.space.Space` offers besides its sampling methods."""

    axes: tuple[Axis, ...]

    @classmethod
    def around(
        cls,
        drive: Drive,
        tolerances: Tolerances | Mapping[str, Any] | None = None,
        count: int = 1024,
        /,
        *,
        seed: int = 0,
        **deviations: Any,
    ) -> Self:
        """Pieces of one drive as manufacturing makes them, each within the tolerances.

        Parameters
        ----------
        drive : Drive
            The drive as drawn.
        tolerances : Tolerances or mapping, optional
            For each input how far it deviates: ``0.01`` for anything within +-0.01, a pair
            ``(low, high)``, or a distribution of deviations as ``normal(sd=0.004)``; a
            log-uniform one is a factor. :class:`~cyclosweep.sweep.tolerances.Tolerances` has
            batches, too.
        count : int
            Number of pieces, up to 2^32; a power of two of them is balanced best.
        seed : int
            Seed of the draws.
        **deviations
            The same by keyword, instead of a mapping: ``eccentricity_mm=0.01``.

        Raises
        ------
        InputError
            For an unknown input, one that the drive has no value of, a whole number, or
            tolerances given both ways or neither.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> made = cs.Space.around(cs.Drive.reference_87(), {"eccentricity_mm": 0.01}, 64)
        >>> values = cs.sweep(made)["eccentricity_mm"]
        >>> round(values.min(), 3), round(values.max(), 3)
        (0.61, 0.63)
        """
        if (tolerances is None) == (not deviations):
            raise InputError("tolerances: expected a mapping, or keywords, one of the two")
        make: Any = cls
        allowed = deviations if tolerances is None else tolerances
        return cast(Self, make.table(drive, pieces(drive, allowed, count, seed=seed)))

    @classmethod
    def saltelli(cls, drive: Drive, count: int, /, *, seed: int = 0, **axes: Any) -> Self:
        """Points for first-order and total Sobol indices of d inputs, (d + 2) for each draw.

        Parameters
        ----------
        drive : Drive
            What does not vary.
        count : int
            Number of draws; a power of two is balanced best.
        seed : int
            Seed of the scrambling.
        **axes
            Up to 64, as for :meth:`~cyclosweep.sweep.space.Space.sobol`.

        Raises
        ------
        InputError
            As for :meth:`~cyclosweep.sweep.space.Space.sobol`.

        Notes
        -----
        In SALib's order without second-order indices: a point, the point with one input of
        another point for each input in turn, the other point [1]_. A larger count adds draws and
        keeps those that are there.

        .. [1] A. Saltelli, "Making best use of model evaluations to compute sensitivity
           indices", Comput. Phys. Commun. 145 (2002), doi:10.1016/S0010-4655(02)00280-1.
        """
        count = whole_number("count", count, least=1)
        make: Any = cls
        return cast(Self, make._sampled(drive, "saltelli", count * (len(axes) + 2), seed, axes))

    @classmethod
    def from_salib(
        cls,
        drive: Drive,
        problem: Mapping[str, Any],
        count: int,
        /,
        *,
        method: str = "sobol",
        seed: int = 0,
    ) -> Self:
        """Points of a problem as SALib describes one.

        Parameters
        ----------
        drive : Drive
            What does not vary.
        problem : mapping
            SALib's ``num_vars``, ``names``, ``bounds`` and ``dists``; names are inputs.
        count : int
            Number of variants; of draws for the method ``saltelli``.
        method : {"sobol", "latin-hypercube", "random", "saltelli"}
            How they are laid out.
        seed : int
            Seed of the method.

        Raises
        ------
        InputError
            For a problem with groups, or of a distribution that a space does not have.
        """
        make: Any = cls
        makers = {
            "sobol": make.sobol,
            "latin-hypercube": make.latin_hypercube,
            "random": make.random,
            "saltelli": make.saltelli,
        }
        if method not in makers:
            raise InputError(f"method: found {method!r}, expected one of {', '.join(makers)}")
        axes = distributions_of(problem)
        return cast(Self, makers[method](drive, count, seed=seed, **axes))

    def to_salib(self) -> dict[str, Any]:
        """Describe this space as a problem of SALib.

        Returns
        -------
        dict
            ``num_vars``, ``names``, ``bounds`` and ``dists``.

        Raises
        ------
        InputError
            For an axis that is a list, steps or whole numbers, which SALib does not have.
        """
        return problem_of(self.axes)
