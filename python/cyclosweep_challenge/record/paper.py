"""The pages of record: figures and log from a record's folder, and the pages from those."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from cyclosweep_challenge.record.contest import write_pictures
from cyclosweep_challenge.record.contest_page import contest_page
from cyclosweep_challenge.record.markdown import Plain
from cyclosweep_challenge.record.parts import Size
from cyclosweep_challenge.record.proof_page import proof_page
from cyclosweep_challenge.record.tables import tables_of
from cyclosweep_challenge.scoring.power import PROGRAMMES

PROOF_PAGE = "proof"
CONTEST_PAGE = "contest"
PAGES = (PROOF_PAGE, CONTEST_PAGE, *(f"{CONTEST_PAGE}-{programme}" for programme in PROGRAMMES))


def page_of(size: Size) -> str:
    """Name of the page that a record of this size has."""
    if not size.is_contest:
        return PROOF_PAGE
    return f"{CONTEST_PAGE}-{size.programme}" if size.programme else CONTEST_PAGE


def write_paper(record: Path, docs: Path) -> Path:
    """Write figures, log and page of a record, and all other pages again.

    Each page shows figures of the others, too; those without figures are left out.

    Parameters
    ----------
    record : pathlib.Path
        Folder of the record, scored.
    docs : pathlib.Path
        Where they go: ``<name>.json``, ``<name>-published.jsonl``, the page and its pictures.
    """
    docs.mkdir(parents=True, exist_ok=True)
    about = json.loads((record / "record.json").read_text())
    name = page_of(Size(**about["size"]))
    published, measured = record / "PUBLISHED.jsonl", record / "measured" / "measured.json"
    content = json.loads((record / "score.json").read_text()) | {
        "record": about,
        "tables": tables_of(json.loads((record / "outcomes.json").read_text())),
        "measured": json.loads(measured.read_text()) if measured.exists() else [],
    }
    log = published.read_text() if published.exists() else ""
    (docs / f"{name}-published.jsonl").write_text(log)
    (docs / f"{name}.json").write_text(json.dumps(content, indent=1) + "\n")
    write_pages(docs)
    return docs / f"{name}.md"


def write_pages(docs: Path) -> list[Path]:
    """Write every page again whose figures are there.

    Raises
    ------
    ValueError
        If there are none.
    """
    figures = {
        name: json.loads(file.read_text())
        for name in PAGES
        if (file := docs / f"{name}.json").exists()
    }
    if not figures:
        raise ValueError(f"{docs}: found no figures, expected proof.json or a contest's")
    return [_write_page(docs, name, figures) for name in figures]


def _write_page(docs: Path, name: str, figures: Mapping[str, Plain]) -> Path:
    """Write a page and its pictures from the figures of all pages and the log beside it.

    What ``<name>-notes.md`` says is taken over word for word, with a remark above it where it
    does not name the record's seed.
    """
    content = figures[name]
    published = docs / f"{name}-published.jsonl"
    if not published.exists():
        raise ValueError(f"{published}: missing, expected the log of the record")
    log = [json.loads(line) for line in published.read_text().splitlines()]
    notes = _notes(docs / f"{name}-notes.md", content["record"]["seed"])
    others = {other: there for other, there in figures.items() if other != name}
    if name == PROOF_PAGE:
        page = proof_page(content, log, notes, others)
    else:
        page = contest_page(name, content, log, notes, others)
    write_pictures(content, docs, name)
    file = docs / f"{name}.md"
    file.write_text(page, encoding="utf-8")
    return file


def _notes(file: Path, seed: int) -> str:
    """Notes written by hand about this record, with a remark if they are about another one."""
    if not file.exists():
        return ""
    words = file.read_text().strip()
    if f"seed {seed}" in words:
        return words
    return f"**Not yet rewritten for the record of seed {seed} above.**\n\n{words}"
