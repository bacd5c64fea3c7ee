"""Write the tables in docs that come from code: python docs/generate.py."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import polars as pl

from cyclosweep._moved import MOVED, RENAMED
from cyclosweep.design.part_units import PART_INPUTS, PART_LISTS, PART_OUTPUTS
from cyclosweep.design.units import INPUTS, OUTPUTS, Quantity
from cyclosweep.reference.facts import COUNTED, KINDS
from cyclosweep.reference.rows import broken_rows, broken_table, tally, validate
from cyclosweep.reference.validation import summary, untouched

_HEAD = "| name | symbol | unit | meaning |\n|---|---|---|---|\n"
_SEGMENTS = {
    "shaft_1_diameter_mm": Quantity("D", "mm", "diameter at the free end of segment 1"),
    "shaft_1_end_diameter_mm": Quantity("", "mm", "diameter at the flange end, frustum only"),
    "shaft_1_length_mm": Quantity("l", "mm", "length, each counted once"),
    "shaft_1_keyway_depth_mm": Quantity("h", "mm", "depth of the keyway, keyway only"),
}
_VALIDATION_HEAD = """\
# Validation

Written by `make docs` from what `cyclosweep validate` computes. The same from Python:
`cs.validate()`, and `cs.validate(broken="E halved")` for the model with that error in it.

A row of the validation counts if its two numbers could have come out different. Evidence is what
a named publication prints, and a reader can look it up. Numbers of prototypes and programs, and of
sources whose name was not kept, are counted apart as independent solutions. What a row is worth:

"""
_LINE = """\
## What the reference drive's dimensions mean

The paper prints ratings, counts and the free play of its 87:1 drive, no eccentricity, pin, bush or
shaft. Those of the built-in drive are assumed, can be built, and were chosen so that the loading
line falls into the published band (75 to 80 deg at 2.5 T_N). Agreement of that line with the band
is therefore a choice and no evidence. It follows that the package can say nothing about the 8.5 %
within which the paper's theory meets its measurement at 4 T_N (Fig. 14): with dimensions that are
free, the line could be made to meet any measurement, and the measured points are printed as a
graph only. For the same reason no published number tests the compliance of this drive's shaft and
pins: what catches a wrong Young's modulus below are identities of the formulas, contact stresses
that others print and independent solutions, not a measurement.

"""
_BROKEN = """\
## Models with a deliberate error

One error at a time is put into the model, and every row is computed again. A row is broken if
its numbers then disagree without an explanation. An explanation is about one computed number: a row
that disagrees already, and says why, is broken by an error that makes another number of it. None of
the errors may break nothing; a test says so.

"""


def _grid(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return (
        "\n".join(f"| {' | '.join(c.replace('|', '/') for c in line)} |" for line in lines) + "\n"
    )


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
        "nominal torques, Eq. (13);\n`twist_minus_4p5tn_deg` under a load of -4.5: in the other "
        "direction, the negative of the twist under 4.5.\n"
        + "\n## Inputs of the component model\n\n[components.md](components.md) says what they "
        "mean together. The second table's keys are no axes.\n\n"
        + _table(PART_INPUTS)
        + "\n"
        + _table(PART_LISTS)
        + "\n## Results of the component model\n\n"
        + _table(PART_OUTPUTS)
    )


def moved() -> str:
    """Return the page of what is imported from elsewhere now."""
    modules = ((f"`{old}`", f"`{new}`") for old, new in sorted(MOVED.items()))
    names = ((f"`{old}`", f"`{new}`") for old, new in sorted(RENAMED.items()))
    return (
        "# What moved since version 0.1\n\n"
        "Written by `make docs` from `python/cyclosweep/_moved.py`. What `import cyclosweep as cs` "
        "gives has not\nmoved: the names in `cs`, the commands and their options, the files and "
        "their keys. What moved are\nmodules inside the package. Importing one by its old name "
        "still works and gives a\n`DeprecationWarning` that says the new one. Names inside the "
        "modules of `diagnosis` that are not listed\nbelow were internal and may be gone.\n\n"
        "## Modules\n\n"
        + _grid(("old", "now"), modules)
        + "\n## Names that did not go where their module went, or are called otherwise\n\n"
        + _grid(("old", "now"), names)
    )


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"


def _remark(note: str, explanation: str) -> str:
    return ". ".join(part for part in (note, explanation and f"Why not: {explanation}") if part)


def _counted_rows(table: pl.DataFrame) -> str:
    head = ("row", "expected", "computed", "unit", "agrees", "remark", "where the number is from")
    parts = []
    for kind in COUNTED:
        rows = (
            (
                row["fact"],
                _number(row["published"]),
                _number(row["computed"]),
                row["unit"],
                "yes" if row["ok"] else "no",
                _remark(row["note"], row["explanation"]),
                row["source"] or "worked out by hand",
            )
            for row in table.filter(kind=kind).iter_rows(named=True)
        )
        parts.append(f"### {kind.capitalize()}\n\n{_grid(head, rows)}")
    return "\n".join(parts)


def _uncounted_rows(table: pl.DataFrame) -> str:
    head = ("row", "expected", "computed", "unit", "kind", "remark")
    rows = table.filter(~pl.col("counted")).iter_rows(named=True)
    return _grid(
        head,
        (
            (
                row["fact"],
                _number(row["published"]),
                _number(row["computed"]),
                row["unit"],
                row["kind"],
                row["note"],
            )
            for row in rows
        ),
    )


def _broken_tables() -> str:
    rows = broken_rows()
    head = ("error", "what is wrong", *COUNTED)
    table = _grid(
        head,
        (
            (row["model"], row["error"], *(str(row[kind]) for kind in COUNTED))
            for row in broken_table(rows).iter_rows(named=True)
        ),
    )
    errors = [name for name in rows.columns if name not in ("kind", "group", "fact")]
    by_row = _grid(
        ("counted row", "kind", "broken by"),
        (
            (row["fact"], row["kind"], ", ".join(e for e in errors if row[e]) or "none of these")
            for row in rows.iter_rows(named=True)
        ),
    )
    left = "; ".join(untouched(rows)) or "no row"
    return (
        f"{table}\nThe other way round: which errors break a row. Broken by none of them: {left}."
        "\n\n"
        f"{by_row}"
    )


def validation() -> str:
    """Return the page on what is compared with what, and what deliberate errors break."""
    table = validate()
    counts = tally(table)
    kinds = (
        (
            kind,
            meaning,
            "yes" if kind in COUNTED else "no",
            *(str(counts[kind][n]) for n in ("agree", "explained", "undecided")),
        )
        for kind, meaning in KINDS.items()
    )
    head = ("kind", "meaning", "counts", "agree", "disagree, explained", "nothing to decide")
    return (
        _VALIDATION_HEAD
        + _grid(head, kinds)
        + "\n"
        + "\n".join(f"* {line}" for line in summary(counts).splitlines())
        + "\n\n"
        + _LINE
        + _BROKEN
        + _broken_tables()
        + "\n## Rows that count\n\n"
        + _counted_rows(table)
        + "\n## Rows that do not count\n\n"
        + _uncounted_rows(table)
    )


PAGES = {"nomenclature": nomenclature, "validation": validation, "moved": moved}

if __name__ == "__main__":
    for name, page in PAGES.items():
        Path(__file__).with_name(f"{name}.md").write_text(page(), encoding="utf-8")
