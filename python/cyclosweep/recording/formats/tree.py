"""Nested names and arrays, as MATLAB, HDF5 and JSON files hold them, as one table."""

from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.file_table import GridTable

__all__ = ["tree_table"]

MOST_COLUMNS = 64
"""Widest matrix whose columns are taken for signals."""

_NAMES = ("colheaders", "columns", "names", "header", "headers")


def tree_table(path: Path, tree: Mapping[str, Any], sheet: str | None) -> GridTable:
    """Make a table of the arrays of one length, the largest such group.

    Parameters
    ----------
    path : Path
        The file, for messages.
    tree : mapping
        Arrays, lists and text by name; mappings of the same for structures.
    sheet : str or None
        Structure to take, dotted where it lies in another.

    Returns
    -------
    GridTable

    Raises
    ------
    InputError
        No array has two values, or the structure is not there.
    """
    branch: Any = tree
    for part in (sheet or "").split(".") if sheet else ():
        if not isinstance(branch, Mapping) or part not in branch:
            raise InputError(
                f"{path}, key table.sheet: found {sheet!r}, expected one of "
                f"{', '.join(k for k, v in tree.items() if isinstance(v, Mapping)) or 'none'}"
            )
        branch = branch[part]
    leaves: dict[str, Any] = {}
    texts: dict[str, str] = {}
    for name, value in _leaves(branch):
        if isinstance(value, str):
            texts[name] = value
        else:
            leaves[name] = value
    lengths = Counter({n: 0 for n in map(len, leaves.values()) if n > 1})
    for value in leaves.values():
        if len(value) > 1:
            lengths[len(value)] += len(value)
    if not lengths:
        raise InputError(f"{path}: no array of samples, expected torque and angle of equal length")
    length = max(lengths, key=lambda n: lengths[n])
    chosen = {name: value for name, value in leaves.items() if len(value) == length}
    left = [name for name in leaves if name not in chosen and len(leaves[name]) > 1]
    short = _short_names(list(chosen))
    columns = {short[name]: value for name, value in chosen.items()}
    units = {
        short[name]: texts[key]
        for name in chosen
        for key in (f"{name}.unit", f"{name}@unit", *_unit_keys(name))
        if key in texts
    }
    notes = []
    if left:
        notes.append(
            f"{length} values each in {', '.join(columns)}; of another length and left out: "
            f"{', '.join(left[:6])}{' ...' if len(left) > 6 else ''}."
        )
    return GridTable(path, columns, units, notes)


def _leaves(branch: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Go through arrays and text by dotted name; a matrix gives a column each.

    Parameters
    ----------
    branch : mapping or array or list or str
        What to go through.
    prefix : str
        Dotted name of it.

    Yields
    ------
    str, array or list or str
    """
    if isinstance(branch, Mapping):
        for key, value in branch.items():
            yield from _matrix_or_leaf(str(key), value, branch, prefix)
    elif isinstance(branch, str):
        yield prefix.removesuffix("."), branch
    elif isinstance(branch, list | np.ndarray) and len(np.shape(branch)[:1]):
        yield prefix.removesuffix(".") or "values", branch


def _matrix_or_leaf(
    key: str, value: Any, siblings: Mapping[str, Any], prefix: str
) -> Iterator[tuple[str, Any]]:
    """Divide a matrix into named columns; hand anything else on.

    Parameters
    ----------
    key : str
        Name of the value.
    value : object
        The value.
    siblings : mapping
        Where names of its columns may stand.
    prefix : str
        Dotted name of what holds it.

    Yields
    ------
    str, array or list or str
    """
    rows = value
    if isinstance(value, list) and value and all(isinstance(row, list) for row in value):
        widths = {len(row) for row in value}
        rows = np.array(value, dtype=object) if len(widths) == 1 else value
    if not (isinstance(rows, np.ndarray) and rows.ndim == 2):
        yield from _leaves(value, f"{prefix}{key}.")
        return
    if rows.shape[0] < rows.shape[1] and rows.shape[0] <= MOST_COLUMNS < rows.shape[1]:
        rows = rows.T
    if rows.shape[1] == 1 or rows.shape[0] == 1:
        yield f"{prefix}{key}", rows.ravel()
        return
    if rows.shape[1] > MOST_COLUMNS:
        return
    names = next(
        (
            [str(name).strip() for name in np.ravel(np.array(siblings[k], dtype=object))]
            for k in siblings
            if k.casefold() in _NAMES and np.size(siblings[k]) == rows.shape[1]
        ),
        [f"{key}_{k + 1}" for k in range(rows.shape[1])],
    )
    for name, column in zip(names, rows.T, strict=True):
        yield f"{prefix}{name}", column if column.dtype != object else list(column)


def _short_names(names: list[str]) -> dict[str, str]:
    """Last part of dotted names where that is enough to tell them apart."""
    tails = [
        name.removesuffix(".values").removesuffix(".data").rsplit(".", 1)[-1] for name in names
    ]
    count = Counter(tails)
    return {n: t if count[t] == 1 and t else n for n, t in zip(names, tails, strict=True)}


def _unit_keys(name: str) -> list[str]:
    """Names under which the unit of an array may stand."""
    head, dot, tail = name.rpartition(".")
    stem = f"{head}{dot}"
    outer = head.rpartition(".")[0]
    above = f"{outer}." if outer else ""
    found = [f"{stem}{word}" for word in ("unit", "units")] if tail in ("values", "data") else []
    for base in {stem, above}:
        found += [f"{base}units.{tail}", f"{base}unit.{tail}"]
    return [*found, f"{name}_unit", f"{name}_units"]
