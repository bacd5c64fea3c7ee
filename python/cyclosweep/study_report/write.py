"""Write the report of a study."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cyclosweep.atomic import write_text
from cyclosweep.study_report.gather import gather
from cyclosweep.study_report.page import study_page
from cyclosweep.sweep.tolerances import Tolerances

__all__ = ["report_study"]


def report_study(
    folder: str | Path,
    out: str | Path,
    *,
    objectives: Sequence[str] = (),
    limits: Sequence[str] = (),
    variants: Sequence[int] = (),
    tolerances: Tolerances | None = None,
    progress: bool | None = None,
) -> Path:
    """Write a study as one page that needs nothing else, whatever the study's size.

    Parameters
    ----------
    folder : str or Path
        Where a sweep was written.
    out : str or Path
        HTML file; it appears whole or not at all.
    objectives : sequence of str
        What matters: ``"max output_stiffness_nm_per_arcmin"``, ``"min pin_bending_stress_mpa"``;
        by default the study's own objective and what stands against it.
    limits : sequence of str
        Conditions besides the study's limits, such as ``"hole_web_mm > 3"``.
    variants : sequence of int
        Variants to show besides the best ones.
    tolerances : Tolerances, optional
        How far made pieces deviate; half a percent of each varied dimension is assumed without.
    progress : bool, optional
        Whether there are progress bars; by default on a terminal, after two seconds.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        For a folder without a study, unknown columns, or a variant that is not there.
    OSError
        When the file cannot be written; what was there before is left as it was.

    Examples
    --------
    >>> import tempfile, cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8, 9])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = cs.sink(space, f"{folder}/study")
    ...     page = cs.report_study(f"{folder}/study", f"{folder}/report.html").read_text("utf-8")
    >>> "3 variants" in page
    True
    """
    facts = gather(folder, objectives, limits, variants, tolerances, progress)
    write_text(out, study_page(facts))
    return Path(out)
