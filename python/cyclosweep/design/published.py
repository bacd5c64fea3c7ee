"""The published compliance model of one drive: its results, and the line that they make."""

from __future__ import annotations

import math
from typing import get_args

import cyclosweep._core as _core
from cyclosweep.design.hole_paths import HolePaths
from cyclosweep.design.nominal_line import NominalLine, Side
from cyclosweep.design.numbers import checked_loads
from cyclosweep.errors import one_of

__all__ = ["PublishedDrive"]


class PublishedDrive(HolePaths):
    """A drive with the results of the published model."""

    def explain(self) -> str | None:
        """Why this drive cannot be built, with the numbers that show it; None when it can."""
        return self.study().explain(0)

    def evaluate(self, loads_tn: tuple[float, ...] = (1, 2, 3, 4, 4.5)) -> dict[str, float | None]:
        """Evaluate the published compliance model for this drive.

        Parameters
        ----------
        loads_tn : tuple of float
            Loads [T_N] at which twists are computed; a negative one acts in the other direction
            and gives the negative of the twist. At zero it is the end of the free play.

        Returns
        -------
        dict
            Every result column of a sweep; None where it does not apply.

        Raises
        ------
        DesignError
            When the drive cannot be built.
        InputError
            For a load that is no finite number.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> results = cs.Drive.reference_87().evaluate()
        >>> round(results["twist_1tn_deg"], 1)
        47.8
        """
        loads = checked_loads(loads_tn, allow_zero=True)
        study = self.study(loads)
        if (reason := study.explain(0)) is not None:
            raise _core.DesignError(f"{self.name}: {reason}")
        names = [name for name, _ in _core.output_table(list(loads))]
        _, _, columns = study.evaluate_range(0, 1, names)
        values = (float(column[0]) for column in columns)
        return {
            name: None if math.isnan(value) else value
            for name, value in zip(names, values, strict=True)
        }

    def nominal_line(self, side: Side = "input") -> NominalLine:
        """Dead zone and slope that the published model gives this drive.

        Parameters
        ----------
        side : {"input", "output"}
            Shaft at which torque and angle are meant, the other one locked.

        Returns
        -------
        NominalLine

        Raises
        ------
        InputError
            For another side.
        DesignError
            When the drive cannot be built and gives no stiffness of its own, or when its criterion
            is ``statics`` and it has more than two discs.

        Examples
        --------
        >>> import cyclosweep as cs
        >>> line = cs.Drive.reference_87().nominal_line("input")
        >>> line.free_play_deg
        28.0
        """
        one_of("side", side, get_args(Side))
        if self.output_stiffness_nm_per_arcmin is not None:
            at_output = 1.0 / (60.0 * self.output_stiffness_nm_per_arcmin)
            at_input = at_output * self.ratio**2
        else:
            twist = self.evaluate((1.0,))["twist_1tn_deg"]
            if twist is None:
                raise _core.DesignError(
                    f"{self.name}: statics hold for one or two discs, found {self.disc_count}"
                )
            at_input = (twist - self.free_play_deg) / self.nominal_torque_nm
        return NominalLine(self.free_play_deg, at_input).at(side, self.ratio)
