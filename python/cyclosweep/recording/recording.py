"""A torque-twist recording or load programme: its samples and what is known about them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import finite_number, plain
from cyclosweep.errors import (
    DesignError,
    InputError,
    did_you_mean,
    instance_of,
    one_of,
    path_of,
)
from cyclosweep.notebook import html_table
from cyclosweep.recording.checks import find_faults
from cyclosweep.recording.cleaning import drop_missing, without_stopped_clock
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.messages import printable
from cyclosweep.recording.metadata import Metadata
from cyclosweep.recording.reading import read
from cyclosweep.recording.samples import COLUMNS, Ints, Samples, floats_of, numbers_of
from cyclosweep.recording.saturation import find_saturation
from cyclosweep.recording.structure import Structure, find_structure
from cyclosweep.recording.wrapping import modulo_fault


@dataclass(frozen=True, eq=False, kw_only=True)
class Recording(Samples):
    """Torque and twist of a drive with its output (or input) locked, in the order recorded.

    Attributes
    ----------
    name : str
        Stem of the file.
    path : Path or None
        File it was read from.
    torque_nm : ndarray of float, shape (n,)
        Torque at the measured shaft [N m].
    angle_deg : ndarray of float, shape (n,), or None
        Twist at the measured shaft [deg], unwrapped, positive with the torque; None for a load
        programme.
    time_s : ndarray of float or None
        Clock [s]. Without it only the order of rows is known and rate effects are untestable.
    run : ndarray of int
        Trial each sample belongs to.
    crank_deg : ndarray of float or None
        Position of the mesh zone at which the output was locked [deg].
    temperature_c : ndarray of float or None
        Temperature [degC].
    side : {"input", "output"}
        Shaft at which torque and angle were measured.
    drive : str or None
        Built-in name of the drive, or path to a drive file.
    torque_from : {"sensor", "motor-current"}
        Whether torque was measured, or computed from the current of a motor.
    angle_resolution_deg : float
        Step of the angle reading [deg]; 0 where it is continuous.
    angle_modulo_deg : float or None
        The angle was known up to a multiple of this [deg], and is put together again.
    history : {"per-run", "continuous"}
        Whether play, slip and creep start afresh with every run.
    reset_between_runs : bool
        The rig was reset between runs, so that the datum cannot remember either.
    conditioning_runs : tuple of int
        Runs simulated for their effect on the state, neither fitted nor scored.
    holdout_runs : tuple of int
        Runs kept for the verdict; empty: chosen by blocks.
    unscored : ndarray of bool or None
        Samples simulated for their effect on the state, neither fitted nor scored; None: all count.
    notes : tuple of str
        What was recognised and changed while reading.
    faults : tuple of Fault
        What is wrong with it; see `cyclosweep.recording.faults` for the rule.
    sha256 : str or None
        Hash of the file, for provenance.
    """

    name: str
    path: Path | None = None
    side: Literal["input", "output"] = "input"
    drive: str | None = None
    torque_from: Literal["sensor", "motor-current"] = "sensor"
    angle_resolution_deg: float = 0.0
    angle_modulo_deg: float | None = None
    history: Literal["per-run", "continuous"] = "per-run"
    reset_between_runs: bool = False
    conditioning_runs: tuple[int, ...] = ()
    holdout_runs: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()
    faults: tuple[Fault, ...] = ()
    sha256: str | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        instance_of("name", self.name, str)
        one_of("side", self.side, _SIDES)
        one_of("torque_from", self.torque_from, _TORQUES)
        one_of("history", self.history, _HISTORIES)
        if finite_number("angle_resolution_deg", self.angle_resolution_deg) < 0:
            raise InputError(
                f"angle_resolution_deg: found {self.angle_resolution_deg:g}, expected a step not "
                "below zero"
            )
        modulo = self.angle_modulo_deg
        if modulo is not None and finite_number("angle_modulo_deg", modulo) <= 0:
            raise InputError(f"angle_modulo_deg: found {modulo:g}, expected degrees above zero")
        if self.drive is not None:
            instance_of("drive", self.drive, str, Path)
        instance_of("reset_between_runs", self.reset_between_runs, bool)
        for key in ("conditioning_runs", "holdout_runs"):
            object.__setattr__(self, key, _run_numbers(key, getattr(self, key)))

    @classmethod
    def read(cls, path: str | Path, meta: str | Path | None = None) -> Self:
        """Read a recording or a load programme.

        Parameters
        ----------
        path : path
            CSV (also gzip, byte-order mark, ``;`` with decimal commas), LabVIEW text or JSON;
            Parquet, Excel, MATLAB, HDF5 or TDMS.
        meta : path, optional
            TOML file that says how to read it; default: the file of the same stem beside it,
            where there is one.

        Returns
        -------
        Recording
            With its ``faults`` found and its ``notes`` on what was recognised.

        Raises
        ------
        InputError
            The file cannot be read as a recording; one line says why.
        """
        meta_path = None if meta is None else path_of("meta", meta)
        return cls._read(path_of("path", path), meta_path, None)

    @classmethod
    def read_as(cls, path: Path, meta: Metadata, meta_path: Path) -> Self:
        """Read a recording as a metadata file would say that is not written yet.

        Parameters
        ----------
        path : Path
            The recording's file.
        meta : Metadata
            What the file would say.
        meta_path : Path
            Where it would stand.

        Returns
        -------
        Recording

        Raises
        ------
        InputError
            The file cannot be read as a recording; one line says why.
        """
        return cls._read(path, meta_path, meta)

    @classmethod
    def _read(cls, path: Path, meta_path: Path | None, meta: Metadata | None) -> Self:
        try:
            parts = read(path, meta_path, meta)
        except InputError as error:  # names in the file may hold line breaks
            raise InputError(printable(str(error))) from None
        return cls(**parts)._checked()

    @classmethod
    def from_arrays(
        cls,
        torque_nm: ArrayLike,
        angle_deg: ArrayLike | None = None,
        *,
        time_s: ArrayLike | None = None,
        run: ArrayLike | None = None,
        crank_deg: ArrayLike | None = None,
        temperature_c: ArrayLike | None = None,
        name: str = "recording",
        **known: Any,
    ) -> Self:
        """Make a recording of arrays.

        Parameters
        ----------
        torque_nm : array_like, shape (n,)
            Torque at the measured shaft [N m].
        angle_deg : array_like, shape (n,), optional
            Twist at the measured shaft [deg]; without it this is a load programme.
        time_s, crank_deg, temperature_c : array_like, shape (n,), optional
            Clock [s], position of the mesh zone [deg], temperature [degC].
        run : array_like of int, shape (n,), optional
            Trial each sample belongs to; by default all are one run.
        name : str
            What the recording is called.
        **known
            Other attributes of a recording, such as ``side``.

        Returns
        -------
        Recording
            Without the samples that lack a finite torque, angle or time, and with its faults.

        Raises
        ------
        InputError
            For arrays of different lengths or more than one dimension, what is no number, or an
            attribute that no recording has.

        Examples
        --------
        >>> Recording.from_arrays([0.0, 5.0, 0.0], [28.0, 41.7, 28.1], side="input").runs
        (1,)
        """
        for attribute in known:
            if attribute not in cls.__dataclass_fields__:
                hint = did_you_mean(attribute, cls.__dataclass_fields__)
                raise InputError(f"{attribute}: no such attribute of a recording{hint}")
        torque = numbers_of("torque_nm", torque_nm)
        given: dict[str, Any] = {
            "torque_nm": torque,
            "angle_deg": floats_of("angle_deg", angle_deg),
            "time_s": floats_of("time_s", time_s),
            "run": numbers_of("run", np.ones(len(torque)) if run is None else run),
            "crank_deg": floats_of("crank_deg", crank_deg),
            "temperature_c": floats_of("temperature_c", temperature_c),
            "unscored": floats_of("unscored", known.pop("unscored", None)),
        }
        whole = cls(name=name, **given, **known)  # refuses columns of unequal length
        notes = list(whole.notes)
        columns, faults = drop_missing(without_stopped_clock(given, notes), notes)
        kept: dict[str, Any] = dict(columns)
        return replace(whole, **kept, notes=tuple(notes), faults=faults)._checked()

    def _checked(self) -> Self:
        """Return this recording with the faults that its samples show, the saturated unscored."""
        found = find_faults(
            self, conditioning_runs=self.conditioning_runs, holdout_runs=self.holdout_runs
        )
        counts = self.counts
        saturation, lost_of_them = find_saturation(self.take(counts))
        lost = np.zeros(len(self), dtype=np.bool_)
        lost[counts] = lost_of_them
        modulo = self.modulo_fault(self._play_deg())
        if any(fault.kind == "too_few_selected" for fault in self.faults):
            found = tuple(fault for fault in found if fault.kind != "too_few_samples")
        found = (*found, *saturation, *(() if modulo is None else (modulo,)))
        unscored = lost if self.unscored is None else self.unscored | lost
        return replace(
            self,
            faults=(*self.faults, *found),
            unscored=unscored if lost.any() else self.unscored,
        )

    def modulo_fault(self, play_deg: float | None = None) -> Fault | None:
        """Return the remark that the angle's modulo is too small to put it together, if it is.

        Parameters
        ----------
        play_deg : float, optional
            Whole free play of the drive file at the measured shaft, from flank to flank [deg].

        Returns
        -------
        Fault or None
        """
        if self.angle_modulo_deg is None or self.angle_deg is None:
            return None
        return modulo_fault(
            self.angle_deg, self.torque_nm, self.run, self.angle_modulo_deg, play_deg
        )

    def _play_deg(self) -> float | None:
        """Whole free play at the measured shaft [deg], where the metadata name a drive."""
        if self.drive is None:
            return None
        try:
            drive = Drive.load(self.drive)
        except (DesignError, InputError):
            return None  # a diagnosis says what is wrong with the drive
        play = 2.0 * drive.free_play_deg
        return play if self.side == "input" else play / drive.ratio

    def __repr__(self) -> str:
        kind = "programme of" if self.is_program else "twist and torque of"
        runs = "1 run" if len(self.runs) == 1 else f"{len(self.runs)} runs"
        span = f", {self._torques()}" if len(self) else ""
        faults = f", {len(self.faults)} faults" if self.faults else ""
        return (
            f"<Recording {self.name}: {kind} {len(self):,} samples in {runs}{span} at the "
            f"{self.side}{faults}>"
        )

    def _torques(self) -> str:
        return f"{self.torque_nm.min():.4g} to {self.torque_nm.max():.4g} N m"

    def _repr_html_(self) -> str:
        rows: dict[str, object] = {"samples": f"{len(self):,} in {len(self.runs)} runs"}
        if len(self):
            rows["torque"] = f"{self._torques()} at the {self.side}"
        if self.angle_deg is not None and len(self):
            rows["angle"] = f"{self.angle_deg.min():.4g} to {self.angle_deg.max():.4g} deg"
        if self.time_s is not None and len(self):
            rows["time"] = f"{self.time_s.max() - self.time_s.min():.4g} s"
        rows |= {
            "drive": self.drive,
            "notes": " ".join(self.notes),
            "faults": " ".join(fault.reason for fault in self.faults),
        }
        return html_table(f"Recording {self.name}", rows)

    @property
    def counts(self) -> NDArray[np.bool_]:
        """Mask of the samples that are fitted or scored."""
        whole = ~self.in_runs(self.conditioning_runs)
        return whole if self.unscored is None else whole & ~self.unscored

    @property
    def blocking_fault(self) -> Fault | None:
        """First fault that forces a verdict; contradictions before shortage."""
        forcing = [fault for fault in self.faults if fault.verdict]
        return min(forcing, key=lambda fault: fault.verdict != "DATA_FAULT", default=None)

    @cached_property
    def structure(self) -> Structure:
        """Runs, branches, holds, reversals and dead-zone samples."""
        return find_structure(self)

    def take(self, rows: NDArray[np.bool_] | Sequence[int] | Ints | slice) -> Self:
        """Return a part of the recording.

        Parameters
        ----------
        rows : slice, array of bool of shape (n,), or sequence of int
            Rows to keep, in the order recorded: the path of the load counts.

        Returns
        -------
        Recording
        """
        columns: dict[str, Any] = {name: getattr(self, name) for name in COLUMNS}
        columns = {name: v if v is None else v[rows] for name, v in columns.items()}
        return replace(self, **columns)

    def with_angle(self, angle_deg: ArrayLike | None) -> Self:
        """Return the same load history with another angle, as for simulated recordings.

        Parameters
        ----------
        angle_deg : array_like, shape (n,), or None
            Twist of the recording's shaft [deg]; None leaves the load history alone.

        Returns
        -------
        Recording
        """
        return replace(self, angle_deg=floats_of("angle_deg", angle_deg))


_SIDES = ("input", "output")
_TORQUES = ("sensor", "motor-current")
_HISTORIES = ("per-run", "continuous")


def _run_numbers(key: str, runs: object) -> tuple[int, ...]:
    """Numbers of runs as a tuple.

    Parameters
    ----------
    key : str
        Attribute that names them.
    runs : iterable of int
        What was given.

    Returns
    -------
    tuple of int

    Raises
    ------
    InputError
        For anything but a list of whole numbers.
    """
    found = [plain(k) for k in runs] if isinstance(runs, Iterable) else None
    if found is None or any(isinstance(k, bool) or not isinstance(k, int) for k in found):
        raise InputError(f"{key}: found {runs!r}, expected a list of numbers of runs")
    return tuple(k for k in found if isinstance(k, int))
