"""JSON: arrays by name, a list of samples, columns and data, or one sample a line."""

import json
from pathlib import Path
from typing import Any

from cyclosweep.errors import InputError
from cyclosweep.recording.file_table import GridTable
from cyclosweep.recording.formats.tree import tree_table
from cyclosweep.recording.metadata import TableOptions

__all__ = ["read_json"]


def read_json(path: Path, content: bytes, options: TableOptions) -> GridTable:
    """Read a JSON text.

    Parameters
    ----------
    path : Path
        The file, for messages.
    content : bytes
        Its text in UTF-8.
    options : TableOptions
        Object to take.

    Returns
    -------
    GridTable

    Raises
    ------
    InputError
        Not JSON, or without arrays of samples.
    """
    text = content.decode("utf-8", "replace")
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        try:
            tree = [json.loads(line) for line in text.splitlines() if line.strip()]
        except (ValueError, RecursionError):
            raise InputError(f"{path}: not valid JSON: {error}") from None
    return tree_table(path, _columns_of(path, tree), options.sheet)


def _columns_of(path: Path, tree: Any) -> dict[str, Any]:
    """Make nested arrays by name; lists of samples become arrays.

    Parameters
    ----------
    path : Path
        The file, for messages.
    tree : object
        Content of the file or of a part of it.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        For a list without names, or a single value.
    """
    if isinstance(tree, list):
        samples = [row for row in tree if isinstance(row, dict)]
        if len(samples) != len(tree) or not samples:
            raise InputError(
                f"{path}: a list without names, expected objects such as "
                '{"torque_nm": 1.5, "angle_deg": 30.2}'
            )
        names = dict.fromkeys(name for row in samples for name in row)
        return {name: [row.get(name) for row in samples] for name in names}
    if not isinstance(tree, dict):
        raise InputError(f"{path}: found a single value, expected arrays by name")
    return {
        key: (
            _columns_of(path, value)
            if isinstance(value, dict)
            or (isinstance(value, list) and value and isinstance(value[0], dict))
            else value
        )
        for key, value in tree.items()
    }
