"""Recordings made of measured loops: as they are, nulls, effects injected, several causes."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cyclosweep_challenge.measured.loops import (
    CONDITIONING,
    INJECTABLE,
    SECOND,
    Loops,
    injected,
    one_after_the_other,
    read_loops,
    repeated_nulls,
)


@dataclass(frozen=True)
class Variant:
    """One recording made of measured loops.

    Attributes
    ----------
    key : str
        Name of its folder.
    file, kind, detail : str
        Measured file, what was done with it, and to what.
    loops : Loops
        The recording.
    conditioning, holdout : tuple of int
        Ramps that condition the drive, and those kept for the verdict.
    size_deg : float
        Size of an injected effect after re-calibration, as rms [deg].
    without : str
        Effect that the diagnosis may not use; empty for none.
    """

    key: str
    file: str
    kind: str
    detail: str
    loops: Loops
    conditioning: tuple[int, ...] = (CONDITIONING,)
    holdout: tuple[int, ...] = ()
    size_deg: float = 0.0
    without: str = ""


def short_name(file: Path) -> str:
    """Name of a measured file without date and endings."""
    return re.sub(r"^.*torqueramp_+|\.csv(\.gz)?$", "", file.name)


def plain_variant(file: Path, number: int) -> Variant:
    """One measured file, its last ramp kept back for the verdict."""
    return Variant(
        f"file-{number}-plain",
        short_name(file),
        "one ramp",
        "",
        read_loops(file),
        holdout=(SECOND,),
    )


def both_ramps(file: Path, number: int) -> Variant:
    """One measured file with both of its ramps to be fitted."""
    return Variant(f"file-{number}-both", short_name(file), "both ramps", "", read_loops(file))


def null_variants(file: Path, number: int) -> list[Variant]:
    """Every null that the repeats of one file give."""
    return [
        Variant(f"file-{number}-null-{k:02d}", short_name(file), "repeated loops", words, loops, ())
        for k, (words, loops) in enumerate(repeated_nulls(file))
    ]


def shape_rng(seed: int, number: int, name: str) -> np.random.Generator:
    """One shape a file and effect, at every size, so that only the size differs."""
    return np.random.default_rng([seed, number, INJECTABLE.index(name)])


def injected_variants(
    file: Path, number: int, sizes_deg: Sequence[float], seed: int
) -> list[Variant]:
    """One file with each injectable effect laid over it, at each size [deg]."""
    loops = read_loops(file)
    return [
        Variant(
            f"file-{number}-{name}-{size:g}",
            short_name(file),
            "effect injected",
            name,
            injected(loops, name, size, shape_rng(seed, number, name)),
            size_deg=size,
        )
        for name in INJECTABLE
        for size in sizes_deg
    ]


def warm_and_cold(files: Sequence[Path]) -> list[Variant]:
    """One drive run in, warm, at one position, and cold at another, as one recording."""
    warm = [f for f in files if "runin1" in f.name and "910" in f.name]
    cold = [f for f in files if "cold" in f.name and "910" in f.name]
    if not warm or not cold:
        return []
    loops = one_after_the_other(read_loops(warm[0]), read_loops(cold[0]))
    names = f"{short_name(warm[0])} and {short_name(cold[0])}"
    again = (CONDITIONING, CONDITIONING + 100)
    alone = read_loops(warm[0])
    return [
        Variant("warm-and-cold", names, "several causes at once", "", loops, again),
        Variant("warm-alone", short_name(warm[0]), "several causes at once", "warming up", alone),
    ]
