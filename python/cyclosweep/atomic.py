"""Writing of files so that each appears whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

__all__ = ["nearest_existing", "unfinished", "write_bytes", "write_text"]

NO_SPACE_LEFT = 2**20
"""Free bytes below which a file that could not be written has met a full disk."""


@contextlib.contextmanager
def unfinished(path: str | Path) -> Iterator[Path]:
    """Give a temporary file beside a file, and put it in that file's place when it is written.

    Parameters
    ----------
    path : str or Path
        The file to write. A link is followed; what is no regular file, as a pipe or
        ``/dev/stdout``, is written directly.

    Yields
    ------
    Path
        The temporary file, in the same folder, named ``.<name>.<host>-<process>-<thread>.tmp``:
        programs that read a folder of Parquet files pass over names with a leading dot.

    Raises
    ------
    OSError
        When it cannot be written or moved. What was at `path` before is still there then, and
        the temporary file is not.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with unfinished(Path(folder) / "table.csv") as file:
    ...         _ = file.write_text("a,b")
    ...     [entry.name for entry in Path(folder).iterdir()]
    ['table.csv']
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        yield target
        return
    writer = f"{socket.gethostname()}-{os.getpid()}-{threading.get_native_id()}"
    temporary = target.with_name(f".{target.name}.{writer}.tmp")
    try:
        yield temporary
        os.replace(temporary, target)
    except OSError as error:
        if error.filename is not None and str(error.filename) != str(temporary):
            raise  # of another file
        number = error.errno or _number_in(str(error))
        if number is None:
            raise OSError(f"{target}: {error}") from error
        raise OSError(number, os.strerror(number), str(target)) from error
    except Exception as error:
        # A library that writes may say of a full disk that the file is broken.
        if shutil.disk_usage(target.parent).free >= NO_SPACE_LEFT:
            raise
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(target)) from error
    finally:
        with contextlib.suppress(OSError):  # not there, or not even its folder
            temporary.unlink()


def _number_in(text: str) -> int | None:
    """Number of the system's error in the words of a library in Rust."""
    found = re.search(r"\(os error (\d+)\)", text)
    return int(found[1]) if found else None


def write_text(path: str | Path, text: str) -> None:
    """Write a text file in UTF-8, whole or not at all.

    Parameters
    ----------
    path : str or Path
        The file.
    text : str
        Its content.

    Raises
    ------
    OSError
        When it cannot be written; what was there before is left as it was.
    """
    with unfinished(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_bytes(path: str | Path, content: bytes) -> None:
    """Write a binary file, whole or not at all.

    Parameters
    ----------
    path : str or Path
        The file.
    content : bytes
        Its content.

    Raises
    ------
    OSError
        When it cannot be written; what was there before is left as it was.
    """
    with unfinished(path) as temporary:
        temporary.write_bytes(content)


def nearest_existing(path: Path) -> Path:
    """What is there of a path: itself, or else the last of its parents that exists."""
    return next(each for each in (path, *path.absolute().parents) if each.exists())
