"""A progress bar on standard error or in a notebook: share done, rate, time left."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from cyclosweep.display import NotebookLine, in_notebook
from cyclosweep.errors import InputError

__all__ = ["Progress", "ShowProgress"]

_SHOW_AFTER_S = 2.0
_NOTEBOOK_EVERY_S = 0.2
"""Least time between two pictures in a notebook, each of which is a message to the browser [s]."""

ShowProgress = bool | Callable[[int, int], object] | None
"""Whether progress is shown; a function is told how much is done and how much there is."""


class Progress:
    """Progress of work counted in variants; silent where there is nobody to look at it.

    Parameters
    ----------
    label : str
        What is being done.
    total : int
        How much there is.
    done : int
        How much of it an earlier run has done.
    show : bool or callable, optional
        Whether to show it; by default after two seconds when standard error is a terminal or the
        code runs in a notebook. A callable is called with how much is done and how much there is.

    Raises
    ------
    InputError
        For another kind of `show`.
    """

    def __init__(self, label: str, total: int, *, done: int = 0, show: ShowProgress = None) -> None:
        if show is not None and not isinstance(show, bool) and not callable(show):
            raise InputError(f"progress: found {show!r}, expected True, False or a function")
        self._label, self._total, self._done, self._show = label, total, done, show
        self._earlier = done
        self._began = time.monotonic()
        self._bar: object | None = None
        self._line = NotebookLine() if in_notebook() else None
        self._drawn = self._began + _SHOW_AFTER_S - _NOTEBOOK_EVERY_S

    def __enter__(self) -> Self:
        if self._show is None:
            self._show = self._line is not None or sys.stderr.isatty()
        return self

    def advance(self, amount: int) -> None:
        """Count ``amount`` more as done."""
        self._done += amount
        if callable(self._show):
            self._show(self._done, self._total)
        elif self._show and self._line is not None:
            self._draw(self._line)
        elif self._show:
            self._advance_bar()

    def _rate(self) -> float:
        """Variants a second in this run."""
        return (self._done - self._earlier) / max(time.monotonic() - self._began, 1e-9)

    def _draw(self, line: NotebookLine) -> None:
        """Show a bar of the browser's own, in the notebook's colours."""
        now = time.monotonic()
        if now - self._drawn < _NOTEBOOK_EVERY_S:
            return
        self._drawn, rate = now, self._rate()
        left = (self._total - self._done) / rate if rate > 0 else 0.0
        line.show(
            f'{self._label} <progress value="{self._done}" max="{self._total}"></progress> '
            f"{self._done:,} of {self._total:,}, {rate / 1e6:.2f} M/s, {left:.0f} s left"
        )

    def _advance_bar(self) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            TextColumn,
            TimeRemainingColumn,
        )
        from rich.progress import Progress as RichProgress

        if self._bar is None:
            if time.monotonic() - self._began < _SHOW_AFTER_S:
                return
            self._bar = RichProgress(
                TextColumn("{task.description}"),
                BarColumn(bar_width=None),
                MofNCompleteColumn(),
                TextColumn("{task.fields[rate]}"),
                TimeRemainingColumn(compact=True),
                console=Console(stderr=True),
                transient=True,
            )
            self._task = self._bar.add_task(
                self._label, total=self._total, completed=self._earlier, rate=""
            )
            self._bar.start()
        assert isinstance(self._bar, RichProgress)
        self._bar.update(self._task, completed=self._done, rate=f"{self._rate() / 1e6:.2f} M/s")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()  # type: ignore[attr-defined]
        if self._line is not None:
            self._line.clear()
