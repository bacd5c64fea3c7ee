"""How often look-alikes can be named at all, by a classifier that knows what nobody can know.

``python benches/naming_ceiling.py [--cases N] [--seed S] [--shapes K]`` conceals effects that are a
curve of the torque alone and look alike, and names them twice: by the diagnosis, and by Bayes' rule
with the rig's own distribution of shapes (``K`` more specimens of every effect, put through the
rig), the specimen's calibration and the visibility given. What the second cannot name, no
diagnosis can, except by luck.
"""

from __future__ import annotations

import argparse
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

import cyclosweep as cs
from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import make_programme
from cyclosweep_challenge.rig.specimen import EITHER_SIGN, VOCABULARY, Specimen
from cyclosweep_challenge.trial.case import Case
from cyclosweep_challenge.trial.concealment import ConcealmentError, conceal
from cyclosweep_challenge.trial.plan import Entry, make_entry, make_plan

PART = {
    "load_asymmetry": "side_load",
    "dial_eccentricity": "dial",
    "clearance_takeup": "pins",
    "contact_stiffening": "pins",
    "overload_softening": "joint",
}
"""Look-alikes, and the part of a specimen that holds the shape of each."""
VISIBLE = (10.0, 20.0)


@dataclass(frozen=True)
class Named:
    """True cause of one recording, its visibility, and the names given."""

    cause: str
    d: float
    knowing: str
    diagnosed: tuple[str, ...]


def main() -> int:
    """Make, name and count; the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=1200, help="length of the plan looked through")
    parser.add_argument("--seed", type=int, default=90)
    parser.add_argument("--shapes", type=int, default=400)
    parser.add_argument("--workers", type=int, default=2)
    told = parser.parse_args()
    entries = [e for e in make_plan(told.cases, told.seed, "open") if _looked_at(e)]
    with ProcessPoolExecutor(told.workers) as pool:
        found = [n for n in pool.map(partial(_named, shapes=told.shapes), entries) if n]
    print(f"{len(found)} recordings of seed {told.seed}, {told.shapes} shapes of every effect")
    for d in VISIBLE:
        for cause in (*PART, ""):
            there = [n for n in found if round(n.d) == d and cause in ("", n.cause)]
            knowing = sum(n.knowing == n.cause for n in there)
            diagnosed = sum(n.diagnosed == (n.cause,) for n in there)
            print(
                f"d = {d:g}  {cause or 'all of them':20} {len(there):4}  "
                f"knowing {knowing:4}  diagnosed {diagnosed:4}"
            )
        missed = 1.0 - knowing / max(len(there), 1)
        print(
            f"d = {d:g}  if every other effect were always named, of all "
            f"{1.0 - missed * len(PART) / len(VOCABULARY):.3f} at most"
        )
    return 0


def _looked_at(entry: Entry) -> bool:
    """Whether a recording will, unless it is drawn again, hold a look-alike at a wanted d."""
    stratum = entry.stratum
    cause = VOCABULARY[entry.turn % len(VOCABULARY)]
    return stratum.programme == "rich" and stratum.d[0] in VISIBLE and cause in PART


def _named(entry: Entry, shapes: int) -> Named | None:
    """Name one recording by both."""
    case = make_entry(entry)
    (cause,) = case.truth["effects"]
    if cause not in PART:
        return None
    with tempfile.TemporaryDirectory() as folder:
        case.write(folder, program=False)
        recording = cs.Recording.read(Path(folder) / "recording.csv")
        said = cs.diagnose(recording, full=False)
    names = tuple(e["name"] for e in said.effects) if said.verdict == "IDENTIFIED" else ()
    d = float(case.truth["causes"][0]["d"])
    return Named(cause, d, _by_bayes(case, entry, d, shapes), names)


def _by_bayes(case: Case, entry: Entry, d: float, shapes: int) -> str:
    """Most probable look-alike, every one and every shape of it as likely as any other."""
    truth = case.truth
    streams = np.random.default_rng(truth["seed"]).spawn(6)
    specimen = Specimen.draw(streams[0])
    programme = make_programme(entry.stratum.programme, streams[1], entry.samples)
    noise = Noise(sigma_deg=truth["noise"]["sigma_deg"])
    lost = np.zeros(len(programme), dtype=bool)
    read = case.recording["angle_deg"].to_numpy() / noise.sigma_deg
    rng = np.random.default_rng([truth["seed"], 5])
    odds = {}
    for cause, part in PART.items():
        each = []
        for other in (Specimen.draw(one) for one in rng.spawn(shapes)):
            drawn = replace(specimen, **{part: getattr(other, part)})
            try:
                found = conceal(drawn, programme, noise, [cause], [d], [1.0], lost, {})
            except ConcealmentError:
                continue
            match = d * float(found.visibility.direction[:, 0] @ read)
            either = cause in EITHER_SIGN
            each.append(np.logaddexp(match, -match) - np.log(2.0) if either else match)
        odds[cause] = np.logaddexp.reduce(each) - np.log(len(each)) if each else -np.inf
    return max(odds, key=lambda name: odds[name])


if __name__ == "__main__":
    raise SystemExit(main())
