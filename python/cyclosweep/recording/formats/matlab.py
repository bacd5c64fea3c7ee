"""MATLAB files: version 5 and older by SciPy, version 7.3, which is HDF5, by h5py."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.file_table import GridTable
from cyclosweep.recording.formats.installed import needs
from cyclosweep.recording.formats.tree import tree_table
from cyclosweep.recording.messages import one_line
from cyclosweep.recording.metadata import TableOptions

__all__ = ["read_hdf5", "read_mat5"]

_CURE = (
    "in MATLAB: s = table2struct(T, 'ToScalar', true); save('loop.mat', '-struct', 's') "
    "(a timetable first by timetable2table)"
)


def read_mat5(path: Path, options: TableOptions) -> GridTable:
    """Read a MATLAB file of version 4 to 7.

    Parameters
    ----------
    path : Path
        The file.
    options : TableOptions
        Structure to take.

    Returns
    -------
    GridTable

    Raises
    ------
    InputError
        Damaged, without arrays of samples, or with objects that only MATLAB reads.
    """
    from scipy.io import loadmat

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found: dict[str, Any] = loadmat(path, simplify_cells=True)
    except Exception as error:  # SciPy raises a dozen kinds for damaged files
        raise InputError(f"{path}: not a readable MATLAB file ({one_line(str(error))})") from None
    tree = {k: _plain(v) for k, v in found.items() if not k.startswith("__")}
    tree = {k: v for k, v in tree.items() if v is not None}
    if "__function_workspace__" in found and not any(np.size(v) > 1 for v in tree.values()):
        raise InputError(f"{path}: holds a table or object that only MATLAB reads; {_CURE}")
    return tree_table(path, tree, options.sheet)


def _plain(value: Any) -> Any:
    """Numbers, text, lists and mappings; None for objects of MATLAB."""
    if isinstance(value, dict):
        return {key: plain for key, v in value.items() if (plain := _plain(v)) is not None}
    if isinstance(value, np.ndarray):
        if value.dtype.names or type(value).__name__ == "MatlabOpaque":
            return None
        return value if value.dtype != object else [_plain(v) for v in value.ravel()]
    return value if isinstance(value, str | list | int | float | np.number) else None


def read_hdf5(path: Path, options: TableOptions) -> GridTable:
    """Read a MATLAB file of version 7.3, or another HDF5 file.

    Parameters
    ----------
    path : Path
        The file.
    options : TableOptions
        Group to take.

    Returns
    -------
    GridTable

    Raises
    ------
    InputError
        Not installed, damaged, or without arrays of samples.
    """
    h5py: Any = needs("h5py", path, "save it in MATLAB with the option '-v7'")
    try:
        with h5py.File(path, "r") as file:
            tree = _group(h5py, file)
            opaque = any("MATLAB_object_decode" in item.attrs for item in file.values())
    except Exception as error:  # h5py raises OSError, RuntimeError, KeyError for damage
        raise InputError(f"{path}: not a readable HDF5 file ({one_line(str(error))})") from None
    if opaque and not any(np.size(v) > 1 for v in tree.values()):
        raise InputError(f"{path}: holds a table or object that only MATLAB reads; {_CURE}")
    return tree_table(path, tree, options.sheet)


def _group(h5py: Any, group: Any) -> dict[str, Any]:
    """Arrays and text of a group, with the groups in it.

    Parameters
    ----------
    h5py : module
        The library.
    group : h5py.Group
        The group.

    Returns
    -------
    dict
    """
    tree: dict[str, Any] = {}
    for key, item in group.items():
        if key.startswith("#"):
            continue
        if isinstance(item, h5py.Group):
            tree[key] = _group(h5py, item)
            continue
        if "MATLAB_object_decode" in item.attrs or "MATLAB_empty" in item.attrs:
            continue
        value = _dataset(h5py, group, item)
        if value is not None:
            tree[key] = value
        for name in ("unit", "units", "Unit", "Units"):
            if name in item.attrs:
                unit = item.attrs[name]
                tree[f"{key}@unit"] = unit.decode() if isinstance(unit, bytes) else str(unit)
    return tree


def _dataset(h5py: Any, group: Any, item: Any) -> Any:
    """One array or text of an HDF5 file; None where it is neither.

    Parameters
    ----------
    h5py : module
        The library.
    group : h5py.Group
        Where references lead from.
    item : h5py.Dataset
        The data.

    Returns
    -------
    array, list, str or None
    """
    kind = item.attrs.get("MATLAB_class", b"")
    kind = kind.decode() if isinstance(kind, bytes) else str(kind)
    data = item[()]
    if kind == "char":
        return "".join(map(chr, np.ravel(data)))
    if kind == "cell":
        return [_dataset(h5py, group, group.file[reference]) for reference in np.ravel(data)]
    if isinstance(data, bytes):
        return data.decode("utf-8", "replace")
    if not isinstance(data, np.ndarray):
        return None
    if data.dtype.names:
        return None
    if data.dtype.kind in "OS":
        return [v.decode("utf-8", "replace") if isinstance(v, bytes) else str(v) for v in data.flat]
    if data.dtype.kind not in "fiub":
        return None
    return data.T if kind else data
