"""What long work shows while it runs, on a terminal's standard error and in a notebook."""

from __future__ import annotations

import importlib
import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from typing import Any

from cyclosweep.errors import InputError

__all__ = ["NotebookLine", "Steps", "in_notebook", "shown_steps"]

Steps = bool | Callable[[str], object] | None
"""Whether steps are shown, or what they are told to."""


def in_notebook() -> bool:
    """Whether the code runs in a notebook that shows HTML: Jupyter, VS Code, Colab.

    Returns
    -------
    bool
    """
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return shell is not None and "IPKernelApp" in shell.config


class NotebookLine:
    """A line of HTML below a notebook's cell, which can be replaced and taken away."""

    def __init__(self) -> None:
        self._handle: Any = None

    def show(self, html: str) -> None:
        """Put HTML in place of what was shown."""
        display = importlib.import_module("IPython.display")
        content = display.HTML(html)
        if self._handle is None:
            self._handle = display.display(content, display_id=True)
        else:
            self._handle.update(content)

    def clear(self) -> None:
        """Take away what was shown."""
        if self._handle is not None:
            self.show("")


@contextmanager
def shown_steps(
    title: str, show: Steps, log: logging.Logger | None = None
) -> Iterator[Callable[[str], None]]:
    """Show the step at work while a context lasts, and log it.

    Parameters
    ----------
    title : str
        What is worked on.
    show : bool, callable or None
        True shows steps, False and None do not; a callable is called with a few words before each
        step.
    log : logging.Logger, optional
        Gets each step at level DEBUG.

    Yields
    ------
    callable
        To be called with a few words before each step.

    Raises
    ------
    InputError
        For another kind of `show`.
    """
    if show is not None and not isinstance(show, bool) and not callable(show):
        raise InputError(f"progress: found {show!r}, expected True, False or a function")

    def to(tell: Callable[[str], object]) -> Callable[[str], None]:
        def say(text: str) -> None:
            if log is not None:
                log.debug("%s: %s", title, text)
            tell(text)

        return say

    if callable(show):
        yield to(show)
    elif not show:
        yield to(lambda text: None)
    elif in_notebook():
        line = NotebookLine()
        try:
            yield to(lambda text: line.show(f"{escape(title)}: {escape(text)} ..."))
        finally:
            line.clear()
    else:
        from rich.console import Console

        with Console(stderr=True).status(title) as status:
            yield to(lambda text: status.update(f"{title}: {text}"))
