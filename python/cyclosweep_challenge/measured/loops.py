"""Measured loops as the challenge uses them: real repeats as a null, signatures injected."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep_challenge.rig.joint import Joint
from cyclosweep_challenge.rig.sideload import SideLoad

Array = NDArray[np.float64]

LARGEST_COMMAND_NM = 24.0
"""Beyond this the motor's current limit holds the torque while the command goes on [N m]."""

CONDITIONING, FIRST, SECOND = 100, 101, 102
SMALL_PAIRS = ((1, 2), (3, 4))
"""Repeats among the small ramps, of which the first (0) is conditioning; no ramp twice."""
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
    beyond : array of bool, optional
        Readings that do not count, because the motor stood at its current limit; the drive
        remembers them all the same. None where all count.
    """

    time_s: Array
    torque_nm: Array
    angle_deg: Array
    run: NDArray[np.int64]
    beyond: NDArray[np.bool_] | None = None

    @property
    def counts(self) -> NDArray[np.bool_]:
        """Readings that count."""
        return np.ones(self.run.size, dtype=bool) if self.beyond is None else ~self.beyond

    def frame(self) -> pl.DataFrame:
        """Return the loops in the canonical columns, and whether a reading is beyond."""
        return pl.DataFrame(
            {
                "time_s": self.time_s.round(4),
                "torque_nm": self.torque_nm.round(5),
                "angle_deg": self.angle_deg.round(6),
                "run": self.run,
                "beyond": (~self.counts).astype(np.int8),
            }
        )

    def only(self, *runs: int) -> Loops:
        """Return some of the ramps."""
        keep = np.isin(self.run, runs)
        return Loops(
            self.time_s[keep],
            self.torque_nm[keep],
            self.angle_deg[keep],
            self.run[keep],
            ~self.counts[keep],
        )


def read_loops(path: Path, *, large: bool = True) -> Loops:
    """Read the large torque ramps of one measured file, or its small ones.

    Rows that share a clock tick are averaged in file order, readings at commands beyond the
    current limit are marked, and revolutions become degrees.
    """
    table = pl.read_csv(path)
    table = table.rename({name: name.strip().lstrip("\ufeff") for name in table.columns})
    ticks = (
        table.filter((pl.col("test_nr") >= CONDITIONING) == large)
        .group_by("test_nr", "TIME", maintain_order=True)
        .mean()
    )
    return Loops(
        ticks["TIME"].to_numpy(),
        ticks["TORQUE"].to_numpy(),
        ticks["POSITION"].to_numpy() * 360.0,
        ticks["test_nr"].cast(pl.Int64).to_numpy(),
        ticks["CONTROL_TORQUE"].abs().to_numpy() > LARGEST_COMMAND_NM,
    )


def repeated_null(
    loops: Loops,
    smallest_nm: float = 3.0,
    pair: tuple[int, int] = (FIRST, SECOND),
    flank: float = 0.0,
) -> Loops:
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
    pair : tuple of int
        The two repeats; their order turns the sign of the noise.
    flank : float
        Sign of the torque to keep; zero for both.
    """
    one, two = (np.flatnonzero((loops.run == number) & loops.counts) for number in pair)
    count = min(one.size, two.size)
    one, two = one[:count], two[:count]
    torque = loops.torque_nm[one]
    columns = np.column_stack([np.ones(count), np.sign(torque), torque])
    # A ramp that lags behind its repeat is still on the other flank for a reading or two.
    loaded = np.abs(torque) >= smallest_nm
    loaded &= np.sign(torque) * loops.torque_nm[two] >= smallest_nm
    line = columns @ np.linalg.lstsq(columns[loaded], loops.angle_deg[one][loaded])[0]
    noise = (loops.angle_deg[two] - loops.angle_deg[one]) / np.sqrt(2.0)
    # The mean difference of a flank is a change of datum or play between the repeats.
    for side in (-1.0, 1.0):
        here = loaded & (np.sign(torque) == side)
        if here.any():
            noise[here] -= noise[here].mean()
    if flank:
        loaded &= np.sign(torque) == flank
    return Loops(
        loops.time_s[one][loaded],
        torque[loaded],
        (line + noise)[loaded],
        loops.run[one][loaded],
    )


