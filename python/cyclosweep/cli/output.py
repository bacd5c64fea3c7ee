"""How commands print and fail."""

from __future__ import annotations

import codecs
import contextlib
import io
import json
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from cyclosweep.atomic import nearest_existing
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    from rich.console import RenderableType

__all__ = [
    "INTERRUPTED",
    "AsJson",
    "fail",
    "folder_named",
    "interruptible",
    "print_json",
    "print_tables",
    "refuse_drive_name",
    "refuse_folder",
    "refuse_output",
    "refuse_overwriting",
    "refuse_table",
]

MOMENT_S = 0.02
"""Time after which an interruption that Python ignored is made once more [s]."""
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object, nothing else.")]


SPELT = {
    "→": "->", "–": "-", "—": "-", "−": "-", "…": "..", "•": "*", "×": "x", "·": "|", "±": "+/-",
    "∞": "inf", "²": "2", "σ": "sigma", "°": " deg", "µ": "u", "μ": "u", "\N{NO-BREAK SPACE}": " ",
    "\N{NARROW NO-BREAK SPACE}": " ", "\N{THIN SPACE}": " ", "⁻": "^-",
    **dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789", strict=True)),
}  # fmt: skip
"""Signs that a terminal's encoding may lack, and what is printed then."""


def survive_encoding() -> None:
    """Print signs that the terminal's encoding lacks in other words instead of failing."""

    def spelt(error: UnicodeError) -> tuple[str, int]:
        if not isinstance(error, UnicodeEncodeError):
            raise error
        missing = error.object[error.start : error.end]
        return "".join(SPELT.get(sign, "?") for sign in missing), error.end

    codecs.register_error("cyclosweep.spelt", spelt)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and not stream.encoding.lower().startswith("utf"):
            stream.reconfigure(errors="cyclosweep.spelt")


def print_tables(renderables: Iterable[RenderableType], *, any_width: bool = False) -> None:
    """Print tables, as wide as the terminal.

    Parameters
    ----------
    renderables : iterable of rich renderables
        Tables.
    any_width : bool
        They have a form for few columns: COLUMNS counts without a terminal, too.
    """
    from rich.console import Console

    # Without a terminal rich would cut the tables to 80 columns.
    by_columns = any_width and os.environ.get("COLUMNS", "").isdigit()
    is_known = sys.stdout.isatty() or by_columns
    console = Console(width=None if is_known else 120)
    for renderable in renderables:
        console.print(renderable)


def print_json(value: dict[str, Any]) -> None:
    """Print one JSON object."""
    print(json.dumps(value, indent=1, allow_nan=False))


def refuse_output(out: Path, *sources: str | Path, option: str = "--out") -> None:
    """Refuse to write over a file that is read, or where no file can be.

    Parameters
    ----------
    out : Path
        The file that is to be written.
    *sources : str or Path
        What is read.
    option : str
        Option that names the file.

    Raises
    ------
    InputError
        With the file that was found.
    """
    if any(_same(Path(source), out) for source in sources):
        raise InputError(f"{option}: found {out}, which is read, expected another file")
    if out.is_dir():
        raise InputError(f"{option}: found {out}, which is a folder, expected a file")
    if not out.absolute().parent.is_dir():
        raise InputError(f"{option}: found {out}, expected a file in a folder that exists")


OTHER_TABLES = {".arrow", ".feather", ".html", ".ipc", ".json", ".ods", ".parquet", ".xls", ".xlsx"}
"""Endings of tables that are not comma-separated text."""


def refuse_table(out: Path, *sources: str | Path, option: str = "--out") -> None:
    """Refuse what `refuse_output` does, and a name that promises another table than CSV.

    Parameters
    ----------
    out : Path
        The file that is to be written.
    *sources : str or Path
        What is read.
    option : str
        Option that names the file.

    Raises
    ------
    InputError
        With the file that was found.
    """
    refuse_output(out, *sources, option=option)
    if out.suffix.lower() in OTHER_TABLES:
        raise InputError(f"{option}: found {out}, expected a file ending in .csv")


def refuse_overwriting(out: Path, *, force: bool) -> None:
    """Refuse to replace a file that may have been edited by hand.

    Parameters
    ----------
    out : Path
        The file that is to be written.
    force : bool
        Whether it may be replaced.

    Raises
    ------
    InputError
        When it exists.
    """
    if out.exists() and not force:
        raise InputError(f"--out: {out} exists; --force replaces it")


def refuse_drive_name(out: Path) -> None:
    """Refuse a name for a drive file by which no command would find it again.

    Raises
    ------
    InputError
        Unless it ends in ``.toml``; a pipe or ``/dev/stdout`` may have any name.
    """
    if out.suffix != ".toml" and (out.is_file() or not out.exists()):
        raise InputError(f"--out: found {out}, expected a drive file ending in .toml")


def _same(path: Path, other: Path) -> bool:
    """Whether two paths are one file, whether it exists or not."""
    if path.exists() and other.exists():
        return path.samefile(other)
    return path.resolve() == other.resolve()


def folder_named(text: str) -> Path:
    """Path of a folder for results; an empty text would be the current folder, unasked for."""
    if not text:
        raise typer.BadParameter("found '', expected the name of a folder")
    return Path(text)


def refuse_folder(folder: Path) -> None:
    """Refuse a folder for results that cannot be made, before anything is computed.

    Parameters
    ----------
    folder : Path
        The folder, whether it exists or not.

    Raises
    ------
    InputError
        With what was found in its place, or on the way to it.
    """
    nearest = nearest_existing(folder)
    if not nearest.is_dir():
        raise InputError(f"--out: found {nearest}, which is a file, expected a folder")
    try:
        # Rights alone do not tell: nothing can be made in /proc, and the administrator passes all.
        with tempfile.TemporaryFile(dir=nearest):
            pass
    except OSError:
        line = f"--out: found {nearest}, expected a folder that can be written to"
        raise InputError(line) from None


INTERRUPTED = 130
"""Exit status after Ctrl-C: 128 and the number of SIGINT, as of shells."""


def fail(error: object, status: int) -> NoReturn:
    """Print in one line what went wrong and exit."""
    print(f"cyclosweep: {error}", file=sys.stderr)
    sys.exit(status)


@contextlib.contextmanager
def interruptible(left: str) -> Iterator[None]:
    """Print in one line what is left after Ctrl-C; typer would print nothing."""
    try:
        yield
    except KeyboardInterrupt:
        fail(f"interrupted; {left}", INTERRUPTED)


def keep_interruptions() -> None:
    """Let Ctrl-C end the command even where Python ignores it.

    An exception in a callback of the garbage collector or of a weak reference, as imports have
    them, is printed and forgotten; the interruption is then made once more a moment later.
    """
    others = sys.unraisablehook

    def again(ignored: sys.UnraisableHookArgs) -> None:
        if issubclass(ignored.exc_type, KeyboardInterrupt):
            threading.Timer(MOMENT_S, os.kill, (os.getpid(), signal.SIGINT)).start()
        else:
            others(ignored)

    sys.unraisablehook = again


def is_interruption(error: BaseException) -> bool:
    """Tell whether Ctrl-C lies behind an error.

    An extension module that is interrupted while it is imported raises an ImportError instead.
    """
    seen: BaseException | None = error
    while seen is not None and not isinstance(seen, KeyboardInterrupt):
        seen = seen.__cause__ or seen.__context__
    return seen is not None
