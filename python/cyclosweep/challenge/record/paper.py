"""The pages of record: figures and log from a record's folder, and the pages from those."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cyclosweep.challenge.record.contest import write_pictures
from cyclosweep.challenge.record.contest_page import contest_page
from cyclosweep.challenge.record.parts import Size
from cyclosweep.challenge.record.proof_page import proof_page
from cyclosweep.challenge.record.tables import tables_of

PROOF = "proof"
CONTEST = "contest"


def write_paper(record: Path, docs: Path) -> Path:
    """Write figures, log and page of a record: ``proof`` or, of the contest alone, ``contest``.

    Parameters
    ----------
    record : pathlib.Path
        Folder of the record, scored.
    docs : pathlib.Path
        Where they go: ``<name>.json``, ``<name>-published.jsonl``, and what ``write_page`` writes.
    """
    docs.mkdir(parents=True, exist_ok=True)
    about = json.loads((record / "record.json").read_text())
    name = CONTEST if Size(**about["size"]).is_contest else PROOF
    published, measured = record / "PUBLISHED.jsonl", record / "measured" / "measured.json"
    content = json.loads((record / "score.json").read_text()) | {
        "record": about,
        "tables": tables_of(json.loads((record / "outcomes.json").read_text())),
        "measured": json.loads(measured.read_text()) if measured.exists() else [],
    }
    log = published.read_text() if published.exists() else ""
    (docs / f"{name}-published.jsonl").write_text(log)
    (docs / f"{name}.json").write_text(json.dumps(content, indent=1) + "\n")
    return write_page(docs, name)


def write_pages(docs: Path) -> list[Path]:
    """Write every page again whose figures are there."""
    return [write_page(docs, name) for name in (PROOF, CONTEST) if (docs / f"{name}.json").exists()]


def write_page(docs: Path, name: str) -> Path:
    """Write a page and its pictures from its figures and its log, which lie beside it.

    What ``<name>-notes.md`` says is taken over word for word, with a remark above it where it
    does not name the record's seed. Each of the two pages also shows figures of the other.

    Parameters
    ----------
    docs : pathlib.Path
        Folder of the page.
    name : {"proof", "contest"}
        Which page.
    """
    content = _read(docs / f"{name}.json")
    if content is None:
        raise ValueError(f"{docs / name}.json: missing, expected the figures of a record")
    lines = (docs / f"{name}-published.jsonl").read_text().splitlines()
    log = [json.loads(line) for line in lines]
    notes = _notes(docs / f"{name}-notes.md", content["record"]["seed"])
    if name == CONTEST:
        page = contest_page(content, log, notes, _read(docs / f"{PROOF}.json"))
    else:
        page = proof_page(content, log, notes, _read(docs / f"{CONTEST}.json"))
    write_pictures(content, docs, name)
    file = docs / f"{name}.md"
    file.write_text(page, encoding="utf-8")
    return file


def _read(file: Path) -> dict[str, Any] | None:
    """Figures of a page, where there are any."""
    return json.loads(file.read_text()) if file.exists() else None


def _notes(file: Path, seed: int) -> str:
    """What was written by hand about this record; words about another one say so."""
    if not file.exists():
        return "Nothing has been written yet."
    words = file.read_text().strip()
    if f"seed {seed}" in words:
        return words
    return f"**Not yet rewritten for the record of seed {seed} above.**\n\n{words}"
