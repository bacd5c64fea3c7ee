"""One cycloidal drive: its dimensions, ratings and where each number comes from."""

from __future__ import annotations

import math
import re
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import polars as pl
import tomli_w
from pydantic import ValidationError

import cyclosweep._core as _core
from cyclosweep.atomic import write_text
from cyclosweep.design.active_pins import CRITERIA, ActivePins, Criterion, count_active_pins
from cyclosweep.design.nominal_line import NominalLine, Side
from cyclosweep.design.numbers import checked_loads
from cyclosweep.design.parts import PartInputs
from cyclosweep.design.shaft import Cylinder, Frustum, Keyway
from cyclosweep.design.toml_files import one_line, read_toml
from cyclosweep.errors import InputError

__all__ = [
    "CRITERIA",
    "ActivePins",
    "Criterion",
    "Cylinder",
    "Drive",
    "Frustum",
    "Keyway",
    "NominalLine",
]

_BUILT_IN = {"reference-87": "reference_87.toml"}


class Drive(PartInputs):
    """A single-stage cycloidal drive, frozen and checked.

    Every attribute is a key of a drive file, an axis of a study and a column of a sweep; its
    meaning and unit stand in :data:`cyclosweep.design.units.INPUTS`. ``shaft`` lists the output
    shaft's segments from the free end to the flange, each length once; instead of it
    ``output_stiffness_nm_per_arcmin`` may be given, which is then taken as it is: the torque
    transfer efficiency does not multiply a measured stiffness. ``provenance`` says of each number
    whether it is published, derived, reading, assumed or measured, with its source.

    Eq. (13) multiplies the whole compliance by the torque transfer efficiency: *fewer* active pins
    then mean *less* twist, and an optimiser will exploit it. ``criterion`` decides which count of
    active pins feeds the twist. By ``statics`` the pins' share stands in Eq. (11), and compliance,
    stiffness, natural frequency and twist of a row follow it. ``compliance_factor`` is what
    Eq. (13) multiplies the compliance by: the efficiency, or 1 by ``statics`` and for a measured
    stiffness.
    Statics hold for one or two discs; for more, what rests on them is null.

    Whether the parts fit each other is not asked here (a study's axes may still change them), but
    by :meth:`explain` and by the status of a sweep.

    References
    ----------
    .. [1] Kumar, Kosse and Oloyede, "A new method to estimate effective elastic torsional
       compliance of single-stage Cycloidal drives", Mechanism and Machine Theory 105 (2016)
       185-198, doi 10.1016/j.mechmachtheory.2016.06.023.

    Examples
    --------
    >>> drive = Drive.reference_87()
    >>> drive.ratio, drive.output_pin_count
    (87, 8)
    >>> round(drive.nominal_torque_nm, 4)
    7.2575
    """

    @classmethod
    def reference_87(cls) -> Drive:
        """Return the built-in drive of the 87:1 reference case.

        Published are the ratings, counts and free play; the dimensions are assumed, buildable and
        chosen so that the loading line falls into the published band. ``provenance`` marks each.

        Returns
        -------
        Drive
        """
        return cls.built_in("reference-87")

    @classmethod
    def built_in(cls, name: str) -> Drive:
        """Return a built-in drive by its name.

        Parameters
        ----------
        name : str
            ``reference-87``.

        Raises
        ------
        InputError
            For another name.
        """
        if name not in _BUILT_IN:
            known = ", ".join(_BUILT_IN)
            raise InputError(f"drive {name!r}: no such built-in drive, expected {known} or a file")
        text = resources.files("cyclosweep.design").joinpath(_BUILT_IN[name]).read_text("utf-8")
        return cls._from_table(tomllib.loads(text), name)

    @classmethod
    def from_toml(cls, path: str | Path) -> Drive:
        """Read a drive file.

        Parameters
        ----------
        path : str or Path
            The file.

        Returns
        -------
        Drive

        Raises
        ------
        InputError
            One line that names the file, the key, what was found and what was expected.
        """
        return cls._from_table(read_toml(path), str(path))

    @classmethod
    def load(cls, name_or_path: str | Path, beside: Path | None = None) -> Drive:
        """Return a built-in drive or read a drive file.

        Parameters
        ----------
        name_or_path : str or Path
            A built-in name, or a file; what ends in ``.toml`` is a file.
        beside : Path, optional
            Folder against which a relative path is taken.

        Raises
        ------
        InputError
            When neither fits.
        """
        text = str(name_or_path)
        if not text.endswith(".toml"):
            return cls.built_in(text)
        return cls.from_toml(beside / text if beside is not None else text)

    @classmethod
    def _from_table(cls, table: dict[str, Any], source: str) -> Drive:
        try:
            return cls.model_validate(table)
        except ValidationError as error:
            raise InputError(f"{source}: {one_line(error)}") from None

    def to_toml(self, path: str | Path) -> None:
        """Write the drive file that reads back as this drive.

        Parameters
        ----------
        path : str or Path
            The file.
        """
        table = self.model_dump(exclude_none=True)
        table["shaft"] = list(table["shaft"])
        if not table["shaft"]:
            del table["shaft"]
        write_text(path, tomli_w.dumps(table))

    def replace(self, **changes: Any) -> Drive:
        """Return this drive with some inputs changed.

        Parameters
        ----------
        **changes
            New values by input name, ``shaft_2_diameter_mm`` and the like included.

        Returns
        -------
        Drive
            Without the provenance marks of what was changed.

        Raises
        ------
        InputError
            For an unknown name or a value that is not allowed.

        Examples
        --------
        >>> Drive.reference_87().replace(eccentricity_mm=0.7).eccentricity_mm
        0.7
        """
        table = self.model_dump()
        for name, value in changes.items():
            if match := re.fullmatch(r"shaft_(\d+)_(\w+)", name):
                if name not in self.inputs():
                    raise InputError(f"{name}: no such input of this drive")
                table["shaft"][int(match[1]) - 1][match[2]] = value
            elif name in table:
                table[name] = value
            else:
                raise InputError(f"{name}: no such input of this drive")
            table["provenance"] = {
                key: mark
                for key, mark in table["provenance"].items()
                if key != name and not (name == "shaft" and key.startswith("shaft_"))
            }
        return self._from_table(table, self.name)

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
        >>> results = Drive.reference_87().evaluate()
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
        DesignError
            When the drive cannot be built and gives no stiffness of its own, or when its criterion
            is ``statics`` and it has more than two discs.

        Examples
        --------
        >>> line = Drive.reference_87().nominal_line("input")
        >>> line.free_play_deg
        28.0
        """
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

    def active_pins(self, criterion: Criterion | None = None) -> ActivePins:
        """Active hole-pin contacts over one turn of the mesh zone.

        Parameters
        ----------
        criterion : {"published-map", "inside", "statics"}, optional
            The rule; this drive's own by default.

        Returns
        -------
        ActivePins

        Raises
        ------
        DesignError
            When no hole ever crosses the pins' pitch circle.

        Notes
        -----
        ``inside``: the hole's centre lies inside the pitch circle, ``cos(theta (1 + 1/i) - phi)
        < -e / (2 R_OP)``. ``statics``: the hole pushes its pin in the sense of the torque.
        ``published-map`` is *a reconstruction that matches the published map*, not the authors'
        rule: hole angles are reduced to (-180, 180] deg, and a hole at or below zero belongs to
        the left half. A left hole's window is ``[phi + 90 + delta, phi + 270 - delta] i / (i + 1)``
        with ``delta = asin(e / (2 R_OP))``; its start is clipped at 0, its end at 180 deg except
        for the hole of that half nearest ring pin 0, which at a low ratio opens a second time
        before the turn ends. The right half follows the same rule on its own holes and is then
        mirrored. One disc's count is multiplied by the number of discs.

        Examples
        --------
        >>> Drive.reference_87().active_pins().minimum
        4
        """
        half_sine = self.eccentricity_mm / (2 * self.output_pin_circle_radius_mm)
        if half_sine >= 1:
            raise _core.DesignError(f"{self.name}: {self.explain()}")
        return count_active_pins(
            criterion or self.criterion,
            ratio=self.ratio,
            disc_count=self.disc_count,
            output_pin_count=self.output_pin_count,
            half_sine=half_sine,
            clocking_deg=self.hole_clocking_deg,
        )

    def hole_locus(self, theta_deg: npt.ArrayLike, hole: int = 0) -> pl.DataFrame:
        """Path of a hole's centre, a hypotrochoid that crosses the pins' pitch circle.

        Parameters
        ----------
        theta_deg : array_like
            Positions of the mesh zone [deg], clockwise from ring pin 0.
        hole : int
            Which hole of disc 1, from 0.

        Returns
        -------
        polars.DataFrame
            ``theta_deg``, ``x_mm``, ``y_mm``, ``radius_mm``.

        Examples
        --------
        >>> Drive.reference_87().hole_locus([0.0, 90.0]).height
        2
        """
        theta = np.atleast_1d(np.asarray(theta_deg, dtype=np.float64))
        angle = math.radians(self.hole_clocking_deg + (hole + 0.5) * 360 / self.output_pin_count)
        centres = _core.hole_locus(
            self.eccentricity_mm,
            self.output_pin_circle_radius_mm,
            self.ratio,
            angle,
            np.radians(theta),
        )
        return pl.DataFrame(
            {
                "theta_deg": theta,
                "x_mm": centres[:, 0],
                "y_mm": centres[:, 1],
                "radius_mm": np.hypot(centres[:, 0], centres[:, 1]),
            }
        )
