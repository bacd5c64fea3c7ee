"""Endings of the names of recordings, one list for all that looks for them."""

__all__ = ["ENDINGS", "WORKBOOKS", "is_recording_name"]

WORKBOOKS = frozenset({"xlsx", "xlsm", "xlsb", "xls", "ods"})
"""Endings of workbooks."""

_TEXTS = frozenset({"csv", "tsv", "txt", "dat", "asc", "lvm", "json", "jsonl"})
"""Endings of texts, which may be compressed (.csv.gz)."""

ENDINGS = _TEXTS | WORKBOOKS | {"parquet", "pq", "tdms", "mat", "h5", "hdf5"}
"""Endings of names that say the format and are not part of a recording's name."""


def is_recording_name(name: str) -> bool:
    """Whether a file of this name in a folder is taken as a recording.

    Hidden files and the lock files of office programs (``~$loop.xlsx``) are none.

    Examples
    --------
    >>> [is_recording_name(n) for n in ("loop.XLS", "loop.csv.gz", "loop.toml", "~$loop.xlsx")]
    [True, True, False, False]
    """
    if name.startswith((".", "~$")):
        return False
    main, _, ending = name.lower().rpartition(".")
    if ending == "gz":
        main, _, ending = main.rpartition(".")
        return bool(main) and ending in _TEXTS
    return bool(main) and ending in ENDINGS
