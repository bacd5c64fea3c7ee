"""Files of a study's folder: what a part's footer and the manifest say, and how they are read."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

import polars as pl

from cyclosweep.errors import InputError, path_of

__all__ = [
    "FOOTER",
    "FORMAT",
    "FORMER_MANIFEST",
    "MANIFEST",
    "is_foreign",
    "parts_of",
    "read_footer",
    "read_manifest",
    "scan_dataset",
]

FOOTER = "cyclosweep"
"""Key of a Parquet footer under which a part says what it is."""
FORMAT = "cyclosweep.dataset/1"
MANIFEST = "_manifest.json"
FORMER_MANIFEST = "manifest.json"
"""Its name before: without an underscore other programs read it as a part."""


def read_footer(path: Path) -> dict[str, Any] | None:
    """Read what cyclosweep wrote into a Parquet footer; None for a broken or foreign file."""
    try:
        text = pl.read_parquet_metadata(path).get(FOOTER)
        footer = json.loads(text) if text is not None else None
    except (OSError, ValueError, pl.exceptions.PolarsError):
        return None
    return footer if isinstance(footer, dict) and footer.get("format") == FORMAT else None


def read_manifest(folder: Path) -> dict[str, Any] | None:
    """Read a study's manifest, also under its former name; None where it is missing or broken."""
    found = (_manifest_at(folder / name) for name in (MANIFEST, FORMER_MANIFEST))
    return next(filter(None, found), None)


def _manifest_at(path: Path) -> dict[str, Any] | None:
    with contextlib.suppress(OSError, ValueError):
        manifest = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(manifest, dict):
            return manifest
    return None


def is_foreign(path: Path) -> bool:
    """Whether a part or manifest is not of a sweep, so that it must not be touched.

    A broken part and a broken manifest of today's name are not told from those of others.
    """
    if path.suffix == ".json":
        manifest = _manifest_at(path) or {}
        return path.name == FORMER_MANIFEST and manifest.get("format") != FORMAT
    try:
        return FOOTER not in pl.read_parquet_metadata(path)
    except (OSError, pl.exceptions.PolarsError):
        return False


def parts_of(folder: Path) -> list[Path]:
    """All whole parts in a folder, in order of their variants."""
    found = sorted(folder.glob("part-*.parquet"), key=lambda path: (len(path.name), path))
    return [path for path in found if read_footer(path) is not None]


def scan_dataset(folder: str | Path) -> pl.LazyFrame:
    """Read a finished or unfinished study lazily.

    Parameters
    ----------
    folder : str or Path
        Where a sweep was written.

    Returns
    -------
    polars.LazyFrame
        Rows of all whole parts, in order of their variants.

    Raises
    ------
    InputError
        When the folder holds no part of a study.
    """
    paths = parts_of(path_of("folder", folder))
    if not paths:
        raise InputError(f"{folder}: no parts of a study there")
    return pl.scan_parquet(paths)