def repeated_nulls(path: Path) -> list[tuple[str, Loops]]:
    """Every null that the repeats of one file give, each with its name.

    Large ramps give both flanks, the positive and the negative one, each with either sign of
    the noise; small ramps give both flanks of two pairs. Nulls of one file share their noise
    and are no independent draws. Pairs that do not repeat are left out.
    """
    found = []
    large, small = read_loops(path), read_loops(path, large=False)
    for words, loops, smallest, pairs, flanks in (
        ("large", large, 3.0, ((FIRST, SECOND),), (0.0, 1.0, -1.0)),
        ("small", small, 1.0, SMALL_PAIRS, (0.0,)),
    ):
        for pair in pairs:
            if not set(pair) <= set(loops.run.tolist()) or not repeats(
                repeated_null(loops, smallest, pair)
            ):
                continue
            for order in (pair, pair[::-1]):
                for flank in flanks:
                    side = {0.0: "", 1.0: ", positive flank", -1.0: ", negative flank"}[flank]
                    name = f"{words} ramps {order[0]} and {order[1]}{side}"
                    found.append((name, repeated_null(loops, smallest, order, flank)))
    return found


def _branches(loops: Loops) -> list[NDArray[np.int64]]:
    """Readings of one ramp between its turning points."""
    ends = sorted((int(np.argmax(loops.torque_nm)), int(np.argmin(loops.torque_nm))))
    order = np.arange(loops.torque_nm.size)
    return [order[: ends[0]], order[ends[0] : ends[1]], order[ends[1] :]]


def as_template(first: Loops, second: Loops) -> Array:
    """Angle of one ramp at the torques of another, branch by branch [deg].

    What one measured ramp says of the next is the floor below which no model can be expected.
    """
    predicted = np.full(second.torque_nm.size, np.nan)
    for known, asked in zip(_branches(first), _branches(second), strict=True):
        if known.size < 2 or not asked.size:
            continue
        torque, place = np.unique(first.torque_nm[known], return_inverse=True)
        count = np.bincount(place)
        angle = np.bincount(place, first.angle_deg[known]) / count
        predicted[asked] = np.interp(second.torque_nm[asked], torque, angle)
    return predicted


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
    return with_angle(loops, loops.angle_deg + size_deg * signature(name, loops, rng))


def with_angle(loops: Loops, angle_deg: Array) -> Loops:
    """Return the same loops with another angle."""
    return Loops(loops.time_s, loops.torque_nm, angle_deg, loops.run, loops.beyond)


def one_after_the_other(first: Loops, second: Loops, shift: int = 100) -> Loops:
    """Two measurements as one recording, each about its own middle; runs of the second shifted."""
    middle = [0.5 * (x.angle_deg.max() + x.angle_deg.min()) for x in (first, second)]
    later = first.time_s[-1] - second.time_s[0] + 600.0
    return Loops(
        np.concatenate([first.time_s, second.time_s + later]),
        np.concatenate([first.torque_nm, second.torque_nm]),
        np.concatenate([first.angle_deg - middle[0], second.angle_deg - middle[1]]),
        np.concatenate([first.run, second.run + shift]),
        ~np.concatenate([first.counts, second.counts]),
    )


def write_loops(
    loops: Loops,
    folder: Path,
    drive: str,
    conditioning: Sequence[int] = (),
    holdout: Sequence[int] = (),
) -> None:
    """Write loops as a recording.

    Parameters
    ----------
    loops : Loops
        What was measured.
    folder : pathlib.Path
        Where ``recording.csv`` and ``recording.toml`` go.
    drive : str
        Name or file of the drive, as the TOML states it.
    conditioning, holdout : sequence of int
        Ramps that condition the drive, and those kept for the verdict.
    """
    folder.mkdir(parents=True, exist_ok=True)
    loops.frame().write_csv(folder / "recording.csv")
    loops.frame().drop("angle_deg").write_csv(folder / "program.csv")
    lines = ['side = "output"', f'drive = "{drive}"', 'history = "continuous"']
    if conditioning:
        lines.append(f"conditioning_runs = {list(conditioning)}")
    # A programme needs no drive, and what is held out is predicted like any other ramp.
    programme_lines = [line for line in lines if not line.startswith("drive")]
    (folder / "program.toml").write_text("\n".join(programme_lines) + "\n")
    if holdout:
        lines.append(f"holdout_runs = {list(holdout)}")
    if not loops.counts.all():
        lines += ["[score]", "abs_max = { beyond = 0.5 }"]
    (folder / "recording.toml").write_text("\n".join(lines) + "\n")
