"""Command line: torque-twist curves in, a recording and apart from it its truth out."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from cyclosweep_challenge.component_rig.rig import Curve, record


def write_recording(
    curves: dict[float, Path],
    out: Path,
    *,
    drive: str,
    seed: int,
    samples: int = 600,
    noise_deg: float = 0.1,
    resolution_deg: float = 0.1,
) -> None:
    """Write ``recording.csv`` and its metadata, and the truth beside the folder.

    Parameters
    ----------
    curves : dict
        Files of ``cyclosweep torque-twist`` by the angle of the crank in the middle [deg].
    out : pathlib.Path
        Folder to write to.
    drive : str
        Drive that the metadata names: a built-in one or a file.
    seed : int
        Seed of the noise.
    samples : int
        Readings of each run.
    noise_deg, resolution_deg : float
        Standard deviation of a reading and step of the dial [deg].

    Raises
    ------
    ValueError
        For a file that is no curve with friction.
    """
    read = {crank: Curve.read(path) for crank, path in curves.items()}
    rng = np.random.default_rng(seed)
    table = record(read, rng, samples, noise_deg=noise_deg, resolution_deg=resolution_deg)
    out.mkdir(parents=True, exist_ok=True)
    table.drop("clean_deg").write_csv(out / "recording.csv")
    (out / "recording.toml").write_text(
        f'side = "input"\ndrive = {json.dumps(drive)}\nangle_resolution_deg = {resolution_deg:g}\n'
    )
    truth = {
        "drive": drive,
        "curves": {f"{crank:g}": path.name for crank, path in sorted(curves.items())},
        "noise_deg": noise_deg,
        "resolution_deg": resolution_deg,
        "seed": seed,
        "clean_deg": table["clean_deg"].to_list(),
    }
    out.with_name(out.name + "-truth.json").write_text(json.dumps(truth) + "\n")


def _curve(text: str) -> tuple[float, Path]:
    crank, _, path = text.partition("=")
    return float(crank), Path(path)


def main() -> None:
    """Write a recording."""
    parser = argparse.ArgumentParser(
        prog="python -m cyclosweep_challenge.component_rig", description=__doc__
    )
    parser.add_argument("curves", nargs="+", type=_curve, metavar="CRANK_DEG=CURVE.csv")
    parser.add_argument("--drive", default="reference-87")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--samples", type=int, default=600)
    parser.add_argument("--noise-deg", type=float, default=0.1)
    parser.add_argument("--resolution-deg", type=float, default=0.1)
    parser.add_argument("--out", type=Path, default=Path("component-rig"))
    given = parser.parse_args()
    write_recording(
        dict(given.curves),
        given.out,
        drive=given.drive,
        seed=given.seed,
        samples=given.samples,
        noise_deg=given.noise_deg,
        resolution_deg=given.resolution_deg,
    )
