"""The model as the validation asks it: the package itself, or the package with one error put in."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import cyclosweep._core as _core
from cyclosweep.design.drive import CRITERIA, Criterion, Drive
from cyclosweep.design.loaded import LoadedState
from cyclosweep.dynamics.train import Train
from cyclosweep.errors import InputError

__all__ = ["Model", "PinMap", "Results", "assembled"]

Results = dict[str, float]
"""Results of one drive by column; NaN where they do not apply."""


class PinMap(NamedTuple):
    """Active contacts of one drive over one turn.

    Attributes
    ----------
    mean, minimum, maximum : float
        Number of active contacts [1].
    stiffness_mean, stiffness_minimum, stiffness_maximum : float
        Sum of sin^2 over the loaded contacts per output pin, by statics [1].
    first_hole_opens_deg : float
        Where the active zone of hole H1 begins by the rule ``published-map`` [deg].
    """

    mean: float
    minimum: float
    maximum: float
    stiffness_mean: float
    stiffness_minimum: float
    stiffness_maximum: float
    first_hole_opens_deg: float


@dataclass(frozen=True)
class Model:
    """Everything the validation asks of the package, in one object that can be broken.

    Attributes
    ----------
    name : str
        Name, shown in tables.
    meaning : str
        What is wrong with it, in one sentence without a full stop; empty for the package itself.
    change_drive : callable
        What is done to every drive before it is computed.
    change_results : callable
        What is done to a drive's results; takes the drive that was computed and its results.
    change_train : callable
        What is done to every torsional train before it is computed.
    solve : callable
        How a drive under a torque [N m] at a crank angle [rad] is solved for.
    """

    name: str = "intact"
    meaning: str = ""
    change_drive: Callable[[Drive], Drive] = lambda drive: drive
    change_results: Callable[[Drive, Results], Results] = lambda _, results: results
    change_train: Callable[[Train], Train] = lambda train: train
    solve: Callable[[Drive, float, float], LoadedState] = lambda drive, torque, crank: drive.loaded(
        torque, crank
    )

    @property
    def broken(self) -> bool:
        """Whether an error has been put in."""
        return bool(self.meaning)

    def evaluate(self, drive: Drive, loads_tn: tuple[float, ...] = (1.0,)) -> Results:
        """Evaluate a drive.

        Parameters
        ----------
        drive : Drive
            The drive.
        loads_tn : tuple of float
            Loads [T_N] at which twists are computed.

        Returns
        -------
        dict
            Result columns; NaN where they do not apply, and everywhere when the error that was
            put in makes the drive impossible.

        Raises
        ------
        DesignError
            When the drive cannot be built and no error was put in.
        """
        try:
            drive = self.change_drive(drive)
            found = drive.evaluate(loads_tn)
        except (_core.DesignError, InputError):
            if not self.broken:
                raise
            return defaultdict(lambda: math.nan)
        results = {name: math.nan if value is None else value for name, value in found.items()}
        return self.change_results(drive, results)

    def loaded(self, drive: Drive, torque_nm: float, crank_rad: float) -> LoadedState:
        """Equilibrium of a drive by the component model.

        Parameters
        ----------
        drive : Drive
            The drive.
        torque_nm : float
            Torque at the output [N m].
        crank_rad : float
            Angle of the eccentric [rad].
        """
        return self.solve(self.change_drive(drive), torque_nm, crank_rad)

    def shaft_compliance(self, drive: Drive) -> float:
        """Torsional compliance C_OS^t of a drive's shaft [rad/(N m)]."""
        return self.evaluate(drive)["shaft_compliance_rad_per_nm"]

    def pin_map(self, drive: Drive, criterion: Criterion) -> PinMap:
        """Active contacts of a drive over one turn.

        Parameters
        ----------
        drive : Drive
            The drive.
        criterion : {"published-map", "inside", "statics"}
            Rule by which a contact counts as active.

        Returns
        -------
        PinMap
        """
        drive = self.change_drive(drive)
        half_sine = drive.eccentricity_mm / (2 * drive.output_pin_circle_radius_mm)
        count, stiffness, (opens, _) = _core.active_pins(
            CRITERIA.index(criterion),
            float(drive.ratio),
            drive.disc_count,
            drive.output_pin_count,
            math.asin(half_sine) / math.tau,
            drive.hole_clocking_deg / 360,
        )
        return PinMap(*count, *stiffness, 360 * opens)


def assembled(
    drive: Drive,
    results: Results,
    *,
    pin_compliance: float | None = None,
    output_compliance: float | None = None,
    reflection: float = 1.0,
    efficiency: float = 1.0,
) -> Results:
    """Results after one piece of the assembly, Eqs. (11)-(13), was exchanged.

    Parameters
    ----------
    drive : Drive
        The drive.
    results : dict
        Its results.
    pin_compliance : float, optional
        Another compliance of one pin [rad/(N m)].
    output_compliance : float, optional
        Another compliance at the output, C_OS [rad/(N m)].
    reflection : float
        Factor on the reflection of Eq. (12) [1].
    efficiency : float
        Factor on the compliance of Eq. (13) [1].

    Returns
    -------
    dict
        Every column that follows from that piece, moved with it.
    """
    moved = dict(results)
    output = results["output_compliance_rad_per_nm"]
    if pin_compliance is not None:
        more = (pin_compliance - results["pin_compliance_rad_per_nm"]) / drive.output_pin_count
        share = results["pin_participation_statics"]
        moved["pin_compliance_rad_per_nm"] = pin_compliance
        by_statics = drive.criterion == "statics"
        moved["output_compliance_rad_per_nm"] = output + (more / share if by_statics else more)
        moved["output_compliance_statics_rad_per_nm"] += more / share
    if output_compliance is not None:
        moved["output_compliance_rad_per_nm"] = output_compliance
    at_output = moved["output_compliance_rad_per_nm"] / output
    at_input = at_output * reflection
    moved["output_stiffness_nm_per_arcmin"] /= at_output
    moved["reflected_compliance_rad_per_nm"] *= at_input
    moved["reflected_stiffness_nm_per_rad"] /= at_input
    moved["compliance_factor"] *= efficiency
    moved["natural_frequency_with_efficiency_hz"] /= math.sqrt(efficiency)
    for name in results:
        if name.startswith("natural_frequency"):
            moved[name] /= math.sqrt(at_input)
        elif name.startswith("twist_"):
            elastic = results[name] - drive.free_play_deg
            moved[name] = drive.free_play_deg + elastic * at_input * efficiency
    return moved
