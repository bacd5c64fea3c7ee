"""Write the tables in docs that come from code: python docs/generate.py."""

from __future__ import annotations

from pathlib import Path

from cyclosweep.design.units import INPUTS, OUTPUTS, Quantity

_HEAD = "| name | symbol | unit | meaning |\n|---|---|---|---|\n"
_SEGMENTS = {
    "shaft_1_diameter_mm": Quantity("D", "mm", "diameter at the free end of segment 1"),
    "shaft_1_end_diameter_mm": Quantity("", "mm", "diameter at the flange end, frustum only"),
    "shaft_1_length_mm": Quantity("l", "mm", "length, each counted once"),
    "shaft_1_keyway_depth_mm": Quantity("h", "mm", "depth of the keyway, keyway only"),
}


def _table(quantities: dict[str, Quantity]) -> str:
    rows = (f"| `{name}` | {q.symbol} | {q.unit} | {q.meaning} |" for name, q in quantities.items())
    return _HEAD + "\n".join(rows) + "\n"


def nomenclature() -> str:
    """Return the page of every input and result."""
    return (
        "# Nomenclature\n\nWritten by `make docs` from `python/cyclosweep/design/units.py`.\n\n"
        "## Inputs: keys of a drive file, axes of a study\n\n"
        + _table(INPUTS)
        + "\nThe shaft's segments count from the free end to the flange:\n\n"
        + _table(_SEGMENTS)
        + "\n## Results: columns of a sweep\n\n"
        + _table(OUTPUTS)
        + "\n`twist_1tn_deg`, `twist_4p5tn_deg`, ...: twist at the input [deg] under 1, 4.5, ... "
        "nominal torques, Eq. (13).\n"
    )


if __name__ == "__main__":
    Path(__file__).with_name("nomenclature.md").write_text(nomenclature(), encoding="utf-8")
