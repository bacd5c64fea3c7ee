"""How commands print and fail."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

if TYPE_CHECKING:
    from rich.console import RenderableType

__all__ = ["AsJson", "fail", "interruptible", "print_json", "print_tables"]

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object, nothing else.")]


def print_tables(renderables: Iterable[RenderableType]) -> None:
    """Print tables, as wide as the terminal."""
    from rich.console import Console

    # What is piped or stored is not cut to the 80 columns of no terminal.
    console = Console(width=None if sys.stdout.isatty() else 120)
    for renderable in renderables:
        console.print(renderable)


def print_json(value: dict[str, Any]) -> None:
    """Print one JSON object."""
    print(json.dumps(value, indent=1, allow_nan=False))


def fail(error: object, status: int) -> NoReturn:
    """Say in one line what went wrong and end."""
    print(f"cyclosweep: {error}", file=sys.stderr)
    sys.exit(status)


@contextlib.contextmanager
def interruptible(left: str) -> Iterator[None]:
    """Say in one line what Ctrl-C leaves behind; typer would end without a word."""
    try:
        yield
    except KeyboardInterrupt:
        fail(f"interrupted; {left}", 1)
