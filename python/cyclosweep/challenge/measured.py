"""Measured loops as the challenge uses them: real repeats as a null, signatures injected."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep.challenge.joint import Joint
from cyclosweep.challenge.sideload import SideLoad

Array = NDArray[np.float64]

LARGEST_COMMAND_NM = 24.0
"""Beyond this the motor's current limit holds the torque while the command goes on [N m]."""

CONDITIONING, FIRST, SECOND = 100, 101, 102
INJECTABLE = ("datum_drift", "load_asymmetry", "overload_softening")
"""Effects whose signature can be laid over a measured loop without simulating its friction."""


@dataclass(frozen=True)
class Loops:
    """Torque ramps of one measurement, a clock tick a row.

    Attributes
    ----------
    time_s, torque_nm, angle_deg : array
        Clock [s], output torque [N m] and output angle [deg].
    run : array of int
        Number of the ramp.
    """

    time_s: Array
    torque_nm: Array
    angle_deg: Array
    run: NDArray[np.int64]

    def frame(self) -> pl.DataFrame:
        """Return the loops in the canonical columns."""
        return pl.DataFrame(
            {
                "time_s": self.time_s.round(4),
                "torque_nm": self.torque_nm.round(5),
                "angle_deg": self.angle_deg.round(6),
                "run": self.run,
            }
        )


def read_loops(path: Path) -> Loops:
    """Read the large torque ramps of one measured file.

    Rows that share a clock tick are averaged in file order, commands beyond the current limit
    are left out, and revolutions become degrees.
    """
    table = pl.read_csv(path)
    table = table.rename({name: name.strip().lstrip("\ufeff") for name in table.columns})
    ticks = (
        table.filter(pl.col("test_nr") >= CONDITIONING)
        .group_by("test_nr", "TIME", maintain_order=True)
        .mean()
        .filter(pl.col("CONTROL_TORQUE").abs() <= LARGEST_COMMAND_NM)
    )
    return Loops(
        ticks["TIME"].to_numpy(),
        ticks["TORQUE"].to_numpy(),
        ticks["POSITION"].to_numpy() * 360.0,
        ticks["test_nr"].cast(pl.Int64).to_numpy(),
    )


def repeated_null(loops: Loops, smallest_nm: float = 3.0) -> Loops:
    """Loops with nothing missing and the measurement's own noise.

    The two repeats differ by what does not repeat. That difference, divided by the square root
    of two, is laid over the straight line that fits the first repeat on its loaded flanks; the
    crossing of the play, where a difference in timing looks like one in angle, is left out.

    Parameters
    ----------
    loops : Loops
        Measured ramps with two repeats.
    smallest_nm : float
        Torque below which readings are left out [N m].
    """
    one, two = (np.flatnonzero(loops.run == number) for number in (FIRST, SECOND))
    count = min(one.size, two.size)
    one, two = one[:count], two[:count]
    torque = loops.torque_nm[one]
    columns = np.column_stack([np.ones(count), np.sign(torque), torque])
    loaded = (np.abs(torque) >= smallest_nm) & (np.abs(loops.torque_nm[two]) >= smallest_nm)
    line = columns @ np.linalg.lstsq(columns[loaded], loops.angle_deg[one][loaded])[0]
    noise = (loops.angle_deg[two] - loops.angle_deg[one]) / np.sqrt(2.0)
    # The mean difference of a flank is a change of datum or play between the repeats.
    for side in (-1.0, 1.0):
        flank = loaded & (np.sign(torque) == side)
        noise[flank] -= noise[flank].mean()
    return Loops(
        loops.time_s[one][loaded],
        torque[loaded],
        (line + noise)[loaded],
        loops.run[one][loaded],
    )


def left_over(loops: Loops, angle_deg: Array) -> Array:
    """Part of an angle on these loops that a free calibration does not explain [deg]."""
    torque = loops.torque_nm
    columns = np.column_stack([np.ones_like(torque), np.sign(torque), torque])
    return np.asarray(angle_deg - columns @ np.linalg.lstsq(columns, angle_deg)[0])


def repeats(null: Loops) -> bool:
    """Whether a measurement repeats well enough for its repeats to be a null.

    Where the noise exceeds 3 % of the whole travel the drive changed between the ramps, and
    the difference of the ramps is not noise but what is to be found.
    """
    noise = np.std(left_over(null, null.angle_deg))
    return bool(noise < 0.03 * np.ptp(null.angle_deg))


def signature(name: str, loops: Loops, rng: np.random.Generator) -> Array:
    """Shape of an effect on measured loops, of unit rms once a calibration is free [-].

    Raises
    ------
    ValueError
        If the effect is none of ``INJECTABLE``.
    """
    torque = loops.torque_nm
    sign = float(rng.choice([-1.0, 1.0]))
    if name == "datum_drift":
        shape = sign * (loops.run - loops.run[0]).astype(float)
    elif name == "load_asymmetry":
        shape = sign * SideLoad.draw(rng).turn(torque, 1.0)
    elif name == "overload_softening":
        joint = Joint(LARGEST_COMMAND_NM * np.linspace(0.5, 0.6, 6))
        shape = np.sign(torque) * joint.twist(np.abs(torque), 1.0)
    else:
        raise ValueError(f"effect: found {name!r}, expected one of {', '.join(INJECTABLE)}")
    return np.asarray(shape / np.sqrt(np.mean(left_over(loops, shape) ** 2)))


def injected(loops: Loops, name: str, size_deg: float, rng: np.random.Generator) -> Loops:
    """Measured loops with an effect of a given size laid over them [deg]."""
    angle = loops.angle_deg + size_deg * signature(name, loops, rng)
    return Loops(loops.time_s, loops.torque_nm, angle, loops.run)


def write_loops(loops: Loops, folder: Path, drive: str, conditioning: bool) -> None:
    """Write loops as a recording.

    Parameters
    ----------
    loops : Loops
        What was measured.
    folder : pathlib.Path
        Where ``recording.csv`` and ``recording.toml`` go.
    drive : str
        Name or file of the drive, as the TOML states it.
    conditioning : bool
        Whether the first ramp is there to condition the drive.
    """
    folder.mkdir(parents=True, exist_ok=True)
    loops.frame().write_csv(folder / "recording.csv")
    lines = ['side = "output"', f'drive = "{drive}"', 'history = "continuous"']
    if conditioning:
        lines.append(f"conditioning_runs = [{CONDITIONING}]")
    (folder / "recording.toml").write_text("\n".join(lines) + "\n")
