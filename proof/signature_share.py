"""Measure how much of each effect's signature the library effect of the same name can represent.

    python proof/signature_share.py --seed 1 --specimens 8

The generator of the proof (the rig) and the diagnosis hold an effect of each name. The rig solves
its effect at contact level; the library has a law with a few shape parameters. For several
specimens this takes the rig's signature, the angle with the effect less the angle without it, at
d = 20, takes out what a free calibration of datum, free play and compliance explains, and fits the
library's columns: every shape of its own grid, two shapes joined where the effect allows that, then
the shape parameters refined. What is left of the norm is the part that the library cannot
represent; times 20 it is the visibility d of that part.

The library sees the true load history and the true state of the drive, and no noise. Shapes that
hold any offset of each run ("free") are left out, because they are no law.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from cyclosweep.simulation.effects import Effect, History, Shape, find
from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import Programme, make_programme
from cyclosweep_challenge.rig.specimen import EITHER_SIGN, VOCABULARY, Specimen
from cyclosweep_challenge.trial.concealment import ConcealmentError, conceal
from cyclosweep_challenge.trial.signature import basis, calibration

Array = NDArray[np.float64]

D = 20.0
"""Visibility at which the signatures are made [-]."""
SIGMA_DEG = 0.2
"""Noise of one reading [deg]."""
PROGRAMMES = ("rich", "poor")
NO_LAW = "free"
"""Key of shapes that describe any set of offsets."""
REFINED = 3
"""Best shapes of the grid from which the refinement starts."""
CONTINUOUS = ("tau_", "kink_", "lag_")
"""Beginnings of further names of shape parameters that are refined."""
DRAWS = 24
"""Specimens drawn at most in search of those that can show an effect, for each that is wanted."""


@dataclass(frozen=True)
class Signature:
    """What an effect of the rig adds, and the load history under which it does.

    Attributes
    ----------
    projected_deg : ndarray, shape (n,)
        Angle with the effect less angle without it, calibration taken out [deg].
    span : ndarray, shape (n, 3)
        Orthonormal basis of what a calibration moves.
    history : History
        True load history and state of the drive.
    """

    projected_deg: Array
    span: Array
    history: History


def make_signature(name: str, programme: str, seed: int) -> Signature:
    """Signature of one effect on one specimen.

    Parameters
    ----------
    name : str
        Effect of the vocabulary.
    programme : str
        Kind of load programme.
    seed : int
        Seed of specimen and programme.

    Raises
    ------
    ConcealmentError
        If this specimen and programme cannot show the effect.
    """
    streams = np.random.default_rng([seed, 20]).spawn(4)
    specimen = Specimen.draw(streams[0])
    path = make_programme(programme, streams[1])
    noise = Noise.draw("white", streams[2], SIGMA_DEG, 0.0)
    sign = float(streams[3].choice([-1.0, 1.0])) if name in EITHER_SIGN else 1.0
    lost = np.zeros(len(path), dtype=bool)
    found = conceal(specimen, path, noise, [name], [D], [sign], lost, {})
    seen = path.take(found.seen)
    span = basis(calibration(seen))
    signature = found.signatures_deg[:, 0]
    angle = found.response.angle_deg[found.seen]
    return Signature(
        signature - span @ (span.T @ signature), span, _history(specimen, seen, angle, find(name))
    )


def _history(specimen: Specimen, path: Programme, angle_deg: Array, effect: Effect) -> History:
    """Load history as the library sees it when the state of the drive is known exactly."""
    side = np.sign(path.torque_nm)
    elastic = path.torque_nm
    if effect.slips:
        # What friction leaves of the applied torque is what twists the drive.
        twist = angle_deg - specimen.datum_deg - side * specimen.free_play_deg
        elastic = twist / specimen.compliance_deg_per_nm
    run = np.unique(path.run, return_inverse=True)[1].astype(np.int64)
    return History(
        applied_nm=path.torque_nm,
        elastic_nm=elastic,
        angle_deg=angle_deg,
        side=side,
        run=run,
        restart=np.diff(run, prepend=-1) != 0,
        compliance_deg_per_nm=specimen.compliance_deg_per_nm,
        free_play_deg=specimen.free_play_deg,
        datum_deg=specimen.datum_deg,
        time_s=path.time_s,
        crank_deg=path.crank_deg,
        temperature_c=path.temperature_c,
    )


def share_left(signature: Signature, effect: Effect) -> tuple[float, float]:
    """Part of a signature's norm that a library effect leaves, by one shape and by joined ones [-].

    Parameters
    ----------
    signature : Signature
        What the rig's effect adds.
    effect : Effect
        Effect of the library.
    """
    history = signature.history
    size = float(np.linalg.norm(signature.projected_deg))

    def left(shape: Shape) -> float:
        return _left(signature, effect, shape) / size

    grid = [
        variant
        for shape in effect.shapes(history)
        if NO_LAW not in shape
        for variant in effect.variants(history, shape)
    ]
    if not grid:
        return 1.0, 1.0
    best = sorted(grid, key=left)[:REFINED]
    joined = [new for other in grid if (new := effect.combined(best[0], other)) is not None]
    single = min(_refined(left, effect, shape) for shape in best)
    both = [_refined(left, effect, shape) for shape in sorted(joined, key=left)[:REFINED]]
    return single, min([single, *both])


def _left(signature: Signature, effect: Effect, shape: Shape) -> float:
    """Norm that the columns of one shape leave, amplitudes of the wrong sign not allowed [deg]."""
    columns = effect.columns(signature.history, shape)
    free = columns - signature.span @ (signature.span.T @ columns)
    norms = np.linalg.norm(free, axis=0)
    used = norms > 1e-9 * np.maximum(np.linalg.norm(columns, axis=0), 1e-12)
    if not used.any() or not np.isfinite(free).all():
        return float(np.linalg.norm(signature.projected_deg))
    bounds = [(p.lower, p.upper) for p in effect.amplitudes(shape)[: columns.shape[1]]]
    low = np.array([0.0 if lower >= 0.0 else -np.inf for lower, _ in bounds])[used]
    fit = optimize.lsq_linear(
        free[:, used] / norms[used], signature.projected_deg, (low, np.inf), method="bvls"
    )
    return float(np.sqrt(2.0 * fit.cost))


def _refined(left: Callable[[Shape], float], effect: Effect, shape: Shape) -> float:
    """Norm left once the continuous parameters of a shape are refined, as a share [-]."""
    limits: dict[str, tuple[float, float]] = {
        p.name: (p.lower, p.upper) for p in effect.shape_parameters
    }
    names = [n for n in shape if n in limits or n.startswith(CONTINUOUS)]
    if not names:
        return left(shape)
    # Positive parameters are varied by factors, others by steps.
    factors = [shape[n] > 0.0 and limits.get(n, (0.0, 0.0))[0] >= 0.0 for n in names]

    def moved(step: Array) -> dict[str, float]:
        values = {
            n: float(shape[n] * np.exp(s) if factor else shape[n] + s)
            for n, s, factor in zip(names, step, factors, strict=True)
        }
        for n, value in values.items():
            lower, upper = limits.get(n, (1e-9, np.inf))
            values[n] = min(max(value, lower), upper)
        return {**shape, **values}

    def objective(step: Array) -> float:
        return left(moved(step))

    start = np.vstack([np.zeros(len(names)), 0.3 * np.eye(len(names))])
    found = optimize.fmin(
        objective,
        start[0],
        initial_simplex=start,
        maxfun=120,
        xtol=1e-3,
        ftol=1e-5,
        disp=False,
    )
    return min(left(moved(found)), left(shape))


def shares(name: str, programme: str, seed: int, specimens: int) -> list[tuple[float, float]]:
    """Parts left on several specimens; fewer where the programme hardly ever shows the effect."""
    effect = find(name)
    found: list[tuple[float, float]] = []
    for draw in range(DRAWS * specimens):
        if len(found) == specimens or (draw >= DRAWS and not found):
            break
        try:
            found.append(share_left(make_signature(name, programme, 1000 * seed + draw), effect))
        except ConcealmentError:
            continue
    return found


def _cells(found: Sequence[tuple[float, float]]) -> str:
    """Median and largest part left by one shape and by joined ones, and the d of the latter."""
    if not found:
        return "– | – | –"
    cells = [
        f"{100 * float(np.median(parts)):.1f} ({100 * max(parts):.1f})"
        for parts in zip(*found, strict=True)
    ]
    return " | ".join([*cells, f"{D * float(np.median([joined for _, joined in found])):.1f}"])


def table(results: Mapping[str, Mapping[str, Sequence[tuple[float, float]]]]) -> str:
    """Markdown table of parts left, by effect and programme."""
    heads = " | ".join(
        f"{p}: one shape, % | shapes joined, % | d left of {D:g}" for p in PROGRAMMES
    )
    lines = [f"| effect | {heads} |", "|---|" + "---|" * (3 * len(PROGRAMMES))]
    for name, row in results.items():
        words = name.replace("_", " ")
        lines.append(f"| {words} | " + " | ".join(_cells(row[p]) for p in PROGRAMMES) + " |")
    return "\n".join(lines)


def main() -> None:
    """Print the table for the whole vocabulary."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--specimens", type=int, default=8)
    parser.add_argument("--effect", action="append", choices=VOCABULARY, default=None)
    given = parser.parse_args()
    print(
        table(
            {
                name: {p: shares(name, p, given.seed, given.specimens) for p in PROGRAMMES}
                for name in given.effect or VOCABULARY
            }
        )
    )


if __name__ == "__main__":
    main()
