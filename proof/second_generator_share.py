"""Measure how much of the signature of each law of the second generator the library represents.

    python -m proof.second_generator_share --seed 1 --specimens 2

The same measure as proof/signature_share.py: the angle with a law less the angle without it on a
rich programme, what a free calibration explains taken out, and of the rest the part of the norm
that the library effect of the same name leaves, by one shape of its grid and by two joined ones,
both refined. Times 20 it is the visibility of that part where the law itself has d = 20.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from cyclosweep.simulation.effects import Effect, History, find
from cyclosweep_challenge.second_generator.bench import Answer
from cyclosweep_challenge.second_generator.case import show_one
from cyclosweep_challenge.second_generator.drive import Specimen
from cyclosweep_challenge.second_generator.laws.catalogue import LAWS, VOCABULARY
from cyclosweep_challenge.second_generator.laws.law import Law
from cyclosweep_challenge.second_generator.path import Path
from cyclosweep_challenge.second_generator.reach import CannotShowError
from cyclosweep_challenge.second_generator.visibility import without
from proof.signature_share import D, Signature, share_left

ROWS = 3000
"""Readings of a recording on which a signature is made."""
DRAWS = 8
"""Specimens drawn at most in search of those that show a law, for each that is wanted."""


def make_signature(law: Law, seed: int) -> Signature:
    """Signature of one law on one specimen.

    Parameters
    ----------
    law : Law
        Law of the second generator.
    seed : int
        Seed of specimen, programme and shape.

    Raises
    ------
    CannotShowError
        If this specimen cannot show the law.
    """
    specimen, path, answer, signature, free = show_one(law, D, (seed, 31), ROWS)
    left = without(signature[:, None], free)[:, 0]
    span = np.linalg.svd(free / np.linalg.norm(free, axis=0), full_matrices=False)[0]
    return Signature(left, span, _history(specimen, path, answer, find(law.effect)))


def _history(specimen: Specimen, path: Path, answer: Answer, effect: Effect) -> History:
    """Load history as the library sees it when the state of the drive is known exactly."""
    applied = path.load * specimen.rated_nm
    run = np.unique(path.run, return_inverse=True)[1].astype(np.int64)
    return History(
        applied_nm=applied,
        elastic_nm=answer.twist * specimen.rated_nm if effect.slips else applied,
        angle_deg=answer.angle_deg,
        side=answer.side,
        run=run,
        restart=np.diff(run, prepend=-1) != 0,
        compliance_deg_per_nm=specimen.compliance_deg_per_nm,
        free_play_deg=specimen.play_deg,
        datum_deg=specimen.datum_deg,
        time_s=path.time_s,
        crank_deg=path.crank_deg,
        temperature_c=path.temperature_c,
    )


def shares(law: Law, seed: int, specimens: int) -> list[tuple[float, float]]:
    """Parts left on several specimens; fewer where hardly any shows the law."""
    effect = find(law.effect)
    found: list[tuple[float, float]] = []
    for draw in range(DRAWS * specimens):
        if len(found) == specimens:
            break
        try:
            found.append(share_left(make_signature(law, 1000 * seed + draw), effect))
        except CannotShowError:
            continue
    return found


def line(law: Law, found: Sequence[tuple[float, float]]) -> str:
    """One line of the table: median and largest part represented by joined shapes, d left."""
    if not found:
        return f"| `{law.effect}` | {law.name} | – | – | – |"
    single, joined = (np.array(parts) for parts in zip(*found, strict=True))
    cells = [
        f"{100.0 * (1.0 - float(np.median(single))):.1f}",
        f"{100.0 * (1.0 - float(np.median(joined))):.1f}"
        f" ({100.0 * (1.0 - float(joined.max())):.1f})",
        f"{D * float(np.median(joined)):.1f}",
    ]
    return f"| `{law.effect}` | {law.name} | " + " | ".join(cells) + " |"


def main() -> None:
    """Print the table for all laws."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--specimens", type=int, default=2)
    parser.add_argument("--effect", action="append", choices=VOCABULARY, default=None)
    given = parser.parse_args()
    print(
        "| effect | law | represented by one shape, % | by joined shapes, % (least) "
        f"| d left of {D:g} |\n|---|---|---|---|---|",
        flush=True,
    )
    for law in LAWS:
        if given.effect is None or law.effect in given.effect:
            print(line(law, shares(law, given.seed, given.specimens)), flush=True)


if __name__ == "__main__":
    main()
