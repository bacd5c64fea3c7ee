"""The project's own library and noise for the opponents: tells the library's part from the search.

The only opponent's file that imports the diagnosis: preparing of a recording, its library and its
estimate of the noise, nothing of its search.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cyclosweep.diagnosis.calibrate import noise_beyond
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.inputs import considered_effects, drive_of
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.diagnosis.prepare.problem import line_design, prepare
from cyclosweep.recording import Recording
from cyclosweep_challenge.opponents.lasso import lasso_cv
from cyclosweep_challenge.opponents.stlsq import stlsq
from cyclosweep_challenge.opponents.subset import bic_subset
from cyclosweep_challenge.opponents.view import Reply, without_duplicates

Array = NDArray[np.float64]

PROJECT, WHITENED = "project", "whitened"
"""Libraries of an opponent: the project's, and the same with everything whitened by its noise."""
REGRESSIONS: dict[str, Callable[..., Reply]] = {
    "bic_subset": bic_subset,
    "lasso_cv": lasso_cv,
    "stlsq": stlsq,
}
"""Opponents that take any library; by themselves they have the textbook's."""
NAMES = tuple(f"{name}_{kind}" for name in REGRESSIONS for kind in (PROJECT, WHITENED))


@dataclass(frozen=True)
class ProjectView:
    """A recording with the project's library.

    Attributes
    ----------
    residual : ndarray, shape (n,)
        Angle left over by the calibrated baseline, whitened or not [deg].
    library : tuple
        Columns of all shapes of all named effects without the baseline, and their effects.
    """

    residual: Array
    library: tuple[Array, list[str]]


def project_views(folder: Path) -> dict[str, ProjectView]:
    """Read a recording as the project prepares it, plain and whitened.

    Parameters
    ----------
    folder : pathlib.Path
        Folder of the recording.
    """
    recording = Recording.read(folder / "recording.csv")
    drive = drive_of(recording)
    problem = prepare(recording, drive.nominal_line(recording.side), int(drive.output_pin_count))
    library = build_library(problem.history, problem.fitted, considered_effects(()))
    noise = noise_beyond(problem, library, None)
    line = line_design(problem.history, problem.history.applied_nm, one_sided=problem.one_sided)
    named = [
        (signature.hypothesis, k)
        for signature in library.signatures
        if signature.named
        for k in range(signature.first, signature.stop)
    ]
    names = [name for name, _ in named]
    columns = library.columns[:, [k for _, k in named]]
    use = problem.fitted

    def view(turned: Callable[[Array], Array]) -> ProjectView:
        baseline = orthonormal(turned(line[use]))
        angle = turned(problem.angle_deg[use])
        table = without_duplicates(turned(columns), baseline, names)
        return ProjectView(angle - baseline @ (baseline.T @ angle), table)

    return {PROJECT: view(lambda rows: rows), WHITENED: view(noise.whiten)}


def replies(folder: Path, names: tuple[str, ...]) -> dict[str, Reply]:
    """Replies of opponents with the project's library.

    Parameters
    ----------
    folder : pathlib.Path
        Folder of the recording.
    names : tuple of str
        Which of ``NAMES``.
    """
    views = project_views(folder) if names else {}
    found = {}
    for name in names:
        opponent, kind = name.rsplit("_", 1)
        found[name] = REGRESSIONS[opponent](views[kind])
    return found
