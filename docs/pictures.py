"""Draw the pictures of docs/pictures.md, small enough for a page."""

from __future__ import annotations

from pathlib import Path

import cyclosweep as cs
from cyclosweep.figures.active_map import map_figure
from cyclosweep.figures.budget import budget_figure
from cyclosweep.figures.disc import disc_figure
from cyclosweep.figures.parallel import parallel_figure
from cyclosweep.figures.pareto import pareto_figure
from cyclosweep.figures.response import response_figure
from cyclosweep.figures.ring import ring_figure
from cyclosweep.figures.series import clearance_series_figure
from cyclosweep.figures.shares import shares_figure
from cyclosweep.figures.style import save
from cyclosweep.figures.twist import twist_figure

DOCS = Path(__file__).parent
EXAMPLES = DOCS.parent / "examples"
FOLDER = DOCS / "pictures"
DPI = 120
WIDE_DPI = 80
"""Dots of the picture with hundreds of coloured lines, whose file would be large."""


def of_drives() -> None:
    """Write the pictures of the two 87:1 drives."""
    drive = cs.Drive.reference_87()
    loaded = cs.Drive.from_toml(EXAMPLES / "components-87.toml")
    catalogue = cs.Drive.from_toml(EXAMPLES / "catalogue-29.toml")
    budget = cs.compare([loaded, catalogue]).budget
    for name, figure in (
        ("disc", disc_figure(drive)),
        ("map", map_figure(drive)),
        ("map-inside", map_figure(drive, criterion="inside")),
        ("twist", twist_figure(drive)),
        ("shares", shares_figure(loaded)),
        ("ring", ring_figure(loaded, crank_deg=45.0)),
        ("budget", budget_figure(budget)),
        ("clearance-series", clearance_series_figure(loaded)),
    ):
        save(figure, FOLDER / f"{name}.png", dpi=DPI)


def of_studies() -> None:
    """Write the pictures of two studies of a million variants."""
    sobol = cs.Study.from_toml(EXAMPLES / "sobol-8.toml")
    grid = cs.Study.from_toml(EXAMPLES / "grid-87.toml")
    objectives = ["max output_stiffness_nm_per_arcmin", "max hole_web_mm"]
    axes = [
        "output_pin_count",
        "output_pin_circle_radius_mm",
        "output_pin_diameter_mm",
        "hole_web_mm",
        "pin_bending_stress_mpa",
        "output_stiffness_nm_per_arcmin",
    ]
    chosen = cs.pareto_front(sobol, objectives)["variant"][20]
    over = "output_pin_diameter_mm", "shaft_1_diameter_mm", "output_stiffness_nm_per_arcmin"
    save(pareto_figure(sobol, objectives, chosen=[chosen]), FOLDER / "pareto.png", dpi=DPI)
    lines = parallel_figure(sobol, axes, chosen=[chosen])
    save(lines, FOLDER / "parallel.png", dpi=WIDE_DPI)
    save(response_figure(grid, *over), FOLDER / "response.png", dpi=DPI)
    print(f"chosen variant of sobol-8: {chosen}")


def main() -> None:
    """Write all pictures."""
    FOLDER.mkdir(exist_ok=True)
    of_drives()
    of_studies()


if __name__ == "__main__":
    main()
