"""One cycloidal drive: its dimensions, ratings and where each number comes from."""

from __future__ import annotations

import json
import os
import re
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any, Literal

import tomli_w

from cyclosweep.atomic import write_text
from cyclosweep.design.active_pins import CRITERIA, ActivePins, Criterion
from cyclosweep.design.drive_train import CalibratedModel, TrainParts, train_of
from cyclosweep.design.json_files import JsonSource, json_object, name_of
from cyclosweep.design.nominal_line import NominalLine
from cyclosweep.design.parts import TRAIN_INPUTS
from cyclosweep.design.published import PublishedDrive
from cyclosweep.design.shaft import Cylinder, Frustum, Keyway
from cyclosweep.design.toml_files import read_as, read_toml
from cyclosweep.dynamics.train import Train
from cyclosweep.errors import InputError, did_you_mean, path_of

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


class Drive(PublishedDrive):
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
        if not isinstance(name, str) or name not in _BUILT_IN:
            known = ", ".join(_BUILT_IN)
            if isinstance(name, str) and os.path.isfile(name):
                raise InputError(
                    f"drive {name!r}: found a file that does not end in .toml, expected {known} "
                    "or a .toml file"
                )
            hint = did_you_mean(name, _BUILT_IN)
            raise InputError(
                f"drive {name!r}: no such built-in drive, expected {known} or a file{hint}"
            )
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
        return read_as(cls, "a drive file", table, source)

    def to_toml(self, path: str | Path) -> None:
        """Write the drive file that reads back as this drive.

        Parameters
        ----------
        path : str or Path
            The file.
        """
        write_text(path_of("file", path), tomli_w.dumps(self._table()))

    def _table(self) -> dict[str, Any]:
        """What a file holds: every key that is given."""
        table = self.model_dump(exclude_none=True)
        table["shaft"] = list(table["shaft"])
        if not table["shaft"]:
            del table["shaft"]
        return table

    def to_json(self) -> str:
        """Return the keys of the drive file as JSON."""
        return json.dumps(self._table(), indent=1)

    @classmethod
    def from_json(cls, source: JsonSource) -> Drive:
        """Read what :meth:`to_json` returned.

        Parameters
        ----------
        source : str, Path or mapping
            The text, a file of it, or its decoded content.

        Returns
        -------
        Drive

        Raises
        ------
        InputError
            One line that names the key, what was found and what was expected.

        Examples
        --------
        >>> drive = Drive.reference_87()
        >>> Drive.from_json(drive.to_json()) == drive
        True
        """
        try:
            table = json_object(source)
        except InputError as error:
            raise InputError(f"{name_of(source)}: {error}") from None
        return cls._from_table(table, name_of(source))

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
        table: dict[str, Any] = {name: getattr(self, name) for name in type(self).model_fields}
        for name, value in changes.items():
            if name in table:
                table[name] = value
            elif (match := re.fullmatch(r"shaft_(\d+)_(\w+)", name)) and name in self.inputs():
                shaft = list(table["shaft"])
                number = int(match[1]) - 1
                shaft[number] = {**dict(shaft[number]), match[2]: value}
                table["shaft"] = shaft
            else:
                hint = did_you_mean(name, [*table, *self.inputs()])
                raise InputError(f"{name}: no such input of this drive{hint}")
        if "provenance" not in changes:
            table["provenance"] = {
                key: mark
                for key, mark in self.provenance.items()
                if key not in changes and not ("shaft" in changes and key.startswith("shaft_"))
            }
        return self._from_table(table, self.name)

    def train(
        self,
        model: Literal["published", "components"] | CalibratedModel = "published",
        *,
        with_efficiency: bool = True,
        **parts: float | None,
    ) -> Train:
        """Torsional train of this drive: input, discs and output with their springs and play.

        Parameters
        ----------
        model : {"published", "components"} or Model
            Where the springs come from: dead zone and compliance of Eq. (13); mesh and output pins
            by the component model, point by point up to 4.5 times the rated torque; or a
            calibrated model such as ``found.model`` with its stiffening, play, friction and drag.
        with_efficiency : bool
            Whether the published compliance carries the torque transfer efficiency. Without it
            every low frequency falls by the root of the efficiency.
        **parts
            What the drive's file does not hold: the fields of
            :class:`cyclosweep.design.drive_train.TrainParts`. A part that is not given, or None,
            is the drive's own key. Without ``load_inertia_kg_m2`` the output is locked.

        Returns
        -------
        Train
            Every shaft in its own terms, joined by the ratio.

        Raises
        ------
        InputError
            For an unknown part, a number out of range, or a drive without inertia at its input.
        DesignError
            When the drive cannot be built.

        Examples
        --------
        >>> train = Drive.reference_87().train(load_inertia_kg_m2=5.0)
        >>> train.names
        ('input', 'load')
        >>> bool(train.modes().frequencies_hz[1] > 25)
        True
        """
        unknown = [name for name in parts if name not in TrainParts.__dataclass_fields__]
        if unknown:
            known = ", ".join(TrainParts.__dataclass_fields__)
            hint = did_you_mean(unknown[0], TrainParts.__dataclass_fields__)
            raise InputError(
                f"{unknown[0]}: no such part of a train, expected one of {known}{hint}"
            )
        own = {name: getattr(self, name) for name in TRAIN_INPUTS}
        given = {name: part for name, part in parts.items() if part is not None}
        stated = {name: part for name, part in own.items() if part is not None}
        return train_of(self, model, TrainParts(**{**stated, **given}), with_efficiency)
